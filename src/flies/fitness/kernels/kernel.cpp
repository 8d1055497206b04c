#include "flies/fitness/kernels/kernel.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <vector>

#include "flies/fitness/kernels/vector_kernel.hpp"

namespace flies::kernels {
namespace {

bool same_letters(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

}  // namespace

std::span<const Kernel> supported_kernels() {
  static const std::vector<Kernel> kernels = [] {
    auto found = vector_kernels();
    found.push_back(scalar_kernel());
    return found;
  }();
  return kernels;
}

const Kernel& select_kernel(std::string_view wanted) {
  const auto kernels = supported_kernels();
  const auto named =
      std::ranges::find_if(kernels, [&](const Kernel& candidate) { return same_letters(candidate.target, wanted); });
  return named == kernels.end() ? kernels.front() : *named;
}

const Kernel& chosen_kernel() {
  static const Kernel& chosen = [&]() -> const Kernel& {
    const char* wanted = std::getenv("FLIES_TARGET");
    return select_kernel(wanted == nullptr ? "" : wanted);
  }();
  return chosen;
}

}  // namespace flies::kernels
