#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace flies {

/// Finds the order of values in time that grows as their number: a radix sort, which keeps its memory.
class AscendingOrder {
 public:
  void reserve(std::size_t values) {
    keyed_.reserve(values);
    sorted_.reserve(values);
    order_.reserve(values);
  }

  /// @param values not NaN
  /// @returns the indices of the values, least value first, equal values by index; valid until the next call
  std::span<const std::uint32_t> find(std::span<const float> values) {
    order_.resize(values.size());
    keyed_.resize(values.size());
    sorted_.resize(values.size());
    for (auto& places : places_) places.fill(0);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const Keyed keyed{key(values[i]), static_cast<std::uint32_t>(i)};
      keyed_[i] = keyed;
      for (std::size_t digit = 0; digit < kDigits; ++digit) ++places_[digit][digit_of(keyed, digit)];
    }
    for (std::size_t digit = 0; digit < kDigits; ++digit) {
      auto& places = places_[digit];
      for (std::uint32_t next = 0; auto& place : places) next += std::exchange(place, next);
      for (const Keyed& keyed : keyed_) sorted_[places[digit_of(keyed, digit)]++] = keyed;
      keyed_.swap(sorted_);
    }
    for (std::size_t i = 0; i < values.size(); ++i) order_[i] = keyed_[i].index;
    return order_;
  }

 private:
  static constexpr std::size_t kDigits = 4, kDigitBits = 8;

  struct Keyed {
    std::uint32_t key, index;
  };

  /// Integers in the order of the floating point numbers: negative ones are ordered by their complement.
  static std::uint32_t key(float value) {
    constexpr std::uint32_t kSign = 0x80000000U;
    const auto bits = std::bit_cast<std::uint32_t>(value + 0.0F);  // -0 and 0 are equal
    return (bits & kSign) != 0 ? ~bits : bits | kSign;
  }

  static std::size_t digit_of(const Keyed& keyed, std::size_t digit) {
    return (keyed.key >> (kDigitBits * digit)) & ((1U << kDigitBits) - 1U);
  }

  std::vector<Keyed> keyed_, sorted_;
  std::vector<std::uint32_t> order_;
  std::array<std::array<std::uint32_t, 1U << kDigitBits>, kDigits> places_{};
};

}  // namespace flies
