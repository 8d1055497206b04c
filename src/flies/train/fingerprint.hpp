#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "flies/core/results.hpp"

namespace flies {

/// Tells one set of pictures, labels and options from another: FNV-1a with 64 bits over texts, in their order.
class Fingerprint {
 public:
  void add(std::string_view bytes);
  void add(std::span<const ImageBox> boxes);
  /// 16 hexadecimal digits.
  std::string text() const;

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325U;
};

}  // namespace flies
