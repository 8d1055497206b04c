#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "flies/io/images.hpp"
#include "flies/io/pair_source.hpp"

class Recording;

/// Pairs of a sequence with their times.
struct SequenceSource {
  std::vector<flies::PairPaths> pairs;              ///< of a recording what they are called
  std::vector<double> times_s;                      ///< one a pair
  std::string calib;                                ///< the one beside a KITTI raw drive, unless another was given
  std::vector<std::string> files;                   ///< that are read beside the images: calibration, times, recording
  std::vector<std::string> notes;                   ///< sentences on what was assumed
  std::shared_ptr<const Recording> recording = {};  ///< where the pairs come from one
  flies::PairReading reading = {};                  ///< how their files hold them

  /// @throws flies::InputError when its images are damaged
  flies::GrayPair load(std::size_t pair) const;
};

struct SequenceRequest {
  std::vector<std::string>
      sources;  ///< a KITTI raw drive, a drawn sequence, a recording, or two folders; with a split one
  flies::PairReading reading = {};  ///< how files of folders hold pairs
  std::string calib;                ///< empty: that of the drive
  std::string times;                ///< file of times, a line a pair; empty: see below
  std::optional<double> rate_hz;    ///< pairs a second
  std::vector<std::string> topics;  ///< of a recording, left and right, with a split one; none: found by their names
  std::optional<std::array<int, 2>> cameras;  ///< of a drive; else 0 and 1 if there, else 2 and 3
};

/// Times: those of `times`, which overrules `rate_hz` with a note, else by `rate_hz`, which overrules the following
/// with a note, else the drive's own image_XX/timestamps.txt or the recording's, else those in the names, else 10 Hz,
/// with notes. The numbers in the names say which times of a file are meant, and where pairs are missing.
/// @throws flies::InputError when a source is missing, counts differ, a drive lacks its calibration, or topics are
///         asked for without a recording
SequenceSource open_sequence(const SequenceRequest& request);
