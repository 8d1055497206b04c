#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "flies/core/fly.hpp"
#include "flies/core/gray_view.hpp"
#include "flies/core/options.hpp"
#include "flies/core/stereo_camera.hpp"

namespace flies {

/// How well the neighbourhoods of a fly's two projections agree.
enum class FitnessFunction {
  louchet,      ///< Eq. (1): gradient norm over summed squared differences
  covariance,   ///< Eq. (2): sum over rows of covariance times agreement of the row means
  correlation,  ///< ours: powers of the row-centred correlation coefficient and of the mean covariance
};
template <>
struct EnumNames<FitnessFunction> {
  static constexpr std::array<std::string_view, 3> names = {"louchet", "covariance", "correlation"};
};

/// Where between the pixels the neighbourhoods are read.
enum class PatchSampling {
  nearest,   ///< both projections rounded to whole pixels, as the paper's integer neighbourhoods suggest
  subpixel,  ///< left projection rounded, the right patch interpolated at the exact disparity
};
template <>
struct EnumNames<PatchSampling> {
  static constexpr std::array<std::string_view, 2> names = {"nearest", "subpixel"};
};

struct FitnessOptions {
  FitnessFunction function = FitnessFunction::correlation;
  PatchSampling sampling = PatchSampling::subpixel;
  int half_width_px = 6;   ///< uSz: the patch has 2 uSz + 1 columns
  int half_height_px = 9;  ///< vSz: the patch has 2 vSz + 1 rows
  int row_step = 3;        ///< of those, the middle one and every so many above and below are compared
  double louchet_constant = 100.0;
  double correlation_power = 6.0;
  double contrast_power = 0.25;
  double noise_gray = 2.0;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("function", self.function, "louchet: Eq. (1); covariance: Eq. (2); correlation: bounded similarity");
    field("sampling", self.sampling, "nearest: whole pixels; subpixel: right patch interpolated along its row");
    field("half_width_px", self.half_width_px, Range{1, 12}, "uSz, columns to each side of the projection");
    field("half_height_px", self.half_height_px, Range{1, 16}, "vSz, rows above and below the projection");
    field("row_step", self.row_step, Range{1, 16}, "only every so many rows of the patch are compared; 1: all rows");
    field("louchet_constant", self.louchet_constant, Range{1e-6, 1e9},
          "added to the summed squared differences of Eq. (1), squared grey levels");
    field("correlation_power", self.correlation_power, Range{1, 32},
          "power of the correlation coefficient (function correlation)");
    field("contrast_power", self.contrast_power, Range{0, 1},
          "power of the mean covariance that rewards informative patches (function correlation)");
    field("noise_gray", self.noise_gray, Range{0, 64},
          "standard deviation of image noise, grey levels; lowers the correlation of flat patches");
  }
};

/// Scores places given by image coordinates: the left projection (`u_px`, `v_px`) and the disparity of each. This is
/// the kernel behind everything that scores: serial, without heap allocation, safe to call from several threads at
/// once. Rows of the images stay in the caches when the places are ordered by `v_px`.
/// @param fitness of each place: >= 0; 0 where a coordinate is not finite or the neighbourhood leaves either image. A
///                neighbourhood uses the columns of half_width_px to each side of its place, in the right image one
///                more to the right. All four spans are of equal length.
/// Left projections are rounded to whole pixels and right ones to the steps of the sampling, halves to even, in single
/// precision: the same decisions on every CPU.
/// @throws InputError naming an option out of its range, or when images are empty or differ in size, as does all that
///         follows
void score_points(const RectifiedPair& pair, const FitnessOptions& options, std::span<const float> u_px,
                  std::span<const float> v_px, std::span<const float> disparity_px, std::span<float> fitness);

/// Correlation coefficients of the row-centred neighbourhoods, lowered by the noise floor of the options; -1..1, and 0
/// where `score_points` would give 0 for want of pixels. How alike two places look, whatever their contrast.
void correlate_points(const RectifiedPair& pair, const FitnessOptions& options, std::span<const float> u_px,
                      std::span<const float> v_px, std::span<const float> disparity_px, std::span<float> coefficient);

/// `score_points` for one place.
float score_point(const RectifiedPair& pair, const FitnessOptions& options, const StereoPoint& point);

/// `correlate_points` for one place.
float correlate_point(const RectifiedPair& pair, const FitnessOptions& options, const StereoPoint& point);

/// Scores flies against the pair: `score_points` of their projections.
/// @param pair    rectified pair of the size that `projection` was calibrated for
/// @param flies   positions in the vehicle frame; their present fitness is not read
/// @param first   index of the first fly to score
/// @param fitness of the flies `first`, `first` + 1, ...: >= 0; 0 for a fly behind the camera, a position that is not
///                finite, or a neighbourhood that leaves either image. `first + fitness.size()` <= `flies.size()`.
/// Runs on oneTBB's current arena; results do not depend on the number of threads.
void score_flies(const RectifiedPair& pair, const Projection& projection, const FitnessOptions& options,
                 const Population& flies, std::size_t first, std::span<float> fitness);

/// Scores all flies. @returns one fitness per fly
std::vector<float> score_flies(const RectifiedPair& pair, const Projection& projection, const FitnessOptions& options,
                               const Population& flies);

/// Instruction set that scores the flies: the fastest of `kernel_target_names()`, or the one that the environment
/// variable FLIES_TARGET names when the process first asks for a fitness; a name not among them changes nothing.
/// Results do not depend on it.
std::string_view kernel_target_name();

/// Instruction sets that this CPU can score flies with, fastest first: "scalar", which is always there, and Highway's
/// names of vector instruction sets, such as SSE4, AVX2, AVX3 (meaning AVX-512), AVX3_DL (AVX-512 with VNNI and VBMI2)
/// and NEON.
std::vector<std::string_view> kernel_target_names();

}  // namespace flies
