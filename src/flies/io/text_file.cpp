#include "flies/io/text_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string_view>

#include "flies/core/error.hpp"
#include "flies/io/placeholder.hpp"

namespace flies {
namespace {

void append_utf8(std::string& text, unsigned code) {
  if (code < 0x80) {
    text += static_cast<char>(code);
  } else if (code < 0x800) {
    text += static_cast<char>(0xC0 | code >> 6);
    text += static_cast<char>(0x80 | (code & 0x3F));
  } else if ((code >= 0xD800 && code < 0xE000) || code > 0xFFFF) {
    text += '?';
  } else {
    text += static_cast<char>(0xE0 | code >> 12);
    text += static_cast<char>(0x80 | (code >> 6 & 0x3F));
    text += static_cast<char>(0x80 | (code & 0x3F));
  }
}

/// As `utf8_of_utf16`.
std::string utf8_of_utf32(std::string_view bytes, bool is_little_endian) {
  std::string text;
  for (std::size_t i = 0; i + 3 < bytes.size(); i += 4) {
    unsigned code = 0;
    for (std::size_t k = 0; k < 4; ++k)
      code = code << 8 | static_cast<unsigned char>(bytes[i + (is_little_endian ? 3 - k : k)]);
    append_utf8(text, code);
  }
  return text;
}

/// @param high index of the high byte in a unit: 0 big-endian, 1 little-endian. Halves of surrogate pairs become '?':
///             no calibration has any.
std::string utf8_of_utf16(std::string_view bytes, std::size_t high) {
  std::string text;
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    const auto unit = static_cast<unsigned>(static_cast<unsigned char>(bytes[i + high]) << 8 |
                                            static_cast<unsigned char>(bytes[i + 1 - high]));
    append_utf8(text, unit);
  }
  return text;
}

}  // namespace

std::string plain_text(const std::string& bytes) {
  constexpr std::string_view kUtf8Mark = "\xEF\xBB\xBF", kLittleMark = "\xFF\xFE", kBigMark = "\xFE\xFF";
  constexpr std::string_view kLittleMark32("\xFF\xFE\0\0", 4), kBigMark32("\0\0\xFE\xFF", 4);
  const std::string_view view = bytes;
  std::string text;
  if (view.starts_with(kUtf8Mark))
    text = view.substr(kUtf8Mark.size());
  else if (view.starts_with(kLittleMark32) || view.starts_with(kBigMark32))  // before the shorter mark
    text = utf8_of_utf32(view.substr(kBigMark32.size()), view.starts_with(kLittleMark32));
  else if (view.starts_with(kLittleMark))
    text = utf8_of_utf16(view.substr(kLittleMark.size()), 1);
  else if (view.starts_with(kBigMark))
    text = utf8_of_utf16(view.substr(kBigMark.size()), 0);
  else if (view.size() > 1 && view[0] != '\0' && view[1] == '\0')
    text = utf8_of_utf16(view, 1);
  else if (view.size() > 1 && view[0] == '\0' && view[1] != '\0')
    text = utf8_of_utf16(view, 0);
  else
    text = bytes;
  std::string lines;
  lines.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\r')
      lines += text[i];
    else if (i + 1 == text.size() || text[i + 1] != '\n')
      lines += '\n';
  }
  return lines;
}

std::string read_bytes(const std::string& path, std::size_t max_bytes) {
  std::error_code ignored;
  if (path.empty()) throw InputError("input", "file name", "is empty");
  if (std::filesystem::is_directory(path, ignored)) throw InputError(path, "", "is a folder, expected a file");

  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  const std::unique_ptr<std::FILE, CloseFile> file(std::fopen(path.c_str(), "rb"));
  if (!file) {
    const int error = errno;
    const auto fault = detail::dead_link_fault(path);
    throw InputError(path, "", fault.empty() ? fmt::format("cannot be read: {}", std::strerror(error)) : fault);
  }

  // Read piece by piece rather than by size, so that pipes work too.
  std::string bytes;
  constexpr std::size_t kPiece = 1U << 16;
  for (std::size_t got = kPiece; got == kPiece;) {
    const std::size_t before = bytes.size();
    bytes.resize(before + kPiece);
    got = std::fread(bytes.data() + before, 1, kPiece, file.get());
    bytes.resize(before + got);
    if (std::ferror(file.get()) != 0)
      throw InputError(path, "", fmt::format("cannot be read: {}", std::strerror(errno)));
    if (bytes.size() > max_bytes)
      throw InputError(path, "", fmt::format("is larger than {} bytes, too large for a file of this kind", max_bytes));
  }
  return bytes;
}

std::string read_file(const std::string& path, std::size_t max_bytes) {
  std::string bytes = read_bytes(path, max_bytes);
  if (bytes.empty())
    throw InputError(path, "", "is empty: copying or downloading it was interrupted, or the disk was full");
  if (bytes.starts_with("\x1F\x8B")) throw InputError(path, "", "is gzip-compressed: unpack it");
  if (const auto fault = detail::placeholder_fault(bytes); !fault.empty()) throw InputError(path, "", fault);
  return bytes;
}

}  // namespace flies
