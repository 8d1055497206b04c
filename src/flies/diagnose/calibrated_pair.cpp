#include "flies/diagnose/calibrated_pair.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "flies/core/pair_check.hpp"

namespace flies {
namespace {

/// With fewer patches the scene has too little texture to judge.
constexpr int kMinPatches = 40;
/// What makes a pair of images is a proof when so much is found, and so many times what is found without it: good pairs
/// of streets have 0.32 and more, wrong calibrations up to 0.28.
constexpr double kFound = 0.3, kTimesAsMuch = 3.0;
/// Of the places found, those at infinity where one picture was taken for both.
constexpr double kFlat = 0.98;

/// Another way to rectify a pair, and what is wrong where it is the right one.
struct OtherWay {
  const char* fault;
  const char* way;
  const char* remedy;
  double found_share = 0.0;
};

double share_of(const GrayPair& images, const StereoCamera& camera) {
  const RectifiedPair pair = images.view();
  return order_of_pair(pair, camera) == PairOrder::good ? gather_pair_evidence(pair, camera).matched_share() : 0.0;
}

/// Without rectifying them.
OtherWay as_they_are(const GrayPair& images, const StereoCamera& camera) {
  const PairEvidence evidence = gather_pair_evidence(images.view(), camera);
  const bool is_one_picture = evidence.distant >= kFlat * (evidence.nearer + evidence.distant + evidence.beyond);
  if (is_one_picture)
    return {"both images seem to be of the same camera", "left as they are",
            "give those of the left and of the right one", evidence.matched_share()};
  return {"the images seem to be rectified already, and the calibration is for raw ones", "left as they are",
          "give the calibration of the rectified images", share_of(images, camera)};
}

/// Of a pair that is rectified with another calibration; 0 where that is none.
double share_with(const RawStereo& raw, const GrayPair& as_read) {
  try {
    const Rectifier rectifier(raw, "calibration");
    return share_of(rectifier.rectify(as_read), rectifier.camera());
  } catch (const InputError&) {
    return 0.0;
  }
}

RawStereo with_intrinsics_exchanged(RawStereo raw) {
  std::swap(raw.left, raw.right);
  return raw;
}

RawStereo with_rotation_transposed(RawStereo raw) {
  constexpr std::size_t kSide = 3;
  for (std::size_t row = 0; row < kSide; ++row)
    for (std::size_t column = 0; column < row; ++column)
      std::swap(raw.rotation[kSide * row + column], raw.rotation[kSide * column + row]);
  return raw;
}

/// The way in which most of the pair is found.
OtherWay best_other_way(const Calibration& calibration, GrayPair as_read) {
  const RawStereo& raw = calibration.rectifier->raw();
  std::array ways{as_they_are(as_read, calibration.camera),
                  OtherWay{"the intrinsics of the two cameras seem to be exchanged in the calibration",
                           "rectified with each other's", "exchange M1 and M2, D1 and D2",
                           share_with(with_intrinsics_exchanged(raw), as_read)},
                  OtherWay{"the rotation R of the calibration seems to be transposed", "rectified with its transpose",
                           "transpose it", share_with(with_rotation_transposed(raw), as_read)},
                  OtherWay{"left and right seem to be swapped, or both images turned by 180 degrees",
                           "rectified the other way round", "exchange them, or turn them back"}};
  std::swap(as_read.left, as_read.right);
  ways.back().found_share = share_of(calibration.rectifier->rectify(as_read), calibration.camera);
  return *std::ranges::max_element(ways, {}, &OtherWay::found_share);
}

}  // namespace

void check_calibrated_pair(const RectifiedPair& pair, const Calibration& calibration, const ReadPair& as_read,
                           const std::string& left_name, const std::string& right_name) {
  const StereoCamera& camera = calibration.camera;
  if (!calibration.rectifier) return check_true_pair(pair, camera, left_name, right_name);
  const PairEvidence evidence = gather_pair_evidence(pair, camera);
  const double least_share = std::max(kFound, kTimesAsMuch * evidence.matched_share());
  if (as_read && evidence.patches >= kMinPatches && least_share < 1.0) {
    const OtherWay other = best_other_way(calibration, as_read());
    if (other.found_share >= least_share)
      throw WronglyRectified(
          left_name, "",
          fmt::format("{}: {}, {:.0f} % of the places are found on the same row of {}, as given only "
                      "{:.0f} %; {}",
                      other.fault, other.way, 100.0 * other.found_share, right_name, 100.0 * evidence.matched_share(),
                      other.remedy));
  }
  check_true_pair(pair, camera, left_name, right_name, RectifiedBy::calibration);
}

}  // namespace flies
