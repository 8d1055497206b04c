#include "shared/named_output.hpp"

#include <filesystem>

#include "flies/core/error.hpp"
#include "flies/core/letters.hpp"

void require_named_output(const std::string& path, const std::string& option, const std::string& ending) {
  if (path == "-") throw flies::InputError("command line", option, "cannot go to standard output, expected a file");
  const bool may_have_any = path.empty() || ending.empty() || path.starts_with("/dev/");
  const std::string own = flies::detail::in_small_letters(std::filesystem::path(path).extension().string());
  if (!may_have_any && own != ending) throw flies::InputError(path, option, "expected a name that ends in " + ending);
}
