#include "shared/pair_arguments.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstddef>
#include <utility>

#include "flies/core/error.hpp"
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
  const auto by = flies::pair_by_of(arguments.pair_by);
  if (!by) throw flies::InputError("--pair-by", arguments.pair_by, "unknown, expected auto, order, name or time");
  if (is_joined && arguments.pair_by != PairArguments{}.pair_by)
    throw flies::InputError("--pair-by", arguments.pair_by,
                            "is for two folders, and with --split one holds both images");
  if (is_joined) return {.pairs = flies::find_joined_pairs(arguments.left), .odd = {}};
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

flies::Calibration calibration_of_files(const std::string& calib, const CameraArguments& camera,
                                        const flies::PairPaths& pair, const flies::RectifiedPair& images) {
  if (const auto note = orientation_note(pair)) say_notes({*note});
  return calibration_for(calib, camera, pair.left, pair.right, images);
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
