#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "flies/io/calibration.hpp"
#include "flies/io/images.hpp"
#include "flies/io/pair_matching.hpp"
#include "flies/io/pair_source.hpp"
#include "shared/camera_arguments.hpp"

/// How the user says that files hold pairs: --split and --bayer.
struct ReadingArguments {
  std::string split = "none", bayer;
};

/// Images or folders of a pair, or of pairs.
struct PairArguments {
  std::string left, right;
  std::string pair_by = "auto";
  ReadingArguments reading;
};

/// Adds --split and --bayer.
void add_reading_options(CLI::App& command, ReadingArguments& arguments);

/// Adds LEFT, RIGHT, --pair-by, --split and --bayer.
void add_pair_options(CLI::App& command, PairArguments& arguments);

/// @throws flies::InputError for words that are unknown
flies::PairReading reading_of(const ReadingArguments& arguments);

/// The pairs of two files or folders, or of one with --split; images without a partner are named in its notes.
/// @throws flies::InputError as `match_pairs` does, for words that are unknown, and when RIGHT is missing or not needed
flies::MatchedPairs matched_pairs_of(const PairArguments& arguments);

/// The same, its notes told on standard error.
std::vector<flies::PairPaths> pairs_of(const PairArguments& arguments);

/// The calibration for a pair of files that was read; tells on standard error where they say that they are turned.
/// @throws flies::InputError as `flies::load_calibration` does
flies::Calibration calibration_of_files(const std::string& calib, const CameraArguments& camera,
                                        const flies::PairPaths& pair, const flies::RectifiedPair& images);

/// A sentence where the EXIF data of images turn them; to be told before a fault that may follow from it.
/// @param pair of files that were read already
std::optional<std::string> orientation_note(const flies::PairPaths& pair);
