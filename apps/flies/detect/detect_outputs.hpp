#pragma once

#include <string>
#include <vector>

#include "flies/io/pair_source.hpp"
#include "shared/output_claims.hpp"

/// Where `flies detect` writes, as given on the command line; empty: not asked for. "-" is standard output.
struct DetectOutputs {
  std::string json, csv, scan;                                          ///< one file for all pairs
  std::string ply, overlay, top_view, flies, histogram, concentrating;  ///< one file per pair

  bool any() const;
};

/// The name of a file without folder and extension: the frame's name in JSON and in the names of its pictures.
std::string file_stem(const std::string& path);

/// The file of one pair: the path itself for a single pair, otherwise with the frame's name before the extension,
/// `found.png` -> `found_0000000012.png`.
std::string path_of_frame(const std::string& path, const std::string& frame, bool is_single_pair);

/// Refuses, before any work is done, outputs that cannot be written, two that are the same file and those that would
/// overwrite an input.
/// @param claims that know the files which are read beside the pairs: calibration, options, model
/// @throws flies::InputError naming the file and the option
void check_outputs(const DetectOutputs& outputs, const std::vector<flies::PairPaths>& pairs, OutputClaims claims);
