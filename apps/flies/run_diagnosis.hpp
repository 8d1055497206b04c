#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "flies/diagnose/pair_diagnosis.hpp"
#include "flies/io/calibration.hpp"
#include "flies/io/pair_source.hpp"
#include "flies/io/writers.hpp"

/// `--self-rectify`: whether errors of the rows are made up for.
enum class SelfRectify {
  automatic,  ///< where they are large enough to cost obstacles
  on,         ///< whatever their size
  off,
};

void add_self_rectify_option(CLI::App& command, SelfRectify& mode);

/// What some pairs, spread evenly over a run, say about images and calibration.
struct RunDiagnosis {
  bool is_known = false;                      ///< false: no pair could be used
  flies::PairDiagnosis diagnosis;             ///< of the images as they are used: after the correction, if any
  std::optional<flies::RowError> correction;  ///< what every pair's rows are corrected by
  std::vector<std::string> notes;             ///< sentences for the user

  void correct(flies::GrayPair& pair) const {
    if (correction) flies::correct_rows(*correction, pair);
  }
  /// Nothing when no pair could be used.
  std::optional<flies::DiagnosisRecord> record() const;
};

/// Diagnoses up to five readable pairs of a run; those that cannot be used are passed over.
RunDiagnosis diagnose(const std::vector<flies::PairPaths>& pairs, const flies::Calibration& calibration,
                      SelfRectify mode);

/// The same of pairs at hand, rectified and of the camera's size.
RunDiagnosis diagnose_sample(std::vector<flies::GrayPair> sample, const flies::Calibration& calibration,
                             SelfRectify mode);
