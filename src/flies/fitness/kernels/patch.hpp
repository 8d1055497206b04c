#pragma once

#include <cstddef>
#include <cstdint>

namespace flies::kernels {

constexpr int kScale = 16;       ///< sub-pixel steps, also the scale of the right neighbourhood's grey levels
constexpr int kMaxColumns = 25;  ///< of a patch
constexpr int kMaxRows = 33;     ///< of a patch

/// The usual patches, the whole one of the paper and every third row of it, have code of their own: loops of known
/// length.
constexpr int kUsualColumns = 13, kUsualRows = 19, kUsualFewRows = 7;

/// What all patches of a pair of images have in common.
struct PatchImages {
  const std::uint8_t* left_end = nullptr;   ///< behind the last pixel of the left image
  const std::uint8_t* right_end = nullptr;  ///< behind the last pixel of the right image
  std::ptrdiff_t left_stride = 0;
  std::ptrdiff_t right_stride = 0;
  int columns = 0;  ///< of a patch, odd, 3..25
  int rows = 0;     ///< of a patch, odd, 3..33
};

/// Two neighbourhoods inside their images. The right one lies `fraction16`/16 px to the right of whole columns; when
/// that is not 0 the column after its last one is read too.
struct PatchPlace {
  const std::uint8_t* left = nullptr;   ///< top-left pixel of the left neighbourhood
  const std::uint8_t* right = nullptr;  ///< top-left pixel of the right neighbourhood
  std::int32_t fraction16 = 0;          ///< 0..15
};

/// Sums over the rows of a patch of n columns, l a grey level of the left and r 16 times one of the right
/// neighbourhood: of n (sum l r) - (sum l) (sum r), and the same of l l and of r r. Exact.
struct PatchMoments {
  std::int64_t lr = 0, ll = 0, rr = 0;

  bool operator==(const PatchMoments&) const = default;
};

}  // namespace flies::kernels
