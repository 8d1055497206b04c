#pragma once

#include <optional>
#include <string>
#include <vector>

#include "flies/core/gray_view.hpp"
#include "flies/core/pair_check.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/diagnose/compare_sides.hpp"
#include "flies/diagnose/image_noise.hpp"
#include "flies/diagnose/image_steps.hpp"
#include "flies/diagnose/row_error.hpp"
#include "flies/road/road.hpp"

namespace flies {

/// What can be told from a pair, and over a run of pairs, about whether images and calibration belong together.
struct PairDiagnosis {
  double textured_share = 0.0;   ///< of the cells of a grid of 20 x 8 that show anything to match
  double dark_share = 0.0;       ///< of the pixels of the left image that are black (8 grey levels at most)
  double bright_share = 0.0;     ///< that are white (247 and more)
  PairEvidence evidence;         ///< patches and where they are found along their rows
  std::optional<RowError> rows;  ///< nothing: too few corners to tell
  double rows_spread_px = 0.0;   ///< of a run: between the pairs whose rows differ most (`RowError::differs_px`)
  /// How much nearer places in the upper third of the left image are than those in the lower one, a ratio of
  /// disparities: below 1.2 in 53 pairs of streets and other places, and the inverse when images stand on their heads.
  /// Nothing where too few are found, and for cameras high above the ground, which see tops of trees above and none of
  /// what is near below.
  std::optional<double> nearer_above;
  SideDifference sides;  ///< in what the images differ that should not
  ImageNoise noise;      ///< of the noisier image
  ImageSteps left_steps, right_steps;
  bool road_found = false;  ///< the road's plane agrees with the mount of the camera

  /// Of the patches, those found on their row at or before infinity; 0.32 and more in good pairs of streets.
  double matched_share() const;
  /// Of the places found, those beyond infinity, which cannot be.
  double beyond_share() const;
  /// Whether the rows of all pairs of a run differ by much the same, so that one correction serves all.
  bool rows_agree() const;
  /// Whether nearly all that is found lies at infinity, as where one picture was taken for both.
  bool is_flat() const;
  /// Whether so much of the images is seen and found that more can be concluded from what is found.
  bool can_be_trusted() const;
};

/// Takes some 30 ms; `Detector` does not call it.
/// @param pair 64 x 48 px at least, both images of one size
/// @param road where and how the road is looked for, as `fitted_options` has it for the camera
PairDiagnosis diagnose_pair(const RectifiedPair& pair, const StereoCamera& camera, const RoadOptions& road = {});

/// What a run of pairs says together: sums and medians. Pairs that are swapped where others are not have no say: they
/// are a fault of their own (`PairWatch`).
PairDiagnosis diagnose_run(const std::vector<PairDiagnosis>& pairs);

/// What is not as it should be, one sentence each with what to check; empty when all looks right. These three in their
/// order, the gravest first; what follows from a sentence before is left out.
std::vector<std::string> complaints(const PairDiagnosis& diagnosis);

/// What is seen badly.
std::vector<std::string> complaints_on_sight(const PairDiagnosis& diagnosis);
/// That images and calibration do not go together: where rows lie and what is found on them, the graver of both first.
std::vector<std::string> complaints_on_fit(const PairDiagnosis& diagnosis);
/// That the ground is not where the mount of the camera says.
std::vector<std::string> complaints_on_ground(const PairDiagnosis& diagnosis);

/// Row errors of this size cost obstacles; smaller ones do no harm. Pixels, `RowError::typical_px`.
inline constexpr double kRowErrorMatters_px = 0.5;

/// Larger ones, for an image of 600 columns, are no bent rig: these are other images than the calibration is for.
inline constexpr double kRowErrorOfARig_px = 4.0;

/// Whether a row error is such that moving the right image makes up for it.
bool can_be_made_up_for(const RowError& rows);

}  // namespace flies
