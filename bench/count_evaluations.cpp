// What scripts/check-instructions counts the instructions of: COUNT evaluations of one kernel on the default patch,
// within functions that are called counted_evaluations, and only there. Ends with status 3 where this CPU, or what
// valgrind makes of it, has not the instruction set that FLIES_TARGET names.
//   count_evaluations squared-differences|weighted-covariances|moments COUNT
#include <cstdlib>
#include <string_view>
#include <vector>

#include "flies/core/random.hpp"
#include "flies/fitness/kernels/kernel.hpp"

using namespace flies::kernels;

namespace {

// By no means inlined: the counter is on from where it is entered to where it is left.
template <class Sums, class Result>
[[gnu::noinline]] void counted_evaluations(Sums* sums, const PatchImages& images, const std::vector<PatchPlace>& places,
                                           std::vector<Result>& results, int count) {
  for (int done = 0; done < count; done += static_cast<int>(places.size())) sums(images, places, results.data());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const std::string_view function = argv[1];
  const int count = std::atoi(argv[2]);

  constexpr int kWidth_px = 320, kHeight_px = 240, kColumns = 13, kRows = 19;
  flies::FlyRandom random(1, 0, 0, 0);
  std::vector<std::uint8_t> image(std::size_t{kWidth_px} * kHeight_px);
  for (auto& pixel : image) pixel = static_cast<std::uint8_t>(random.below(256));
  const std::uint8_t* const end = image.data() + image.size();
  const PatchImages images = {end, end, kWidth_px, kWidth_px, kColumns, kRows};
  std::vector<PatchPlace> places;
  for (int i = 0; i < 64; ++i)
    places.push_back({image.data() + random.below(200) * kWidth_px + random.below(300),
                      image.data() + random.below(200) * kWidth_px + random.below(300),
                      static_cast<std::int32_t>(random.below(16))});

  const Kernel& kernel = chosen_kernel();
  const char* const wanted = std::getenv("FLIES_TARGET");
  if (wanted != nullptr && kernel.target != std::string_view(wanted)) return 3;
  const auto evaluate = [&](auto* sums, auto result) {
    std::vector<decltype(result)> results(places.size());
    counted_evaluations(sums, images, places, results, count);
  };
  if (function == "squared-differences")
    evaluate(kernel.sum_squared_differences, std::int64_t{});
  else if (function == "weighted-covariances")
    evaluate(kernel.sum_weighted_covariances, float{});
  else if (function == "moments")
    evaluate(kernel.sum_moments, PatchMoments{});
  else
    return 2;
}
