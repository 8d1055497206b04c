#include "shared/pair_arguments.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <cstddef>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/diagnose/image_borders.hpp"
#include "flies/io/exif.hpp"
#include "flies/io/pair_matching.hpp"
#include "flies/io/text_file.hpp"
#include "shared/notes.hpp"

void add_reading_options(CLI::App& command, ReadingArguments& arguments) {
  command
      .add_option(
          "--split", arguments.split,
          "one file holds both images: side (side by side, left first) or top (one above the other, left on top)")
      ->type_name("HOW");
  command
      .add_option(
          "--bayer", arguments.bayer,
          "the images are raw Bayer mosaics of colour cameras (rggb, bggr, grbg or gbrg) and are converted to grey")
      ->type_name("PATTERN");
}

void add_pair_options(CLI::App& command, PairArguments& arguments) {
  command
      .add_option("LEFT", arguments.left,
                  "left image, or a folder of left images; with --split an image or a folder that holds both")
      ->required();
  command.add_option("RIGHT", arguments.right,
                     "right image, or a folder of right images (see --pair-by); not with --split");
  command
      .add_option(
          "--pair-by", arguments.pair_by,
          "how the images of two folders are paired: by order, name or time, or auto, which decides by the file names")
      ->type_name("HOW");
  add_reading_options(command, arguments.reading);
}

flies::PairReading reading_of(const ReadingArguments& arguments) {
  const auto split = flies::split_of(arguments.split);
  if (!split) throw flies::InputError("--split", arguments.split, "unknown, expected none, side or top");
  flies::PairReading reading{.split = *split};
  if (arguments.bayer.empty()) return reading;
  reading.bayer = flies::bayer_pattern_of(arguments.bayer);
  if (!reading.bayer) throw flies::InputError("--bayer", arguments.bayer, "unknown, expected rggb, bggr, grbg or gbrg");
  return reading;
}

flies::MatchedPairs matched_pairs_of(const PairArguments& arguments) {
  const bool is_joined = reading_of(arguments.reading).split != flies::Split::none;
  if (is_joined && !arguments.right.empty())
    throw flies::InputError("RIGHT", arguments.right, "is not needed: with --split one file holds both images");
  if (!is_joined && arguments.right.empty())
    throw flies::InputError("RIGHT", "",
                            "is missing: give the right image or a folder of them, or --split if LEFT holds both");
  if (is_joined) return {.pairs = flies::find_joined_pairs(arguments.left), .odd = {}};
  const auto by = flies::pair_by_of(arguments.pair_by);
  if (!by) throw flies::InputError("--pair-by", arguments.pair_by, "unknown, expected auto, order, name or time");
  auto found = flies::match_pairs(arguments.left, arguments.right, *by);
  if (!found.odd.empty())
    found.notes.insert(found.notes.begin(),
                       fmt::format("these images have no partner and are left out: {}", fmt::join(found.odd, ", ")));
  return found;
}

std::vector<flies::PairPaths> pairs_of(const PairArguments& arguments) {
  auto found = matched_pairs_of(arguments);
  say_notes(found.notes);
  return std::move(found.pairs);
}

namespace {

/// Refuses images with borders without which they would be of the shape that the calibration is for: scaled with these,
/// all ranges would be wrong, and nothing would tell.
void check_not_padded(const std::string& calib, flies::CalibrationRequest request, const std::string& left,
                      const flies::RectifiedPair& images) {
  const flies::ImageBorders borders = flies::find_borders(images);
  if (!borders.any()) return;
  int width_px = 0, height_px = 0;
  request.width_px = request.height_px = 0;
  request.images_are_resized = false;
  try {
    const auto camera = flies::load_calibration(calib, request).camera;
    width_px = camera.width_px > 0 ? camera.width_px : request.calibrated_width_px;
    height_px = camera.height_px > 0 ? camera.height_px : request.calibrated_height_px;
  } catch (const flies::InputError&) {  // told when it is read for these images
  }
  const int all_width_px = images.left.width_px, all_height_px = images.left.height_px;
  if (width_px == 0 || (all_width_px == width_px && all_height_px == height_px)) return;
  const int inner_width_px = all_width_px - borders.left_px - borders.right_px;
  const int inner_height_px = all_height_px - borders.top_px - borders.bottom_px;
  const auto is_scaled = [&](int width, int height, double within_px) {
    return std::abs(height - static_cast<double>(height_px) * width / width_px) <= within_px;
  };
  const bool is_whole = inner_width_px == width_px && inner_height_px == height_px;
  if (!is_whole && (is_scaled(all_width_px, all_height_px, 1.0) || !is_scaled(inner_width_px, inner_height_px, 2.0)))
    return;
  throw flies::InputError(
      left, "image size",
      fmt::format("found {} x {} px with borders of one grey level (left {}, right {}, top {}, bottom {} px): both "
                  "images were padded or letterboxed. What is inside the borders, {} x {} px, has the shape of the "
                  "calibration's {} x {} px: cut the borders off",
                  all_width_px, all_height_px, borders.left_px, borders.right_px, borders.top_px, borders.bottom_px,
                  inner_width_px, inner_height_px, width_px, height_px));
}

}  // namespace

flies::Calibration calibration_of_files(const std::string& calib, const CameraArguments& camera,
                                        const flies::PairPaths& pair, const flies::RectifiedPair& images) {
  if (const auto note = orientation_note(pair)) say_notes({*note});
  const auto request = calibration_request(camera, pair.left, pair.right, images);
  check_not_padded(calib, request, pair.left, images);
  return flies::load_calibration(calib, request);
}

std::optional<std::string> orientation_note(const flies::PairPaths& pair) {
  constexpr std::size_t kMax_bytes = std::size_t{1} << 30;
  constexpr const char* kTurns[] = {"as stored",
                                    "mirrored",
                                    "turned by 180 degrees",
                                    "mirrored upside down",
                                    "transposed",
                                    "turned clockwise by 90 degrees",
                                    "transposed about the other diagonal",
                                    "turned counter-clockwise by 90 degrees"};
  const auto orientation = [&](const std::string& image) {
    return flies::detail::stored_orientation(flies::read_file(image, kMax_bytes));
  };
  const int left = orientation(pair.left), right = pair.right == pair.left ? left : orientation(pair.right);
  if (left == right && left == 1) return std::nullopt;
  if (left == right)
    return fmt::format(
        "{}: images are {}, as their EXIF orientation says: the calibration must be for images turned in this way",
        pair.left, kTurns[left - 1]);
  return fmt::format(
      "{} and {} differ in their EXIF orientation, which is unlikely for the two images of a pair: the left one is "
      "used {}, the right one {}",
      pair.left, pair.right, kTurns[left - 1], kTurns[right - 1]);
}
