#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "flies/io/images.hpp"
#include "flies/io/pair_source.hpp"

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

/// The pairs of two files or folders, or of one with --split; images without a partner are named in a note on standard
/// error.
/// @throws flies::InputError as `match_pairs` does, for words that are unknown, and when RIGHT is missing or not needed
std::vector<flies::PairPaths> pairs_of(const PairArguments& arguments);

/// A sentence where the EXIF data of images turn them; to be told before a fault that may follow from it.
/// @param pair of files that were read already
std::optional<std::string> orientation_note(const flies::PairPaths& pair);
