#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/diagnose/pair_diagnosis.hpp"
#include "flies/io/calibration.hpp"
#include "flies/io/images.hpp"
#include "flies/io/pair_source.hpp"
#include "flies/io/writers.hpp"
#include "flies/pipeline/detector.hpp"
#include "flies/road/find_mount.hpp"

/// `--self-rectify`: whether errors of the rows are made up for.
enum class SelfRectify {
  automatic,  ///< where they are large enough to cost obstacles
  on,         ///< whatever their size
  off,
};

/// What a run may change of what it was told.
struct RunCorrections {
  SelfRectify self_rectify = SelfRectify::automatic;
  bool find_mount = true;  ///< `--mount auto`: the mount is taken from the road where it clearly lies elsewhere
  /// The options of the run for a camera, by which the road is looked for; empty: those of the default preset.
  std::function<flies::DetectorOptions(const flies::StereoCamera&)> options = {};
};

void add_correction_options(CLI::App& command, RunCorrections& corrections);

/// `--mount` alone.
void add_mount_option(CLI::App& command, bool& find_mount);

/// What some pairs, spread evenly over a run, say about images and calibration.
struct RunDiagnosis {
  bool is_known = false;  ///< false: no pair could be used
  /// Of the images as they are used: after the correction, if any. Its road is also found where the mount's search
  /// sees the ground where it was told to be.
  flies::PairDiagnosis diagnosis;
  std::optional<flies::RowError> correction;  ///< what every pair's rows are corrected by
  flies::MountFinding mount;                  ///< how the camera is mounted
  bool road_is_found = false;                 ///< by the options of the run, as its results have it in some pair
  std::vector<std::string> notes;             ///< sentences for the user, the gravest first
  std::size_t notes_on_files = 0;             ///< the first ones

  void correct(flies::GrayPair& pair) const {
    if (correction) flies::correct_rows(*correction, pair);
  }
  /// Nothing when no pair could be used.
  std::optional<flies::DiagnosisRecord> record() const;
};

/// Loads one pair of a run. @throws flies::InputError when it cannot be used
using LoadPair = std::function<flies::GrayPair(std::size_t)>;

/// Diagnoses up to five readable pairs of a run; those that cannot be used are passed over.
/// @param calibration gets the mount that was found, where it is to be used
RunDiagnosis diagnose(std::size_t pairs, const LoadPair& load, flies::Calibration& calibration,
                      const RunCorrections& corrections);

/// The same of pairs at hand, rectified and of the camera's size.
RunDiagnosis diagnose_sample(std::vector<flies::GrayPair> sample, flies::Calibration& calibration,
                             const RunCorrections& corrections);

/// Finds the calibration for a pair that was read. @throws flies::InputError when there is none for it
using Calibrate = std::function<flies::Calibration(const flies::PairPaths&, const flies::RectifiedPair&)>;

/// A run before its first result.
struct CalibratedRun {
  std::vector<flies::PairPaths> paths;  ///< what the pairs are called
  LoadPair load;
  std::vector<std::size_t> sample;  ///< readable pairs of the size that most of up to five have, in order; at least one
  flies::Calibration calibration;   ///< for that size, with the mount that is to be used
  RunDiagnosis diagnosis;
  /// Why the first pair of the sample is none, where no other one is a true pair either.
  std::optional<flies::InputError> refusal;

  const flies::PairPaths& first() const { return paths[sample.front()]; }

  /// A pair as the method wants it. @throws flies::InputError when it cannot be used
  flies::GrayPair usable(std::size_t pair) const;

  /// @param images of that pair, as `usable` gave them
  /// @throws flies::InputError when they are no pair, and why
  void require_true_pair(std::size_t pair, const flies::GrayPair& images) const;

  /// Sentences for the user, each with its file before it: of the calibration `calib`, and on the images.
  std::vector<std::string> notes(const std::string& calib) const;
};

/// Reads up to five pairs of a run, spread evenly, finds the calibration for the size that most of them have, and
/// diagnoses those: one odd pair costs the run nothing, wherever it stands. Where none of them can be read, the first
/// one that can counts.
/// @param paths at least one
/// @param calib name of the calibration, for errors
/// @throws flies::InputError of the first pair when none can be read, and when calibration and size do not go together
CalibratedRun calibrate_run(std::vector<flies::PairPaths> paths, LoadPair load, const Calibrate& calibrate,
                            const std::string& calib, const RunCorrections& corrections);
