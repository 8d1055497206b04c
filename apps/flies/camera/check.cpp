#include "camera/check.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/diagnose/pair_diagnosis.hpp"
#include "flies/diagnose/pair_watch.hpp"
#include "flies/draw/row_picture.hpp"
#include "flies/ego/ego_motion.hpp"
#include "flies/ego/shift_watch.hpp"
#include "flies/io/calibration.hpp"
#include "flies/io/images.hpp"
#include "flies/io/output_file.hpp"
#include "flies/io/pair_source.hpp"
#include "flies/pipeline/detector.hpp"
#include "shared/camera_arguments.hpp"
#include "shared/commands.hpp"
#include "shared/method_arguments.hpp"
#include "shared/named_output.hpp"
#include "shared/notes.hpp"
#include "shared/output_claims.hpp"
#include "shared/run_diagnosis.hpp"
#include "shared/standard_output.hpp"

namespace {

constexpr std::size_t kMostPairs = 200;  // of a long run, spread evenly
constexpr std::size_t kMostSteps = 40;   // from a pair to the next

/// By which corners move from pair to pair, where pairs follow each other.
struct SeenShift {
  std::optional<flies::DisparityShift> shift;
  std::size_t pairs = 0;  ///< that tell it
};

struct Checked {
  CalibratedRun run;
  SeenShift shift;
  std::vector<std::string> to_check;  ///< sentences, each on something that may be wrong
  std::vector<std::string> notes;     ///< on how the calibration was taken

  const flies::PairDiagnosis& diagnosis() const { return run.diagnosis.diagnosis; }
  const flies::MountFinding& mount() const { return run.diagnosis.mount; }
};

/// What is wrong with single pairs, looked at one by one.
struct NotesOnPairs {
  std::vector<std::string> faults;  ///< grave: pairs that are none, cannot be used, repeat or show nothing
  std::vector<std::string> near;    ///< pairs that show things nearer than is looked at
};

/// Looks at a run of two pairs or more.
void watch_pairs(const CalibratedRun& run, const flies::NearEnd& near_end, NotesOnPairs& notes) {
  const std::size_t count = std::min(kMostPairs, run.paths.size());
  flies::PairWatch watch;
  std::vector<std::string> faults;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = k * (run.paths.size() - 1) / (count - 1);
    try {
      watch.look(run.usable(i).view(), run.calibration.camera, run.paths[i].left, near_end);
    } catch (const flies::InputError& fault) {
      faults.emplace_back(fault.what());
    }
  }
  for (auto& counted : watch.counts()) notes.faults.push_back(std::move(counted));
  if (watch.has_near_things()) {  // counted last
    notes.near.push_back(std::move(notes.faults.back()));
    notes.faults.pop_back();
  }
  if (!faults.empty())
    notes.faults.push_back(
        fmt::format("{} of {} pairs cannot be used; the first error: {}", faults.size(), count, faults.front()));
}

NotesOnPairs notes_on_each(const CalibratedRun& run) {
  const auto& camera = run.calibration.camera;
  const flies::NearEnd near_end{nearest_range_m(flies::fitted_options(camera, {}))};
  NotesOnPairs notes;
  if (run.refusal) notes.faults.emplace_back(run.refusal->what());
  if (run.paths.size() > 1) {
    watch_pairs(run, near_end, notes);
  } else if (!run.refusal) {
    const flies::GrayPair images = run.usable(run.sample.front());
    if (auto near = flies::note_on_near_things(images.view(), camera, near_end)) notes.near.push_back(*std::move(near));
  }
  return notes;
}

/// Of steps from one pair to the next, spread evenly over the run.
SeenShift seen_shift(const CalibratedRun& run) {
  if (run.paths.size() < 2) return {};
  flies::DisparityShiftWatch watch;
  const std::size_t steps = std::min(kMostSteps, run.paths.size() - 1);
  for (std::size_t k = 0; k < steps; ++k) {
    const std::size_t i = k * (run.paths.size() - 1) / steps;
    try {
      flies::EgoEstimator estimator(run.calibration.camera);
      estimator.follow(run.usable(i).view(), 0.0);
      watch.look(estimator.follow(run.usable(i + 1).view(), 1.0));
    } catch (const flies::InputError&) {  // told by `notes_on_each`
    }
  }
  return {watch.shift(), watch.pairs()};
}

void check_picture(const CheckArguments& arguments, const std::vector<flies::PairPaths>& pairs) {
  OutputClaims claims;
  claims.reads(pairs);
  claims.reads_calibration(arguments.calib, arguments.camera.right_calib);
  require_named_output(arguments.picture, "--picture", ".png");
  claims.writes(arguments.picture, "--picture");
}

std::vector<std::string> notes_on_shift(const Checked& checked) {
  if (!checked.shift.shift) return {};
  const auto note = flies::note_on_shift(*checked.shift.shift, checked.shift.pairs, checked.run.calibration.camera);
  return note.empty() ? std::vector<std::string>{} : std::vector{note};
}

Checked check(const CheckArguments& arguments) {
  const flies::PairReading reading = reading_of(arguments.images.reading);
  const auto matched = matched_pairs_of(arguments.images);
  check_picture(arguments, matched.pairs);
  const LoadPair load = [paths = matched.pairs, reading](std::size_t i) { return flies::load_pair(paths[i], reading); };
  const Calibrate calibrate = [&](const flies::PairPaths& pair, const flies::RectifiedPair& images) {
    return calibration_of_files(arguments.calib, arguments.camera, pair, images);
  };
  Checked checked;
  checked.run = calibrate_run(matched.pairs, load, calibrate, arguments.calib, {.self_rectify = SelfRectify::off});
  const auto on_calibration = [&](flies::CalibrationNoteKind kind) {
    return named(arguments.calib, texts(checked.run.calibration.notes, {kind}));
  };
  const auto add = [](std::vector<std::string>& notes, const std::vector<std::string>& more) {
    notes.insert(notes.end(), more.begin(), more.end());
  };
  add(checked.to_check, on_calibration(flies::CalibrationNoteKind::doubt));
  add(checked.to_check, matched.notes);
  const NotesOnPairs on_pairs = notes_on_each(checked.run);
  add(checked.to_check, on_pairs.faults);  // which explain the rest
  checked.shift = seen_shift(checked.run);
  add(checked.to_check, notes_on_shift(checked));
  add(checked.to_check, checked.run.diagnosis.notes);
  add(checked.to_check, on_pairs.near);
  add(checked.notes, on_calibration(flies::CalibrationNoteKind::mount));
  add(checked.notes, on_calibration(flies::CalibrationNoteKind::told));
  if (!arguments.picture.empty()) {
    const flies::GrayPair images = checked.run.usable(checked.run.sample.front());
    flies::write_png(arguments.picture,
                     flies::draw_rows(images.view(), flies::match_corners(images.view()), checked.diagnosis().rows));
  }
  return checked;
}

/// What says that the calibration is not that of the cameras: nothing of the scene, of light and lenses, nor of how the
/// camera is mounted.
std::vector<std::string> doubts_on_rig(const Checked& checked, const std::string& calib) {
  auto doubts = named(calib, texts(checked.run.calibration.notes, {flies::CalibrationNoteKind::doubt}));
  flies::PairDiagnosis of_rig = checked.diagnosis();
  of_rig.road_found = true;
  of_rig.sides = {};
  of_rig.noise = {};
  of_rig.left_steps = of_rig.right_steps = {};
  of_rig.nearer_above.reset();
  of_rig.dark_share = of_rig.bright_share = 0.0;
  for (auto& complaint : flies::complaints(of_rig)) doubts.push_back(std::move(complaint));
  for (auto& note : notes_on_shift(checked)) doubts.push_back(std::move(note));
  return doubts;
}

std::string table(const Checked& checked) {
  const auto& d = checked.diagnosis();
  std::string text;
  const auto line = [&](const char* name, const std::string& value) { text += fmt::format("{:<24}{}\n", name, value); };
  line("pairs", fmt::format("{}, of which up to 5 are examined closely", checked.run.paths.size()));
  line("something to match", fmt::format("in {:.0f} % of the left image", 100.0 * d.textured_share));
  line("found on their row", fmt::format("{:.0f} % of {} places (32 % and more in good pairs of streets)",
                                         100.0 * d.matched_share(), d.evidence.patches));
  line("beyond infinity",
       fmt::format("{:.0f} % of those found (none, if the calibration is right)", 100.0 * d.beyond_share()));
  line("noise",
       fmt::format("{:.1f} grey levels, while the scene varies by {:.1f}", d.noise.noise_gray, d.noise.contrast_gray));
  line("rows", d.rows
                   ? fmt::format("{:+.2f} px lower in the right image, {:+.2f} and {:+.2f} px at the sides; {} corners "
                                 "agree, scatter {:.2f} px",
                                 d.rows->offset_px, d.rows->at(0.0), d.rows->at(2.0 * d.rows->middle_u_px),
                                 d.rows->corners, d.rows->scatter_px)
                   : "too few corners to tell");
  if (d.rows && d.rows->growth != 0.0)
    line("size", fmt::format("the right image {:+.1f} % larger than the left one", 100.0 * d.rows->growth));
  if (const auto& [shift, pairs] = checked.shift; shift)
    line("disparities",
         fmt::format("{:.1f} px too {}, judged by how corners move ({} pairs, which differ by {:.1f} px)",
                     std::abs(shift->px), shift->px < 0.0 ? "large" : "small", pairs, shift->deviation_px));
  line("road", d.road_found ? "found" : "not found");
  const auto& mount = checked.mount().mount;
  line("camera", fmt::format("{:.2f} m above the road, {}: {}", mount.height_m, flies::tilt_words(mount),
                             checked.mount().is_replaced ? "found, not as given" : "as given"));
  if (checked.to_check.empty()) return text + "looks right\n";
  text += "to check:\n";
  for (const auto& note : checked.to_check) text += "  - " + note + "\n";
  return text;
}

std::string json(const Checked& checked) {
  const auto& d = checked.diagnosis();
  nlohmann::ordered_json object = {{"textured_share", d.textured_share},
                                   {"dark_share", d.dark_share},
                                   {"bright_share", d.bright_share},
                                   {"patches", d.evidence.patches},
                                   {"matched_share", d.matched_share()},
                                   {"beyond_share", d.beyond_share()},
                                   {"left_blind_share", d.sides.left_blind_share},
                                   {"right_blind_share", d.sides.right_blind_share},
                                   {"sharpness_ratio", d.sides.sharpness},
                                   {"contrast_ratio", d.sides.contrast},
                                   {"noise_gray", d.noise.noise_gray},
                                   {"contrast_gray", d.noise.contrast_gray},
                                   {"row_offset_px", nullptr},
                                   {"row_roll_rad", nullptr},
                                   {"row_growth", nullptr},
                                   {"row_scatter_px", nullptr},
                                   {"nearer_above", nullptr},
                                   {"disparity_shift_px", nullptr},
                                   {"road_found", d.road_found},
                                   {"camera_height_m", checked.mount().mount.height_m},
                                   {"camera_pitch_rad", checked.mount().mount.pitch_rad},
                                   {"camera_roll_rad", checked.mount().mount.roll_rad},
                                   {"mount_source", checked.mount().is_replaced ? "road" : "given"},
                                   {"looks_right", checked.to_check.empty()},
                                   {"notes", checked.to_check}};
  if (d.nearer_above) object["nearer_above"] = *d.nearer_above;
  if (checked.shift.shift) object["disparity_shift_px"] = checked.shift.shift->px;
  if (d.rows) {
    object["row_offset_px"] = d.rows->offset_px;
    object["row_roll_rad"] = d.rows->slope;
    object["row_growth"] = d.rows->growth;
    object["row_scatter_px"] = d.rows->scatter_px;
  }
  return object.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace

void run_check(const CheckArguments& arguments) {
  const Checked checked = check(arguments);
  print(arguments.json ? json(checked) : table(checked));
  say_notes(checked.notes);
}

std::string fit_of_rig(const CheckArguments& arguments) {
  const Checked checked = check(arguments);
  const auto& rows = checked.diagnosis().rows;
  if (!rows) return "cannot be checked: too few corners are seen in both images";
  constexpr double kMost_px = 0.5;  // farther apart, recall suffers
  const double worst_px =
      std::max({std::abs(rows->offset_px), std::abs(rows->at(0.0)), std::abs(rows->at(2.0 * rows->middle_u_px))});
  if (worst_px > kMost_px)
    return fmt::format("does not fit the rig any more: rows lie up to {:.2f} px apart ({} corners); calibrate again",
                       worst_px, rows->corners);
  const auto apart = fmt::format("rows lie {:.2f} px apart at most ({} corners)", worst_px, rows->corners);
  const auto doubts = doubts_on_rig(checked, arguments.calib);
  if (doubts.empty()) return "fits the rig: " + apart;
  return fmt::format("may not fit the rig: {}, but check\n  - {}", apart, fmt::join(doubts, "\n  - "));
}

void setup_check(CLI::App& app) {
  CLI::App* command = app.add_subcommand("check", "do these images and this calibration belong together?");
  const auto arguments = std::make_shared<CheckArguments>();
  add_pair_options(*command, arguments->images);
  command->add_option("--calib", arguments->calib, "calibration of the pair; see `flies calib --help`")
      ->type_name("FILE")
      ->required();
  add_cameras_option(
      *command, arguments->camera,
      "left and right camera of a KITTI calibration, e.g. 0,1; default: those in the image paths, or else 2,3");
  add_calibration_options(*command, arguments->camera);
  add_mount_options(*command, arguments->camera);
  command->add_flag("--json", arguments->json, "the same as JSON")->group("Output");
  command
      ->add_option("--picture", arguments->picture,
                   "both images side by side with rows, and corners coloured by how far their rows lie apart")
      ->type_name("PNG")
      ->group("Output");
  command->footer(
      "\nMeasures how much of the images can be matched at all, how much of the left one is found on the same\n"
      "row of the right one, whether anything would lie beyond infinity (negative disparity), how far the rows\n"
      "of left and right lie apart, and whether the road is where the mount of the camera says, or else where\n"
      "it is. If the pairs are a sequence from a moving camera, it also finds whether all disparities are too\n"
      "small or too large, as from cameras that are turned against each other. For everything that is wrong\n"
      "it says what to do.\n"
      "\nExamples:\n"
      "  flies check left.png right.png --calib calib.yaml --picture rows.png\n"
      "  flies check image_00/data image_01/data --calib calib_cam_to_cam.txt --json\n"
      "\nExit status: 0 done, also when there is something to check; 2 an error in the input, reported in one line.");
  command->callback([arguments] { run_check(*arguments); });
}
