#include "flies/io/image_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

#include "flies/core/error.hpp"
#include "flies/core/letters.hpp"
#include "flies/io/folder.hpp"
#include "flies/io/image_file.hpp"
#include "flies/io/placeholder.hpp"

namespace flies::detail {
namespace {

namespace fs = std::filesystem;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Order of names in which runs of digits compare as numbers.
bool name_less(std::string_view a, std::string_view b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!is_digit(a[i]) || !is_digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
      continue;
    }
    const auto take_number = [](std::string_view text, std::size_t& at) {
      while (at + 1 < text.size() && text[at] == '0' && is_digit(text[at + 1])) ++at;
      const std::size_t first = at;
      while (at < text.size() && is_digit(text[at])) ++at;
      return text.substr(first, at - first);
    };
    const auto number_a = take_number(a, i), number_b = take_number(b, j);
    if (number_a.size() != number_b.size()) return number_a.size() < number_b.size();
    if (number_a != number_b) return number_a < number_b;
  }
  if ((i < a.size()) != (j < b.size())) return j < b.size();
  return a < b;  // "01" and "1"
}

}  // namespace

bool is_hidden(const fs::path& path) { return path.filename().string().starts_with('.'); }

bool is_image_name(const fs::path& path) {
  constexpr std::array<std::string_view, 10> kExtensions = {".png", ".jpg", ".jpeg", ".pgm",  ".ppm",
                                                            ".pnm", ".tif", ".tiff", ".webp", ".bmp"};
  if (is_hidden(path)) return false;
  const std::string extension = in_small_letters(path.extension().string());
  return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

std::vector<std::string> images_of(const std::string& folder) {
  std::vector<fs::path> images = files_of(folder);
  std::erase_if(images, [](const fs::path& path) { return !is_image_name(path); });
  if (images.empty()) throw InputError(folder, "", fmt::format("holds no images, expected {} files", kReadableImages));
  std::sort(images.begin(), images.end(), [](const fs::path& a, const fs::path& b) {
    return name_less(a.filename().string(), b.filename().string());
  });
  std::vector<std::string> names(images.size());
  std::transform(images.begin(), images.end(), names.begin(), [](const fs::path& path) { return path.string(); });
  return names;
}

bool is_folder(const std::string& path) {
  std::error_code error;
  const auto status = fs::status(path, error);
  if (const auto fault = dead_link_fault(path); !fault.empty()) throw InputError(path, "", fault);
  if (status.type() == fs::file_type::not_found) throw InputError(path, "", "does not exist");
  if (error) throw InputError(path, "", fmt::format("cannot be read: {}", error.message()));
  return fs::is_directory(status);
}

}  // namespace flies::detail
