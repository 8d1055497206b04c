#include "flies/core/base64.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

namespace flies {
namespace {

constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr std::uint8_t kNoDigit = 255;

constexpr std::array<std::uint8_t, 256> values_of_digits() {
  std::array<std::uint8_t, 256> values{};
  values.fill(kNoDigit);
  for (std::size_t i = 0; i < kDigits.size(); ++i)
    values[static_cast<unsigned char>(kDigits[i])] = static_cast<std::uint8_t>(i);
  return values;
}
constexpr auto kValues = values_of_digits();

}  // namespace

std::string to_base64(std::string_view bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8U | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? kDigits[group >> (18U - 6U * k) & 63U] : '=';
  }
  return text;
}

std::string to_base64(std::span<const std::uint8_t> bytes) {
  return to_base64(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

std::optional<std::string> from_base64(std::string_view text) {
  if (text.size() % 4 != 0) return {};
  std::size_t padding = 0;
  while (padding < 2 && padding < text.size() && text[text.size() - 1 - padding] == '=') ++padding;
  std::string bytes(text.size() / 4 * 3, '\0');
  char* out = bytes.data();
  std::uint32_t all_bits = 0;  // of the values; those of digits are the lowest six
  const auto decode = [&](const char* digits) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint8_t value = kValues[static_cast<unsigned char>(digits[k])];
      all_bits |= value;
      group = group << 6U | (value & 63U);
    }
    for (const unsigned shift : {16U, 8U, 0U}) *out++ = static_cast<char>(group >> shift & 255U);
  };
  const std::size_t whole = padding > 0 ? text.size() - 4 : text.size();
  for (std::size_t i = 0; i < whole; i += 4) decode(text.data() + i);
  if (padding > 0) {
    std::string last(text.substr(whole));
    std::fill(last.end() - static_cast<std::ptrdiff_t>(padding), last.end(), kDigits.front());
    decode(last.data());
  }
  if (all_bits > 63) return {};
  bytes.resize(bytes.size() - padding);
  return bytes;
}

}  // namespace flies
