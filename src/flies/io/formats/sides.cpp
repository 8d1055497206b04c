#include "flies/io/formats/sides.hpp"

#include <charconv>
#include <cstddef>
#include <optional>
#include <system_error>

#include "flies/core/letters.hpp"

namespace flies::detail {
namespace {

struct NumberInName {
  int value = 0;
  std::size_t digits = 0;
};

/// The whole number that a text begins with, if it does.
std::optional<NumberInName> number_at(std::string_view text) {
  NumberInName number;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number.value);
  if (error != std::errc() || text[0] == '-') return std::nullopt;
  number.digits = static_cast<std::size_t>(end - text.data());
  return number;
}

bool are_sides(std::string_view left, std::string_view right) {
  bool differ = false;
  while (!left.empty() && !right.empty()) {
    std::size_t of_left = 1, of_right = 1;
    const auto number = number_at(left), next = number_at(right);
    if (left.starts_with("left") && right.starts_with("right")) {
      of_left = 4;
      of_right = 5;
      differ = true;
    } else if (left[0] == 'l' && right[0] == 'r') {
      differ = true;
    } else if (number && next) {
      if (number->value != next->value && number->value + 1 != next->value) return false;
      differ = differ || number->value != next->value;
      of_left = number->digits;
      of_right = next->digits;
    } else if (left[0] != right[0]) {
      return false;
    }
    left.remove_prefix(of_left);
    right.remove_prefix(of_right);
  }
  return differ && left.empty() && right.empty();
}

}  // namespace

bool is_left_and_right(const std::string& left, const std::string& right) {
  return are_sides(in_small_letters(left), in_small_letters(right));
}

}  // namespace flies::detail
