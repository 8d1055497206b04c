#include "flies/train/fingerprint.hpp"

#include <fmt/format.h>

namespace flies {

void Fingerprint::add(std::string_view bytes) {
  for (const char byte : bytes) hash_ = (hash_ ^ static_cast<unsigned char>(byte)) * 0x100000001b3U;
  hash_ = (hash_ ^ 0x1FFU) * 0x100000001b3U;  // keeps "ab", "c" apart from "a", "bc"
}

void Fingerprint::add(std::span<const ImageBox> boxes) {
  for (const auto& box : boxes) add(fmt::format("{} {} {} {}", box.u_px, box.v_px, box.width_px, box.height_px));
  add("end");
}

std::string Fingerprint::text() const { return fmt::format("{:016x}", hash_); }

}  // namespace flies
