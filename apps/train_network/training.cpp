#include "training.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "flies/classify/model_file.hpp"
#include "flies/classify/named_models.hpp"
#include "flies/core/error.hpp"
#include "flies/io/output_file.hpp"
#include "flies/version.hpp"
#include "network_checkpoint.hpp"
#include "network_report.hpp"
#include "shared/notes.hpp"
#include "shared/progress_bar.hpp"
#include "shared/standard_output.hpp"

namespace flies {
namespace {

constexpr std::size_t kSample = 3'000;

/// What is being done, on standard error. A bar that stands there is overwritten and comes back.
void say(const std::string& text) {
  if (verbosity() == Verbosity::quiet) return;
  fmt::print(stderr, "{}flies: {}\n", isatty(STDERR_FILENO) != 0 ? "\r\033[K" : "", text);
}

/// Results go where the model does not.
void tell(const NetworkArguments& arguments, const std::string& text) {
  if (arguments.out == "-")
    std::fputs(text.c_str(), stderr);
  else
    print(text);
}

void learn(Learning& learning, const NetworkArguments& arguments, const NetworkCheckpoint& checkpoint) {
  checkpoint.restore(learning);
  const std::size_t all = static_cast<std::size_t>(arguments.learning.epochs), before = learning.epochs().size();
  if (before > 0) say(fmt::format("goes on after epoch {} of {}, from {}", before, all, arguments.work));
  ProgressBar bar((all - before) * static_cast<std::size_t>(arguments.learning.steps), "batches");
  std::size_t batches = 0;
  while (!learning.is_done()) {
    learning.learn_epoch([&] { bar.show(++batches); });
    checkpoint.save(learning);
    const EpochSummary& last = learning.epochs().back();
    say(fmt::format("epoch {} of {}: loss {:.4f}, {} hard windows", learning.epochs().size(), all, last.loss,
                    last.hard));
  }
}

/// Windows whose activations tell how large they become.
std::vector<Place> sample_of(const std::vector<Picture>& pictures, std::uint64_t seed) {
  std::vector<Place> sample = places_of_people(pictures);
  const BackgroundPlaces background(pictures);
  Random random(seed);
  for (std::size_t i = 0; i < kSample; ++i) sample.push_back(background.draw(random));
  return sample;
}

std::vector<std::pair<std::string, std::string>> about(const NetworkData& data, const NetworkArguments& arguments) {
  return {
      {"data",
       fmt::format("{} pictures with {} people: pedestrian crops, street pictures with labelled people and without, "
                   "proposed boxes of {} folders of pairs",
                   data.learnt.size(), places_of_people(data.learnt).size(), arguments.folders.stereo.size())},
      {"kept apart", fmt::format("{} pictures of other scenes", data.kept_apart.size())},
      {"licence", "weights learnt from research data that may be used for research; no pictures are included"}};
}

PeopleModel model_with_network(const std::string& name) {
  PeopleModel model = people_model(name);
  if (!model.convolution) throw InputError(name, "convolution", "missing, expected a model with a network");
  return model;
}

void take_calibration(PeopleModel& model, const std::string& of) {
  const PeopleModel other = model_with_network(of);
  model.convolution->calibration = other.convolution->calibration;
  model.convolution->linear_weight = other.convolution->linear_weight;
  model.threshold = other.threshold;
}

void take_first_look(PeopleModel& model, const NetworkArguments& arguments) {
  const PeopleModel first = people_model(arguments.first);
  model.hog = first.hog;
  model.linear = first.linear;
  model.first_network = first.first_network;
  if (arguments.is_first_look)
    model.threshold = first.threshold;
  else
    model.linear.reject_below = arguments.judging.reject_below;
  const bool is_named = !arguments.name.empty();
  model.name = is_named ? arguments.name : std::filesystem::path(arguments.out).stem().string();
  check_model_text(model.name, "command line", is_named ? "--name" : "--out");
}

/// The share of people missed by the shipped models and by this one; this one's probabilities are those of the file.
TrainingResult judge(const PeopleModel& model, const NetworkData& data, const JudgedPlaces& judged,
                     const NetworkArguments& arguments) {
  std::string text = fmt::format("missed of {} windows with people kept apart, at the share of {} without that pass\n",
                                 judged.people.size(), judged.background.size());
  for (const char* name : {"flies-48x96-linear", "flies-48x96"}) {
    const PeopleModel other = people_model(name);
    text += missed_line(name, probabilities(other, data.kept_apart, judged.people),
                        probabilities(other, data.kept_apart, judged.background));
  }
  const auto people = probabilities(model, data.kept_apart, judged.people);
  const auto background = probabilities(model, data.kept_apart, judged.background);
  text += missed_line(model.name, people, background);
  TrainingResult result = validated(model, judged, people, background);
  tell(arguments, text + network_summary(result, arguments.judging));
  return result;
}

/// A network that is there already behind another first look.
void put_together(const NetworkArguments& arguments, OutputFile& out) {
  PeopleModel model = model_with_network(arguments.network_of);
  take_first_look(model, arguments);
  take_calibration(model, arguments.calibration_of);
  out.write(people_model_text(model));
  out.commit();
}

}  // namespace

void train_network(const NetworkArguments& arguments) {
  // Opened first, so that a place that cannot be written shows before the work.
  OutputFile out(arguments.out);
  std::optional<OutputFile> report;
  if (!arguments.report.empty()) report.emplace(arguments.report);
  if (arguments.folders.people.empty()) return put_together(arguments, out);

  PeopleModel model;
  const bool learns = arguments.network_of.empty();
  if (!learns) model = model_with_network(arguments.network_of);
  take_first_look(model, arguments);
  say("reads the pictures");
  const NetworkData data = load_network_data(arguments.folders);
  say(fmt::format("{} pictures with {} people to learn from, {} kept apart", data.learnt.size(),
                  places_of_people(data.learnt).size(), data.kept_apart.size()));
  std::optional<NetworkCheckpoint> checkpoint;
  std::optional<Learning> learning;
  if (learns) {
    learning.emplace(data.learnt, arguments.is_first_look ? NetworkStage::first : NetworkStage::last,
                     arguments.learning);
    checkpoint.emplace(arguments.work,
                       fingerprint_of_learning(data.learnt, arguments.learning, learning->network().shape()));
    learn(*learning, arguments, *checkpoint);
    const auto sample = sample_of(data.learnt, arguments.learning.seed);
    if (arguments.is_first_look) {
      model.first_network = learning->network().first_stage(data.learnt, sample);
      model.first_network->reject_below = arguments.judging.reject_below;
    } else {
      model.convolution = learning->network().last_stage(data.learnt, sample);
    }
    model.about = about(data, arguments);
  }
  std::optional<JudgedPlaces> judged;
  if (arguments.folders.keep_apart) judged = judged_places(data.kept_apart, arguments.learning.seed, arguments.judging);
  say("calibrates and judges");
  if (!arguments.calibration_of.empty())
    take_calibration(model, arguments.calibration_of);
  else if (!arguments.is_first_look)  // nothing is calibrated by a network that only rejects
    calibrate(model, data.kept_apart, *judged, arguments.judging.background_share);

  const std::string text = people_model_text(model);
  out.write(text);
  if (judged) {
    const TrainingResult result = judge(parse_people_model(text, arguments.out), data, *judged, arguments);
    if (report)
      report->write(network_report_html(result, data.kept_apart,
                                        learning ? learning->epochs() : std::vector<EpochSummary>(), arguments.learning,
                                        arguments.judging,
                                        {arguments.command, "flies " FLIES_VERSION ", " FLIES_BUILD_TYPE
                                                            ", " FLIES_COMPILER ", libtorch " TORCH_VERSION}));
  }
  out.commit();
  if (report) report->commit();
  if (checkpoint) checkpoint->remove();
  tell(arguments, "model          " + arguments.out + "\n");
}

}  // namespace flies
