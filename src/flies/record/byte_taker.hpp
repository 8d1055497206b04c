#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace flies {

/// Takes little-endian numbers and texts from bytes; what is not there is 0 and empty, and then `is_good` is false.
/// Not installed.
class ByteTaker {
 public:
  explicit ByteTaker(std::string_view bytes) : bytes_(bytes) {}
  std::uint64_t number(int size) {
    const std::string_view own = take(static_cast<std::size_t>(size));
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < own.size(); ++i) value |= std::uint64_t{static_cast<unsigned char>(own[i])} << (8 * i);
    return value;
  }
  std::string text() { return std::string(take(number(4))); }
  std::string_view rest() { return take(bytes_.size()); }
  std::string_view take(std::uint64_t size) {
    if (size > bytes_.size()) {
      is_good = false;
      size = 0;
    }
    const std::string_view own = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return own;
  }
  std::size_t left() const { return bytes_.size(); }
  bool is_good = true;

 private:
  std::string_view bytes_;
};

}  // namespace flies
