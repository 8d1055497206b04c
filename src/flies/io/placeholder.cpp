#include "flies/io/placeholder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

#include "flies/core/letters.hpp"

namespace flies::detail {
namespace {

using std::string_view_literals::operator""sv;

/// A path to a file with an extension: one line, no blanks, nothing that other texts are made of.
bool is_path(std::string_view text) {
  constexpr std::size_t kLongest = 1024, kLongestExtension = 5;
  if (text.empty() || text.size() > kLongest) return false;
  const auto is_letter = [](char letter) {
    return std::isalnum(static_cast<unsigned char>(letter)) != 0 || static_cast<unsigned char>(letter) >= 0x80;
  };
  const auto is_of_path = [&](char letter) {
    return is_letter(letter) || "/\\._-+@~"sv.find(letter) != std::string::npos;
  };
  if (!std::ranges::all_of(text, is_of_path)) return false;
  const std::size_t dot = text.rfind('.'), slash = text.find_last_of("/\\");
  if (dot == std::string_view::npos || (slash != std::string_view::npos && dot < slash)) return false;
  const auto extension = text.substr(dot + 1);
  const auto is_digit = [](char letter) { return std::isdigit(static_cast<unsigned char>(letter)) != 0; };
  return !extension.empty() && extension.size() <= kLongestExtension && std::ranges::all_of(extension, is_letter) &&
         !std::ranges::all_of(extension, is_digit);  // a number
}

bool is_web_page(std::string_view text) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  if (text.starts_with(kMark)) text.remove_prefix(kMark.size());
  const std::string begin = in_small_letters(trimmed(text).substr(0, 16));
  return begin.starts_with("<!doctype html") || begin.starts_with("<html") || begin.starts_with("<head");
}

std::string link_fault(std::string_view target) {
  return fmt::format(
      "holds nothing but the text '{}': a symbolic link that became a text file when it was copied, unpacked or "
      "checked "
      "out; put the file that it names in its place, or give that one",
      target);
}

}  // namespace

std::string placeholder_fault(std::string_view bytes) {
  constexpr auto kCygwinLink = "!<symlink>"sv;
  constexpr std::size_t kLongest = 4096;  // of texts that stand for a file
  if (!bytes.empty() && std::ranges::all_of(bytes, [](char byte) { return byte == '\0'; }))
    return "holds nothing but zeros: copying or downloading it was interrupted, or the disk was full";
  if (is_web_page(bytes))
    return "is a web page (HTML), not the file itself, as a download leaves it that was not allowed or went to the "
           "wrong address: open it in a browser to see why, and download the file again";
  if (bytes.size() > kLongest) return {};
  if (bytes.starts_with("version https://git-lfs.github.com/spec/"))
    return "is a pointer of Git LFS, not the file itself: run `git lfs pull` in its repository";
  const auto text = trimmed(bytes);
  if (text.find("annex/objects/") != std::string_view::npos && text.find('\n') == std::string_view::npos)
    return "is a pointer of git-annex, not the file itself: run `git annex get` on it";
  if (text.starts_with("outs:") && text.find("md5:") != std::string_view::npos)
    return "is a pointer of DVC, not the file itself: run `dvc pull` on it";
  if (bytes.starts_with(kCygwinLink)) return link_fault(trimmed(bytes.substr(kCygwinLink.size())));
  return is_path(text) ? link_fault(text) : "";
}

std::string placeholder_fault_of_file(const std::string& path) {
  constexpr std::uintmax_t kLargest = 1U << 20;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored) || std::filesystem::file_size(path, ignored) > kLargest)
    return {};
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  return placeholder_fault(bytes.str());
}

std::string dead_link_fault(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_symlink(path, ignored) || std::filesystem::exists(path, ignored)) return {};
  const auto target = std::filesystem::read_symlink(path, ignored).string();
  if (target.find("annex/objects/") != std::string::npos)
    return "is a link of git-annex to content that is not here: run `git annex get` on it";
  return fmt::format("is a symbolic link to '{}', which does not exist", target);
}

}  // namespace flies::detail
