#include "shared/run_diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/diagnose/calibrated_pair.hpp"
#include "flies/io/images.hpp"
#include "shared/camera_arguments.hpp"

namespace {

constexpr std::size_t kPairs = 5;

bool is_to_be_corrected(const flies::PairDiagnosis& diagnosis, SelfRectify mode) {
  const auto& rows = diagnosis.rows;
  if (!rows || mode == SelfRectify::off) return false;
  if (mode == SelfRectify::on) return true;
  return diagnosis.rows_agree() && rows->typical_px() >= flies::kRowErrorMatters_px && flies::can_be_made_up_for(*rows);
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

struct SampledPair {
  std::size_t index = 0;
  flies::GrayPair images;  ///< as they were read
};

/// Of up to five pairs, spread evenly, those that can be read; if none can, the first of all that can, if any.
/// @param fault gets that of the first pair that cannot
std::vector<SampledPair> read_sample(std::size_t pairs, const LoadPair& load, std::optional<flies::InputError>& fault) {
  std::vector<SampledPair> sample;
  const auto read = [&](std::size_t index) {
    try {
      sample.push_back({index, load(index)});
    } catch (const flies::InputError& error) {  // told when its turn comes
      if (!fault) fault = error;
    }
  };
  const std::size_t count = std::min(kPairs, pairs);
  for (std::size_t k = 0; k < count; ++k) read(count == 1 ? 0 : k * (pairs - 1) / (count - 1));
  for (std::size_t i = 0; sample.empty() && i < pairs; ++i) read(i);
  return sample;
}

/// What is to be said of files, whatever is done with them: of the first pair that has something.
std::vector<std::string> notes_on_files(const std::vector<SampledPair>& sample) {
  std::vector<std::string> notes;
  for (const auto& [index, images] : sample)
    if (notes.empty()) notes = images.notes;
  for (const auto& [index, images] : sample)
    if (auto found = flies::notes_on_images(images.view()); !found.empty()) {
      std::ranges::move(found, std::back_inserter(notes));
      break;
    }
  return notes;
}

flies::GrayPair rectified(const flies::Calibration& calibration, flies::GrayPair images) {
  return calibration.rectifier ? calibration.rectifier->rectify(images) : std::move(images);
}

void check_size(const flies::StereoCamera& camera, const flies::GrayPair& images, const std::string& source) {
  flies::check_camera_fits(camera, images.left.width_px, images.left.height_px, source);
}

RunDiagnosis diagnose_read(std::vector<SampledPair> sample, flies::Calibration& calibration,
                           const RunCorrections& corrections) {
  auto notes = notes_on_files(sample);
  std::vector<flies::GrayPair> usable;
  for (auto& [index, images] : sample) {
    try {
      flies::GrayPair pair = rectified(calibration, std::move(images));
      check_size(calibration.camera, pair, "pair");
      usable.push_back(std::move(pair));
    } catch (const flies::InputError&) {  // told when its turn comes
    }
  }
  auto run = diagnose_sample(std::move(usable), calibration, corrections);
  run.notes.insert(run.notes.begin(), notes.begin(), notes.end());
  run.notes_on_files = notes.size();
  return run;
}

/// Leaves those of the size that most have; of sizes that are as frequent, of that which comes first.
void keep_commonest_size(std::vector<SampledPair>& sample) {
  const auto size_of = [](const SampledPair& pair) {
    return std::pair(pair.images.left.width_px, pair.images.left.height_px);
  };
  std::map<std::pair<int, int>, int> counts;
  for (const auto& pair : sample) ++counts[size_of(pair)];
  const auto commonest =
      size_of(*std::ranges::max_element(sample, {}, [&](const SampledPair& pair) { return counts[size_of(pair)]; }));
  std::erase_if(sample, [&](const SampledPair& pair) { return size_of(pair) != commonest; });
}

flies::RoadOptions road_options(const flies::StereoCamera& camera, const RunCorrections& corrections) {
  return (corrections.options ? corrections.options(camera) : flies::fitted_options(camera, {})).road;
}

flies::MountFinding mount_of(const std::vector<flies::GrayPair>& sample, const flies::StereoCamera& camera) {
  std::vector<flies::RectifiedPair> views;
  for (const auto& images : sample) views.push_back(images.view());
  return flies::find_mount(views, camera);
}

std::string correction_note(const flies::RowError& rows) {
  return fmt::format(
      "rows of the right image lie {:+.1f} px lower than those of the left one ({:+.1f} and {:+.1f} px at the sides): "
      "this is corrected; calibrate again, or switch it off with --self-rectify off",
      rows.offset_px, rows.at(0.0), rows.at(2.0 * rows.middle_u_px));
}

/// Those of the diagnosis, the gravest first: what is seen badly, how images and calibration go together, where the
/// ground lies.
void add_notes(RunDiagnosis& run) {
  const auto add = [&](std::vector<std::string> more) {
    run.notes.insert(run.notes.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  };
  add(flies::complaints_on_sight(run.diagnosis));
  if (run.correction) add({correction_note(*run.correction)});
  add(flies::complaints_on_fit(run.diagnosis));
  if (auto note = flies::mount_note(run.mount)) add({*std::move(note)});
  add(flies::complaints_on_ground(run.diagnosis));
}

/// Finds out whether any of the sample is a true pair.
void look_for_a_true_pair(CalibratedRun& run) {
  bool is_rectified_wrongly = false;
  for (const std::size_t i : run.sample) {
    try {
      run.require_true_pair(i, run.usable(i));
      run.refusal.reset();
      return;
    } catch (const flies::WronglyRectified& error) {
      if (!run.refusal) is_rectified_wrongly = true;
      if (!run.refusal) run.refusal.emplace(error);
    } catch (const flies::InputError& error) {
      if (!run.refusal) run.refusal.emplace(error);
    }
  }
  if (is_rectified_wrongly) run.diagnosis.notes.resize(run.diagnosis.notes_on_files);  // the others follow from that
}

/// Whether the ground is where the mount says: asked of a mount that is to be used as given only where no road was
/// found, so that it is not doubted because the run looks for the road elsewhere.
bool is_mount_confirmed(const RunDiagnosis& run, const std::vector<flies::GrayPair>& sample,
                        const flies::Calibration& calibration) {
  if (run.road_is_found || !run.diagnosis.can_be_trusted()) return false;
  return mount_of(sample, calibration.camera).is_confirmed;
}

}  // namespace

void add_mount_option(CLI::App& command, bool& find_mount) {
  add_named_option<bool>(command, "--mount", find_mount, {{"auto", true}, {"given", false}}, "auto or given",
                         "auto: height and tilt of the camera are measured from the road, and used where they clearly "
                         "differ from those given or assumed; given: those are always used");
}

void add_correction_options(CLI::App& command, RunCorrections& corrections) {
  add_mount_option(command, corrections.find_mount);
  add_named_option<SelfRectify>(
      command, "--self-rectify", corrections.self_rectify,
      {{"auto", SelfRectify::automatic}, {"on", SelfRectify::on}, {"off", SelfRectify::off}}, "auto, on or off",
      fmt::format("correct a vertical offset between the rows of left and right: auto (from {:g} px on), on or off",
                  flies::kRowErrorMatters_px));
}

std::optional<flies::DiagnosisRecord> RunDiagnosis::record() const {
  if (!is_known) return std::nullopt;
  flies::DiagnosisRecord record;
  record.textured_share = diagnosis.textured_share;
  record.matched_share = diagnosis.matched_share();
  record.beyond_share = diagnosis.beyond_share();
  record.road_found = road_is_found;
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

RunDiagnosis diagnose(std::size_t pairs, const LoadPair& load, flies::Calibration& calibration,
                      const RunCorrections& corrections) {
  std::optional<flies::InputError> fault;
  return diagnose_read(read_sample(pairs, load, fault), calibration, corrections);
}

RunDiagnosis diagnose_sample(std::vector<flies::GrayPair> sample, flies::Calibration& calibration,
                             const RunCorrections& corrections) {
  RunDiagnosis run;
  run.mount.told = run.mount.mount = calibration.camera.mount;
  if (sample.empty()) return run;
  run.is_known = true;
  const auto diagnose_now = [&] {
    std::vector<flies::PairDiagnosis> each;
    const auto road = road_options(calibration.camera, corrections);
    for (const auto& images : sample) each.push_back(flies::diagnose_pair(images.view(), calibration.camera, road));
    return flies::diagnose_run(each);
  };
  run.diagnosis = diagnose_now();
  if (is_to_be_corrected(run.diagnosis, corrections.self_rectify)) {
    run.correction = run.diagnosis.rows;
    for (auto& images : sample) run.correct(images);
    run.diagnosis = diagnose_now();
  }
  if (corrections.find_mount && run.diagnosis.can_be_trusted()) {
    run.mount = mount_of(sample, calibration.camera);
    calibration.camera.mount = run.mount.mount;
    if (run.mount.is_replaced) run.diagnosis = diagnose_now();
  }
  run.road_is_found = run.diagnosis.road_found;
  run.diagnosis.road_found = run.road_is_found || run.mount.is_replaced || run.mount.is_confirmed ||
                             (!corrections.find_mount && is_mount_confirmed(run, sample, calibration));
  if (run.mount.is_upside_down) run.diagnosis.nearer_above.reset();  // told by the note on the mount
  add_notes(run);
  return run;
}

flies::GrayPair CalibratedRun::usable(std::size_t pair) const {
  flies::GrayPair images = rectified(calibration, load(pair));
  check_size(calibration.camera, images, paths[pair].left);
  diagnosis.correct(images);
  return images;
}

void CalibratedRun::require_true_pair(std::size_t pair, const flies::GrayPair& images) const {
  flies::check_calibrated_pair(
      images.view(), calibration, [&] { return load(pair); }, paths[pair].left, paths[pair].right);
}

std::vector<std::string> CalibratedRun::notes(const std::string& calib) const {
  auto all = named(calib, texts(calibration.notes));
  for (auto& note : named(first().left, diagnosis.notes)) all.push_back(std::move(note));
  return all;
}

CalibratedRun calibrate_run(std::vector<flies::PairPaths> paths, LoadPair load, const Calibrate& calibrate,
                            const std::string& calib, const RunCorrections& corrections) {
  std::optional<flies::InputError> fault;
  auto sample = read_sample(paths.size(), load, fault);
  if (sample.empty()) throw flies::InputError(*fault);
  keep_commonest_size(sample);
  CalibratedRun run{.paths = std::move(paths),
                    .load = std::move(load),
                    .sample = {},
                    .calibration = {},
                    .diagnosis = {},
                    .refusal = {}};
  for (const auto& pair : sample) run.sample.push_back(pair.index);
  run.calibration = calibrate(run.first(), sample.front().images.view());
  const auto images = rectified(run.calibration, sample.front().images);
  check_size(run.calibration.camera, images, calib);
  run.calibration.camera.width_px = images.left.width_px;
  run.calibration.camera.height_px = images.left.height_px;
  run.diagnosis = diagnose_read(std::move(sample), run.calibration, corrections);
  look_for_a_true_pair(run);
  return run;
}
