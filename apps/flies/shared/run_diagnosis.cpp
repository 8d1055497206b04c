#include "shared/run_diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/io/images.hpp"
#include "flies/pipeline/detector.hpp"

namespace {

constexpr std::size_t kPairs = 5;

bool is_to_be_corrected(const std::optional<flies::RowError>& rows, SelfRectify mode) {
  if (!rows || mode == SelfRectify::off) return false;
  if (mode == SelfRectify::on) return true;
  return rows->typical_px() >= flies::kRowErrorMatters_px && flies::can_be_made_up_for(*rows);
}

/// An option whose values have names.
template <class Value>
void add_named_option(CLI::App& command, const std::string& option, Value& value, std::map<std::string, Value> names,
                      const std::string& expected, const std::string& meaning) {
  command
      .add_option_function<std::string>(
          option,
          [&value, option, names = std::move(names), expected](const std::string& name) {
            const auto found = names.find(name);
            if (found == names.end())
              throw flies::InputError("command line", option, fmt::format("found '{}', expected {}", name, expected));
            value = found->second;
          },
          meaning)
      ->type_name("MODE");
}

std::vector<flies::GrayPair> load_sample(std::size_t pairs, const LoadPair& load,
                                         const flies::Calibration& calibration) {
  std::vector<flies::GrayPair> sample;
  const std::size_t count = std::min(kPairs, pairs);
  for (std::size_t k = 0; k < count; ++k) {
    try {
      flies::GrayPair images = load(count == 1 ? 0 : k * (pairs - 1) / (count - 1));
      if (calibration.rectifier) images = calibration.rectifier->rectify(images);
      const flies::RectifiedPair view = images.view();
      flies::check_camera_fits(calibration.camera, view.left.width_px, view.left.height_px, "pair");
      sample.push_back(std::move(images));
    } catch (const flies::InputError&) {  // told when its turn comes
    }
  }
  return sample;
}

flies::MountFinding mount_of(const std::vector<flies::GrayPair>& sample, const flies::StereoCamera& camera) {
  std::vector<flies::RectifiedPair> views;
  for (const auto& images : sample) views.push_back(images.view());
  return flies::find_mount(views, camera);
}

}  // namespace

void add_mount_option(CLI::App& command, bool& find_mount) {
  add_named_option<bool>(command, "--mount", find_mount, {{"auto", true}, {"given", false}}, "auto or given",
                         "auto: height and tilt of the camera are taken from the road where it clearly lies elsewhere "
                         "than was given; given: as given");
}

void add_correction_options(CLI::App& command, RunCorrections& corrections) {
  add_mount_option(command, corrections.find_mount);
  add_named_option<SelfRectify>(
      command, "--self-rectify", corrections.self_rectify,
      {{"auto", SelfRectify::automatic}, {"on", SelfRectify::on}, {"off", SelfRectify::off}}, "auto, on or off",
      fmt::format("make up for rows of left and right that lie apart: auto (from {:g} px), on or off",
                  flies::kRowErrorMatters_px));
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
  record.mount = mount.mount;
  record.mount_is_from_road = mount.is_replaced;
  record.notes = notes;
  return record;
}

FirstPair first_readable(std::size_t pairs, const LoadPair& load) {
  std::optional<flies::InputError> fault;
  for (std::size_t i = 0; i < pairs; ++i) {
    try {
      return {i, load(i)};
    } catch (const flies::InputError& error) {
      if (!fault) fault = error;
    }
  }
  throw flies::InputError(*fault);
}

RunDiagnosis diagnose(const std::vector<flies::PairPaths>& pairs, const flies::PairReading& reading,
                      flies::Calibration& calibration, const RunCorrections& corrections) {
  const auto load = [&](std::size_t pair) { return flies::load_pair(pairs[pair], reading); };
  return diagnose(pairs.size(), load, calibration, corrections);
}

RunDiagnosis diagnose(std::size_t pairs, const LoadPair& load, flies::Calibration& calibration,
                      const RunCorrections& corrections) {
  std::optional<std::string> mosaic;
  std::vector<std::string> notes;  // on the files
  const LoadPair look_and_load = [&](std::size_t pair) {
    auto images = load(pair);
    if (!mosaic) mosaic = flies::mosaic_note(images.view());
    if (notes.empty()) notes = images.notes;
    return images;
  };
  auto run = diagnose_sample(load_sample(pairs, look_and_load, calibration), calibration, corrections);
  if (mosaic) notes.push_back(*mosaic);
  run.notes.insert(run.notes.begin(), notes.begin(), notes.end());
  return run;
}

RunDiagnosis diagnose_sample(std::vector<flies::GrayPair> sample, flies::Calibration& calibration,
                             const RunCorrections& corrections) {
  RunDiagnosis run;
  run.mount.told = run.mount.mount = calibration.camera.mount;
  if (sample.empty()) return run;
  run.is_known = true;
  const auto diagnose_now = [&] {
    std::vector<flies::PairDiagnosis> each;
    const auto road = flies::fitted_options(calibration.camera, {}).road;
    for (const auto& images : sample) each.push_back(flies::diagnose_pair(images.view(), calibration.camera, road));
    return flies::diagnose_run(each);
  };
  run.diagnosis = diagnose_now();
  if (is_to_be_corrected(run.diagnosis.rows, corrections.self_rectify)) {
    run.correction = run.diagnosis.rows;
    run.notes.push_back(fmt::format(
        "rows of the right image lie {:+.1f} px lower than those of the left one ({:+.1f} and {:+.1f} px at the "
        "sides): made up for; calibrate again, or --self-rectify off",
        run.correction->offset_px, run.correction->at(0.0), run.correction->at(2.0 * run.correction->middle_u_px)));
    for (auto& images : sample) run.correct(images);
    run.diagnosis = diagnose_now();
  }
  if (corrections.find_mount && run.diagnosis.can_be_trusted()) {
    run.mount = mount_of(sample, calibration.camera);
    calibration.camera.mount = run.mount.mount;
    if (run.mount.is_replaced) run.diagnosis = diagnose_now();
    if (const auto note = flies::mount_note(run.mount)) run.notes.push_back(*note);
    run.diagnosis.road_found = run.diagnosis.road_found || run.mount.is_confirmed || run.mount.is_replaced;
  }
  if (run.mount.is_upside_down) run.diagnosis.nearer_above.reset();  // told by the note on the mount
  for (auto& complaint : flies::complaints(run.diagnosis)) run.notes.push_back(std::move(complaint));
  return run;
}
