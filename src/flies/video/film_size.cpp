#include "flies/video/film_size.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string_view>
#include <vector>

namespace flies {
namespace {

/// Bytes of a file, read where they are asked for.
class Bytes {
 public:
  explicit Bytes(const std::string& path) : file_(path, std::ios::binary) {
    std::error_code error;
    const auto size = std::filesystem::file_size(path, error);
    if (!error) size_ = size;
  }
  std::uint64_t size() const { return size_; }

  /// @returns `count` bytes, fewer at the end of the file
  std::string at(std::uint64_t position, std::size_t count) {
    std::string bytes(count, '\0');
    file_.clear();
    file_.seekg(static_cast<std::streamoff>(position));
    file_.read(bytes.data(), static_cast<std::streamsize>(count));
    bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(file_.gcount(), 0)));
    return bytes;
  }

 private:
  std::ifstream file_;
  std::uint64_t size_ = 0;
};

std::uint64_t big_endian(std::string_view bytes) {
  std::uint64_t value = 0;
  for (const char byte : bytes) value = value << 8U | static_cast<std::uint8_t>(byte);
  return value;
}

/// Boxes, each with its size: 0 reaches to the end of the file, 1 has a longer number behind the name.
bool is_mp4_cut_off(Bytes& file) {
  constexpr std::uint64_t kHead = 8;
  constexpr int kMostBoxes = 100000;
  std::uint64_t position = 0;
  for (int box = 0; box < kMostBoxes && position < file.size(); ++box) {
    const std::string head = file.at(position, 2 * kHead);
    if (head.size() < kHead) return true;
    std::uint64_t size = big_endian(std::string_view(head).substr(0, 4));
    if (size == 1 && head.size() == 2 * kHead) size = big_endian(std::string_view(head).substr(kHead));
    if (size < kHead) return false;
    if (size > file.size() - position) return true;
    position += size;
  }
  return false;
}

bool is_avi_cut_off(Bytes& file) {
  std::string size = file.at(4, 4);
  std::ranges::reverse(size);
  constexpr std::uint64_t kHead = 8;
  return big_endian(size) + kHead > file.size();
}

/// A number of Matroska: its first byte tells by its leading zeros how many follow.
struct Number {
  std::uint64_t value = 0;
  std::size_t length = 0;
  bool is_unknown = false;  ///< all ones: a size that was not known when it was written
};

std::optional<Number> matroska_number(const std::string& bytes, std::size_t at) {
  constexpr std::size_t kMost = 8;
  if (at >= bytes.size()) return std::nullopt;
  const auto first = static_cast<std::uint8_t>(bytes[at]);
  std::size_t length = 1;
  while (length <= kMost && (first & (0x100U >> length)) == 0) ++length;
  if (length > kMost || at + length > bytes.size()) return std::nullopt;
  const std::uint64_t all = (std::uint64_t{1} << (7 * length)) - 1;
  const std::uint64_t value = big_endian(std::string_view(bytes).substr(at, length)) & all;
  return Number{.value = value, .length = length, .is_unknown = value == all};
}

/// The head is followed by one segment with everything else.
bool is_matroska_cut_off(Bytes& file) {
  constexpr std::size_t kName = 4, kMostHead = 1024;
  const std::string bytes = file.at(0, kMostHead);
  const auto head = matroska_number(bytes, kName);
  if (!head || head->value > kMostHead) return false;
  const std::size_t segment = kName + head->length + static_cast<std::size_t>(head->value);
  if (bytes.compare(std::min(segment, bytes.size()), kName, "\x18\x53\x80\x67") != 0) return false;
  const auto size = matroska_number(bytes, segment + kName);
  return size && !size->is_unknown && segment + kName + size->length + size->value > file.size();
}

bool ends_in_zeros(Bytes& file) {
  constexpr std::size_t kTail = 4096;
  if (file.size() < kTail) return false;
  return std::ranges::all_of(file.at(file.size() - kTail, kTail), [](char byte) { return byte == '\0'; });
}

}  // namespace

bool lacks_its_end(const std::string& path) {
  Bytes file(path);
  const std::string start = file.at(0, 12);
  if (start.starts_with("RIFF")) return is_avi_cut_off(file) || ends_in_zeros(file);
  if (start.starts_with("\x1A\x45\xDF\xA3")) return is_matroska_cut_off(file) || ends_in_zeros(file);
  const bool is_mp4 = start.size() == 12 && start.substr(4, 4) == "ftyp";
  return is_mp4 && (is_mp4_cut_off(file) || ends_in_zeros(file));
}

}  // namespace flies
