#include "flies/diagnose/pair_diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "flies/core/quantile.hpp"
#include "flies/diagnose/image_cells.hpp"

namespace flies {
namespace {

constexpr int kDark_gray = 8, kBright_gray = 247;

/// Below this nothing is to be seen: a lens cap, fog, darkness.
constexpr double kNothingTextured = 0.1;
constexpr int kMinPatches = 40;
/// Good pairs of streets have 0.32 and more; wrong calibrations, rows 3 px apart and other frames less than 0.2.
constexpr double kFewMatched = 0.2;
/// Told; and so many that nothing else can be concluded. In good pairs 0.027 at most, one or two places.
constexpr double kSomeBeyond = 0.03, kManyBeyond = 0.15;
constexpr int kMinSomeBeyond = 3, kMinBeyond = 8;
/// With fewer, images that are not of one moment, or raw, look like those of another focal length.
constexpr double kManyMatched = 0.4;
/// So many that left and right are swapped.
constexpr double kSwappedShare = 0.8;
constexpr int kMinSwapped = 12;
/// Of the places found, those at infinity in one picture taken twice; streets show something nearer.
constexpr double kFlat = 0.98;
constexpr int kMinFlat = 30;
/// A part of the image this large that is black or white is told, whatever the rest shows: 0.41 in good pairs.
constexpr double kMuchHidden = 0.5;
/// Corners scatter this much about a line over the columns where rows differ otherwise; 0.2 px in good pairs.
constexpr double kScatterMatters_px = 0.7;
/// Rows of good pairs of one rig differ by less than that from pair to pair; those of a rig that was knocked by more.
constexpr double kRowsAgree_px = 1.5;
/// See `PairDiagnosis::nearer_above`.
constexpr double kNearerAbove = 1.4;
/// A camera higher than that is on a mast or a drone.
constexpr double kHigh_m = 4.0;

void see_levels(const GrayView& image, PairDiagnosis& diagnosis) {
  double dark = 0.0, bright = 0.0;
  for (int v = 0; v < image.height_px; ++v)
    for (int u = 0; u < image.width_px; ++u) {
      dark += image.row(v)[u] <= kDark_gray;
      bright += image.row(v)[u] >= kBright_gray;
    }
  const double pixels = static_cast<double>(image.width_px) * image.height_px;
  const CellGrid textured = textured_cells(image);
  diagnosis.textured_share =
      static_cast<double>(std::count(textured.begin(), textured.end(), true)) / static_cast<double>(textured.size());
  diagnosis.dark_share = dark / pixels;
  diagnosis.bright_share = bright / pixels;
}

double spread_px(const std::vector<RowError>& rows) {
  double spread_px = 0.0;
  for (const auto& a : rows)
    for (const auto& b : rows) spread_px = std::max(spread_px, a.differs_px(b));
  return spread_px;
}

/// Of the patches, those found on their row, beyond infinity too.
double found_share(const PairDiagnosis& d) {
  return d.matched_share() + d.evidence.beyond / std::max(1.0, 1.0 * d.evidence.patches);
}

bool has_many_beyond(const PairDiagnosis& d) {
  return d.evidence.beyond >= kMinBeyond && d.beyond_share() > kManyBeyond;
}

/// Few are before infinity, and not because many are found beyond it.
bool has_few_matched(const PairDiagnosis& d) {
  const bool are_beyond = has_many_beyond(d) && found_share(d) >= kFewMatched;
  return d.evidence.patches >= kMinPatches && d.matched_share() < kFewMatched && !are_beyond;
}

/// No principal point is so wrong that most of a scene is beyond infinity.
bool is_swapped(const PairDiagnosis& d) {
  return !has_few_matched(d) && d.evidence.beyond >= kMinSwapped && d.beyond_share() > kSwappedShare;
}

/// Whether the images surely show one moment, rectified: most of what they show is found, and the road among it.
bool is_one_moment(const PairDiagnosis& d) {
  return d.road_found && (d.evidence.patches < kMinPatches || found_share(d) >= kManyMatched);
}

/// That no road is found follows from what is told already.
bool is_explained(const PairDiagnosis& d) { return has_few_matched(d) || is_swapped(d); }

/// What is told of the places that were found, of the gravest alone: from few that match at all follows where chance
/// finds the others.
std::optional<std::string> told_places(const PairDiagnosis& d) {
  if (has_few_matched(d))
    return fmt::format(
        "only {:.0f} % of the places in the left image are found on the same row of the right one (32 % or more in "
        "good pairs): check that the calibration belongs to these cameras and these images (rectified or raw, R "
        "present and not transposed), and that both images were taken at the same moment (neither camera late or "
        "hanging)",
        100.0 * d.matched_share());
  if (is_swapped(d))
    return fmt::format(
        "{:.0f} % of the places that are found would lie beyond infinity (negative disparity): are left and right "
        "swapped, or both images mirrored or turned by 180 degrees?",
        100.0 * d.beyond_share());
  if (d.evidence.beyond < kMinSomeBeyond || d.beyond_share() <= kSomeBeyond) return std::nullopt;
  return fmt::format(
      "{:.0f} % of the places that are found would lie beyond infinity (negative disparity): the cameras look towards "
      "each other or a principal point is wrong, and so are all ranges; check cx of both cameras, whether the "
      "calibration is for raw or for rectified images, and that both images were taken at the same moment",
      100.0 * d.beyond_share());
}

std::string told_growth(const RowError& rows, bool is_certain) {
  const std::string lower =
      rows.typical_px() < kRowErrorMatters_px
          ? ""
          : fmt::format(", and its rows lie {:+.1f} px lower in the middle, {:+.1f} and {:+.1f} px at the sides",
                        rows.offset_px, rows.at(0.0), rows.at(2.0 * rows.middle_u_px));
  return fmt::format("the right image is {:.1f} % {} than the left one{}: {}", 100.0 * std::abs(rows.growth),
                     rows.growth > 0.0 ? "larger" : "smaller", lower,
                     is_certain
                         ? "the focal lengths are not those of the calibration (a zoom, or one image was resized "
                           "differently), so ranges are wrong, and moving rows does not correct that; calibrate again"
                         : "possible causes are a late image, raw images with the calibration of rectified ones, an R "
                           "that is transposed or left out, and a zoom of one camera");
}

std::string told_offset(const RowError& rows) {
  return fmt::format(
      "rows of the right image lie {:+.1f} px lower than those of the left one in the middle, {:+.1f} and {:+.1f} px "
      "at the sides: {}",
      rows.offset_px, rows.at(0.0), rows.at(2.0 * rows.middle_u_px),
      can_be_made_up_for(rows)
          ? "the pair is not quite rectified (the rig was bent, or the calibration is of another rig); --self-rectify "
            "on corrects it"
          : "the pair is not rectified; check that the calibration is of these cameras and says whether these images "
            "are raw or rectified");
}

std::optional<std::string> told_rows(const PairDiagnosis& d) {
  if (!d.rows_agree())
    return fmt::format(
        "the offset between the rows of left and right changes from pair to pair, by up to {:.1f} px, so that no "
        "single correction fits all: {}",
        d.rows_spread_px,
        has_few_matched(d) ? "likely causes are images taken at different moments, or a loose camera"
                           : "was a camera knocked, is one loose, or is one late or hanging in some pairs?");
  if (!d.rows) return std::nullopt;
  if (d.rows->growth != 0.0) return told_growth(*d.rows, is_one_moment(d));
  if (d.rows->typical_px() >= kRowErrorMatters_px) return told_offset(*d.rows);
  if (d.rows->scatter_px < kScatterMatters_px) return std::nullopt;
  return fmt::format(
      "rows of left and right lie {:.1f} px apart in parts of the image: focal length or distortion of one camera is "
      "not that of the calibration",
      d.rows->scatter_px);
}

std::string what_hides(const PairDiagnosis& d) {
  if (d.dark_share > kMuchHidden) return "the image is nearly black (a lens cap, night, too short an exposure)";
  if (d.bright_share > kMuchHidden) return "the image is nearly white (the sun, too long an exposure)";
  return "the image is nearly uniform (a lens cap, fog, a wall)";
}

std::optional<std::string> told_combing(const PairDiagnosis& d) {
  const bool left = d.left_steps.is_combed(), right = d.right_steps.is_combed();
  if (!left && !right) return std::nullopt;
  return fmt::format(
      "every other row of {} was taken at another moment than the rows between: this is interlaced video, in which "
      "moving things are matched badly; keep only one field (every other row) of both images and give --resized, or "
      "deinterlace them",
      left && right ? "both images"
      : left        ? "the left image"
                    : "the right image");
}

/// Nothing can be said of where places are found.
bool shows_nothing(const PairDiagnosis& d) { return d.textured_share < kNothingTextured || d.is_flat(); }

void add_what_is_seen_badly(const PairDiagnosis& d, std::vector<std::string>& found) {
  if (auto combing = told_combing(d)) found.push_back(*std::move(combing));
  if (d.left_steps.is_blurred() && d.right_steps.is_blurred())
    found.push_back(
        "both images are blurred, nothing in them is sharp to a pixel: are both cameras out of focus, or were the "
        "images enlarged?");
  const bool is_hidden = std::max(d.dark_share, d.bright_share) > kMuchHidden;
  if (is_hidden)
    found.push_back(fmt::format("nothing can be seen in much of the image: {}", what_hides(d)));
  else
    for (auto& complaint : complaints(d.sides)) found.push_back(std::move(complaint));
  if (d.noise.is_much() && (is_hidden || !d.sides.is_noisy_on_one_side()))
    found.push_back(fmt::format(
        "the images are noisy: pixels vary by {:.1f} grey levels at random and by {:.1f} with the scene, so "
        "things are missed; more light, a longer exposure or less gain help",
        d.noise.noise_gray, d.noise.contrast_gray));
}

}  // namespace

double PairDiagnosis::matched_share() const { return evidence.matched_share(); }

double PairDiagnosis::beyond_share() const {
  const int found = evidence.nearer + evidence.distant + evidence.beyond;
  return found == 0 ? 0.0 : static_cast<double>(evidence.beyond) / found;
}

bool PairDiagnosis::rows_agree() const { return rows_spread_px <= kRowsAgree_px; }

bool PairDiagnosis::is_flat() const {
  const int found = evidence.nearer + evidence.distant + evidence.beyond;
  return found >= kMinFlat && evidence.distant >= kFlat * found;
}

bool PairDiagnosis::can_be_trusted() const {
  const bool is_found = evidence.patches < kMinPatches || matched_share() >= kFewMatched;
  return textured_share >= kNothingTextured && !is_flat() && is_found && !has_many_beyond(*this);
}

PairDiagnosis diagnose_pair(const RectifiedPair& pair, const StereoCamera& camera, const RoadOptions& road) {
  PairDiagnosis diagnosis;
  see_levels(pair.left, diagnosis);
  diagnosis.evidence = gather_pair_evidence(pair, camera);
  const auto& [upper_px, lower_px] = std::pair(diagnosis.evidence.upper_px, diagnosis.evidence.lower_px);
  if (upper_px > 0.0 && lower_px > 0.0 && camera.mount.height_m <= kHigh_m)
    diagnosis.nearer_above = upper_px / lower_px;
  diagnosis.sides = compare_sides(pair);
  diagnosis.noise = diagnosis.sides.noise();
  diagnosis.left_steps = measure_steps(pair.left);
  diagnosis.right_steps = measure_steps(pair.right);
  diagnosis.rows = fit_row_error(match_corners(pair), pair.left.width_px, pair.left.height_px);
  diagnosis.road_found = estimate_road(pair, Projection(camera), road).found;
  return diagnosis;
}

PairDiagnosis diagnose_run(const std::vector<PairDiagnosis>& all) {
  PairDiagnosis run;
  if (all.empty()) return run;
  std::vector<PairDiagnosis> pairs;
  std::ranges::remove_copy_if(all, std::back_inserter(pairs), is_swapped);
  if (pairs.empty()) pairs = all;
  std::vector<double> textured, dark, bright, nearer_above;
  std::vector<RowError> rows;
  std::vector<SideDifference> sides;
  std::vector<ImageNoise> noise;
  std::vector<ImageSteps> left_steps, right_steps;
  int roads = 0;
  for (const auto& pair : pairs) {
    textured.push_back(pair.textured_share);
    dark.push_back(pair.dark_share);
    bright.push_back(pair.bright_share);
    run.evidence.patches += pair.evidence.patches;
    run.evidence.nearer += pair.evidence.nearer;
    run.evidence.beyond += pair.evidence.beyond;
    run.evidence.distant += pair.evidence.distant;
    sides.push_back(pair.sides);
    noise.push_back(pair.noise);
    left_steps.push_back(pair.left_steps);
    right_steps.push_back(pair.right_steps);
    if (pair.rows) rows.push_back(*pair.rows);
    if (pair.nearer_above) nearer_above.push_back(*pair.nearer_above);
    roads += pair.road_found;
  }
  run.textured_share = upper_median(std::move(textured));
  run.dark_share = upper_median(std::move(dark));
  run.bright_share = upper_median(std::move(bright));
  if (!nearer_above.empty()) run.nearer_above = upper_median(std::move(nearer_above));
  run.sides = median_side_difference(sides);
  run.noise = median_noise(std::move(noise));
  run.left_steps = median_steps(left_steps);
  run.right_steps = median_steps(right_steps);
  run.rows = median_row_error(rows);
  run.rows_spread_px = spread_px(rows);
  run.road_found = roads > 0;
  return run;
}

bool can_be_made_up_for(const RowError& rows) {
  constexpr double kColumns_px = 600.0;
  return rows.largest_px() <= kRowErrorOfARig_px * std::max(1.0, 2.0 * rows.middle_u_px / kColumns_px);
}

std::vector<std::string> complaints_on_sight(const PairDiagnosis& d) {
  if (d.textured_share < kNothingTextured)
    return {
        fmt::format("there is nothing to match in {:.0f} % of the left image, so nothing seen does not mean "
                    "that nothing is there: {}",
                    100.0 * (1.0 - d.textured_share), what_hides(d))};
  if (d.is_flat())
    return {
        "everything that is found in both images lies at infinity: are they the same picture twice, or both of one "
        "camera, or is everything that far away?"};
  std::vector<std::string> found;
  add_what_is_seen_badly(d, found);
  return found;
}

std::vector<std::string> complaints_on_fit(const PairDiagnosis& d) {
  if (shows_nothing(d)) return {};
  std::vector<std::string> found;
  const auto add = [&](std::optional<std::string> complaint) {
    if (complaint) found.push_back(*std::move(complaint));
  };
  const bool are_places_graver = has_few_matched(d) || has_many_beyond(d);
  if (are_places_graver) add(told_places(d));
  if (!is_swapped(d)) add(told_rows(d));
  if (!are_places_graver) add(told_places(d));
  return found;
}

std::vector<std::string> complaints_on_ground(const PairDiagnosis& d) {
  if (shows_nothing(d) || d.road_found) return {};
  std::vector<std::string> found;
  if (d.nearer_above.value_or(0.0) > kNearerAbove && d.can_be_trusted())
    found.push_back(
        fmt::format("places in the upper third of the images are {:.1f} times as near as those in the lower third: are "
                    "these tree tops, a ceiling or a bridge, and the ground far below? If not, the images are upside "
                    "down: turn both by 180 degrees and give the right one as the left",
                    *d.nearer_above));
  if (!is_explained(d))
    found.push_back(
        "no road was found where the mount of the camera says it is: heights and obstacles may be wrong; check "
        "--camera-height and --camera-pitch, the calibration and the unit of its baseline, and that both images were "
        "taken at the same moment");
  return found;
}

std::vector<std::string> complaints(const PairDiagnosis& d) {
  std::vector<std::string> all = complaints_on_sight(d);
  for (const auto& more : {complaints_on_fit(d), complaints_on_ground(d)})
    all.insert(all.end(), more.begin(), more.end());
  return all;
}

}  // namespace flies
