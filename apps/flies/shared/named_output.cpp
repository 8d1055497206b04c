#include "shared/named_output.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "flies/core/error.hpp"

void require_named_output(const std::string& path, const std::string& option, const std::string& ending) {
  if (path == "-") throw flies::InputError("command line", option, "cannot go to standard output, expected a file");
  const bool may_have_any = path.empty() || ending.empty() || path.starts_with("/dev/");
  std::string own = std::filesystem::path(path).extension().string();
  std::ranges::transform(own, own.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (!may_have_any && own != ending) throw flies::InputError(path, option, "expected a name that ends in " + ending);
}
