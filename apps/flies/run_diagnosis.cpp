#include "run_diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/io/images.hpp"

namespace {

constexpr std::size_t kPairs = 5;

bool is_to_be_corrected(const std::optional<flies::RowError>& rows, SelfRectify mode) {
  if (!rows || mode == SelfRectify::off) return false;
  if (mode == SelfRectify::on) return true;
  return rows->typical_px() >= flies::kRowErrorMatters_px && flies::can_be_made_up_for(*rows);
}

}  // namespace

void add_self_rectify_option(CLI::App& command, SelfRectify& mode) {
  static const std::map<std::string, SelfRectify> kModes = {
      {"auto", SelfRectify::automatic}, {"on", SelfRectify::on}, {"off", SelfRectify::off}};
  command
      .add_option_function<std::string>(
          "--self-rectify",
          [&mode](const std::string& name) {
            const auto found = kModes.find(name);
            if (found == kModes.end())
              throw flies::InputError("command line", "--self-rectify",
                                      fmt::format("found '{}', expected auto, on or off", name));
            mode = found->second;
          },
          fmt::format("make up for rows of left and right that lie apart: auto (from {:g} px), on or off",
                      flies::kRowErrorMatters_px))
      ->type_name("MODE");
}

std::optional<flies::DiagnosisRecord> RunDiagnosis::record() const {
  if (!is_known) return std::nullopt;
  flies::DiagnosisRecord record;
  record.textured_share = diagnosis.textured_share;
  record.matched_share = diagnosis.matched_share();
  record.beyond_share = diagnosis.beyond_share();
  record.road_found = diagnosis.road_found;
  if (diagnosis.rows) {
    record.row_offset_px = diagnosis.rows->offset_px;
    record.row_roll_rad = diagnosis.rows->slope;
  }
  if (correction) record.corrected_offset_px = correction->offset_px;
  record.notes = notes;
  return record;
}

RunDiagnosis diagnose(const std::vector<flies::PairPaths>& pairs, const flies::Calibration& calibration,
                      SelfRectify mode) {
  std::vector<flies::GrayPair> sample;
  const std::size_t count = std::min(kPairs, pairs.size());
  for (std::size_t k = 0; k < count; ++k) {
    const auto& [left, right] = pairs[count == 1 ? 0 : k * (pairs.size() - 1) / (count - 1)];
    try {
      flies::GrayPair images = flies::load_pair(left, right);
      if (calibration.rectifier) images = calibration.rectifier->rectify(images);
      const flies::RectifiedPair view = images.view();
      flies::check_camera_fits(calibration.camera, view.left.width_px, view.left.height_px, left);
      sample.push_back(std::move(images));
    } catch (const flies::InputError&) {  // told when its turn comes
    }
  }
  return diagnose_sample(std::move(sample), calibration, mode);
}

RunDiagnosis diagnose_sample(std::vector<flies::GrayPair> sample, const flies::Calibration& calibration,
                             SelfRectify mode) {
  RunDiagnosis run;
  if (sample.empty()) return run;
  run.is_known = true;
  const auto diagnose_now = [&] {
    std::vector<flies::PairDiagnosis> each;
    for (const auto& images : sample) each.push_back(flies::diagnose_pair(images.view(), calibration.camera));
    return flies::diagnose_run(each);
  };
  run.diagnosis = diagnose_now();
  if (is_to_be_corrected(run.diagnosis.rows, mode)) {
    run.correction = run.diagnosis.rows;
    run.notes.push_back(fmt::format(
        "rows of the right image lie {:+.1f} px lower than those of the left one ({:+.1f} and {:+.1f} px at the "
        "sides): "
        "made up for; calibrate again, or --self-rectify off",
        run.correction->offset_px, run.correction->at(0.0), run.correction->at(2.0 * run.correction->middle_u_px)));
    for (auto& images : sample) run.correct(images);
    run.diagnosis = diagnose_now();
  }
  for (auto& complaint : flies::complaints(run.diagnosis)) run.notes.push_back(std::move(complaint));
  return run;
}
