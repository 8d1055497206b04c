#pragma once

#include <cstddef>
#include <cstdint>

namespace flies::kernels {

/// Size of the patches.
constexpr int kProductColumns = 16, kProductRows = 7;

/// A patch of one image and those of a row of places in another one.
struct PatchRow {
  const std::int16_t* patch = nullptr;                 ///< its top-left pixel, grey levels of 0..255
  const std::int16_t* others = nullptr;                ///< top-left pixel of the leftmost of the others
  std::ptrdiff_t patch_stride = 0, others_stride = 0;  ///< pixels from row to row
  int places = 0;  ///< how many others, each a column to the right of the one before
};

/// The sums of products of grey levels, which a correlation is made of: exact, and the same on every CPU.
/// @param product one per place
void patch_products(const PatchRow& row, std::int32_t* product);

}  // namespace flies::kernels
