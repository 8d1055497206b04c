// OpenCV's modules/core/src/persistence_base64_encoding.cpp: 24 bytes of the type of the elements, as "3f", and blanks;
// then the elements, little-endian.
#include "flies/io/opencv_base64.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <string>

#include "flies/core/base64.hpp"

namespace flies::detail {
namespace {

constexpr std::string_view kPrefixInJson = "$base64$";
constexpr std::size_t kHeaderBytes = 24;

template <class Number>
void append_as(std::string_view bytes, NumberEntry& entry) {
  for (; bytes.size() >= sizeof(Number); bytes.remove_prefix(sizeof(Number))) {
    std::array<char, sizeof(Number)> native{};
    std::copy_n(bytes.begin(), sizeof(Number), native.begin());
    if constexpr (std::endian::native == std::endian::big) std::reverse(native.begin(), native.end());
    entry.numbers.push_back(static_cast<double>(std::bit_cast<Number>(native)));
  }
}

/// The letters that OpenCV has for types of numbers.
struct NumberType {
  char letter;
  std::size_t bytes;
  void (*append)(std::string_view bytes, NumberEntry& entry);
};
constexpr NumberType kTypes[] = {{'u', 1, append_as<std::uint8_t>},  {'c', 1, append_as<std::int8_t>},
                                 {'w', 2, append_as<std::uint16_t>}, {'s', 2, append_as<std::int16_t>},
                                 {'i', 4, append_as<std::int32_t>},  {'f', 4, append_as<float>},
                                 {'d', 8, append_as<double>}};

/// The one type of a header such as "3f    "; null where there are several, or none.
const NumberType* type_in(std::string_view header) {
  header = header.substr(0, header.find_last_not_of(' ') + 1);
  header = header.substr(std::min(header.find_first_not_of("0123456789"), header.size()));
  if (header.size() != 1) return nullptr;
  const auto* found = std::ranges::find(kTypes, header[0], &NumberType::letter);
  return found == std::end(kTypes) ? nullptr : found;
}

}  // namespace

bool is_opencv_base64(std::string_view text, std::string_view type) {
  return type == "tag:yaml.org,2002:binary" || type == "binary" || text.starts_with(kPrefixInJson);
}

void append_opencv_base64(std::string_view text, NumberEntry& entry) {
  if (text.starts_with(kPrefixInJson)) text.remove_prefix(kPrefixInJson.size());
  std::string digits(text);
  std::erase_if(digits, [](char letter) { return letter == ' ' || letter == '\n' || letter == '\t'; });
  const auto bytes = from_base64(digits);
  const auto* type =
      bytes && bytes->size() > kHeaderBytes ? type_in(std::string_view(*bytes).substr(0, kHeaderBytes)) : nullptr;
  if (type == nullptr || (bytes->size() - kHeaderBytes) % type->bytes != 0) {
    entry.not_a_number = "Base64 that OpenCV cannot have written: write the file again without WRITE_BASE64";
    return;
  }
  type->append(std::string_view(*bytes).substr(kHeaderBytes), entry);
}

}  // namespace flies::detail
