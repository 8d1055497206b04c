#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "flies/io/images.hpp"
#include "flies/io/options_yaml.hpp"
#include "flies/io/writers.hpp"
#include "flies/pipeline/detector.hpp"
#include "flies/pipeline/tracker.hpp"
#include "shared/camera_arguments.hpp"
#include "shared/listed_options.hpp"
#include "shared/run_diagnosis.hpp"

/// The options of the method as given on a command line, unchecked.
struct MethodArguments {
  std::string preset = "default";
  std::string options_file;
  std::optional<std::vector<flies::OptionSetting>> file_settings = {};  ///< what it says; none: it is yet to be read
  std::string model;    ///< of people, a name or a file; empty: not given
  Overrides overrides;  ///< dotted name and text, in no particular order
  int threads = 1;      ///< worker threads where neither the file nor the command line says how many
};

/// Adds --preset, --options, --model, --seed, --threads and, hidden from the help because there are so many, every
/// other option of the method by its dotted name. `arguments` must outlive the parsing.
void add_method_options(CLI::App& app, MethodArguments& arguments);

/// Reads the options file once and for all, for runs that ask for their options again later.
/// @throws flies::InputError when it cannot be read
void read_options_file(MethodArguments& arguments);

/// Preset, then the YAML file, then the command line; the later one wins.
/// @throws flies::InputError on an unknown preset, an unreadable file, an unknown option or a value out of range
flies::DetectorOptions effective_options(const MethodArguments& arguments);

/// The same for a camera: what the user has not set follows from it (`flies::fitted_options`); not for `paper`.
flies::DetectorOptions effective_options(const MethodArguments& arguments, const flies::StereoCamera& camera);

/// From where on things are looked for, metres: by the flies or by the scan.
double nearest_range_m(const flies::DetectorOptions& options);

/// Corrections as told, which look for the road by the options of the run.
RunCorrections corrections_for(RunCorrections corrections, const MethodArguments& arguments);

/// Options of following: the YAML file, then the command line.
/// @param overrides what the command line says of them
/// @throws flies::InputError as `effective_options`
flies::TrackerOptions following_options(const MethodArguments& arguments, const Overrides& overrides);

/// Name or file of the people model: what --model says, else `people_model` in the options file, else that of the
/// preset.
/// @throws flies::InputError on an unknown preset or an unreadable file
std::string people_model_of(const MethodArguments& arguments);

/// What classifies people by that model.
/// @throws flies::InputError as `flies::people_classifier`
std::shared_ptr<const flies::PeopleClassifier> classifier_of(const MethodArguments& arguments);

/// A file for --options that means the same whatever the preset beside it.
std::string options_file_text(const flies::DetectorOptions& options, const flies::TrackerOptions& following,
                              const std::string& people_model);

/// The preset whose options these are, whatever seed and threads; "custom" when they are no preset's.
std::string preset_name(const flies::DetectorOptions& options);

/// What the user said of a run beside its files.
struct RunWords {
  const MethodArguments& method;
  const CameraArguments& camera;
  const RunCorrections& corrections;
  flies::PairReading reading = {};
  std::string pair_by = "auto";
};

/// What a run is made of, for its record.
/// @param options     as they are used, fitted to the camera
/// @param following   of runs that do not follow the defaults
/// @param camera      as it is used
/// @param calibration its file
/// @param diagnosis   by which rows are corrected
std::shared_ptr<const flies::RunRecord> run_record(const RunWords& words, const flies::DetectorOptions& options,
                                                   const flies::TrackerOptions& following,
                                                   const flies::StereoCamera& camera, const std::string& calibration,
                                                   const RunDiagnosis& diagnosis);
