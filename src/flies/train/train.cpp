#include "flies/train/train.hpp"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/train/mine.hpp"
#include "flies/train/samples.hpp"
#include "flies/train/support_vectors.hpp"
#include "flies/train/validate.hpp"

namespace flies {
namespace {

/// Background that scores this much less than what counts as hard is forgotten: it does not touch the margin, and would
/// only fill the memory. Half a margin, because the next machine differs a little.
constexpr double kForgetMargin = 0.5;
/// Rounds are numbered from 1; windows of round 0 are the first, random ones.
constexpr std::uint32_t kFirstWindows = 0;
constexpr std::uint32_t kFirstKernelRound = 100;
constexpr std::uint32_t kWindowsKeptApart = 1000;

struct Parts {
  HoldOut people, background;
};

/// Pairs with proposals are all learnt from: those of one drive show one street, so that what is kept apart of them
/// says little, and the threshold is one for random windows.
Parts split(const TrainingData& data, const TrainOptions& options) {
  std::vector<std::uint32_t> proposed, pictures;
  for (std::uint32_t i = 0; i < data.background.size(); ++i)
    (data.background[i].has_proposals ? proposed : pictures).push_back(i);
  const auto check = [](std::size_t found, const char* what) {
    if (found < kMinPictures)
      throw InputError("command line", what,
                       fmt::format("found {} pictures, expected at least {}", found, kMinPictures));
  };
  check(data.people.size(), "--positives");
  check(pictures.size(), "--negatives");
  Parts parts{split_in_runs(data.people.size(), options.validation_share),
              split_in_runs(pictures.size(), options.validation_share)};
  for (auto* part : {&parts.background.learnt, &parts.background.kept_apart})
    for (auto& index : *part) index = pictures[index];
  std::ranges::copy(proposed, std::back_inserter(parts.background.learnt));
  return parts;
}

/// The first machine's background: as many windows of every picture.
std::vector<TrainingWindow> random_windows(const TrainingData& data, std::span<const std::uint32_t> chosen,
                                           const TrainOptions& options) {
  std::vector<TrainingWindow> windows;
  const int pictures = static_cast<int>(chosen.size());
  for (int i = 0; i < pictures; ++i) {
    const std::uint32_t index = chosen[static_cast<std::size_t>(i)];
    const GrayImage image = load_picture(data.background[index]);
    const int count = options.negatives.first / pictures + (i < options.negatives.first % pictures ? 1 : 0);
    std::ranges::copy(windows_without_people(data.background[index], image.width_px, image.height_px, index,
                                             kFirstWindows, count, options),
                      std::back_inserter(windows));
  }
  if (windows.empty())
    throw InputError(
        "command line", "--negatives",
        fmt::format("found no window without people that is {} px high or higher", options.negatives.min_height_px));
  return windows;
}

HogGeometry geometry_of(const TrainOptions& options) {
  HogGeometry hog;
  hog.window_height_px = options.window_height_px;
  hog.window_width_px = options.window_height_px / 2;
  const int blocks_px = 2 * hog.stride_px;
  if (options.window_height_px % blocks_px != 0)
    throw InputError("options", "window_height_px",
                     fmt::format("found {}, expected a multiple of {}", options.window_height_px, blocks_px));
  return hog;
}

/// One training: what it reads, and how it speaks.
class Training {
 public:
  Training(const TrainingData& data, const TrainOptions& options, Checkpoint& checkpoint,
           const TrainingProgress& progress)
      : data_(data), options_(options), checkpoint_(checkpoint), progress_(progress), parts_(split(data, options)) {}

  TrainingResult run();

 private:
  void say(const std::string& chapter, std::size_t done = 0, std::size_t total = 1) const {
    if (progress_) progress_(chapter, done, total);
  }
  LinearStage linear_machine(const Samples& samples, const std::string& chapter) const {
    say("linear machine, " + chapter);
    return train_linear(samples.features, samples.is_person, options_.linear, options_.seed);
  }
  std::vector<TrainingWindow> hard_windows(std::span<const std::uint32_t> pictures, const WindowScorer& score,
                                           std::uint32_t round, const std::string& chapter) const;
  std::vector<TrainingWindow> hard_for_kernel(std::span<const std::uint32_t> pictures, const PeopleModel& model,
                                              int round, const std::string& chapter) const;
  Samples learn_in_rounds(LinearStage& linear, TrainingResult& result);
  Samples learn_kernel_in_rounds(Samples samples, TrainingResult& result) const;
  Samples learn_what_was_kept_apart(const Samples& samples, const Samples& of_kernel, TrainingResult& result) const;
  std::optional<KernelStage> kernel_machine(const Samples& samples, const LinearStage& linear) const;

  const TrainingData& data_;
  const TrainOptions& options_;
  Checkpoint& checkpoint_;
  const TrainingProgress& progress_;
  const Parts parts_;
  const HogGeometry hog_ = geometry_of(options_);
};

WindowScorer scorer_of(const LinearStage& linear) {
  return [&](std::span<const float> features) { return linear_score(linear, features); };
}

std::vector<TrainingWindow> Training::hard_windows(std::span<const std::uint32_t> pictures, const WindowScorer& score,
                                                   std::uint32_t round, const std::string& chapter) const {
  return mine_hard_windows(data_.background, pictures, hog_, score, round, options_,
                           [&](std::size_t done) { say("hard windows, " + chapter, done, pictures.size()); });
}

/// What the linear machine lets through and the kernel machine takes for a person, or nearly.
std::vector<TrainingWindow> Training::hard_for_kernel(std::span<const std::uint32_t> pictures, const PeopleModel& model,
                                                      int round, const std::string& chapter) const {
  const auto score = [&](std::span<const float> features) {
    return linear_score(model.linear, features) < options_.rbf.reject_below ? -std::numeric_limits<double>::infinity()
                                                                            : kernel_score(*model.kernel, features);
  };
  return hard_windows(pictures, score, kFirstKernelRound + static_cast<std::uint32_t>(round), chapter);
}

/// The linear machine on people and random background, then again with what it took for people, and so on.
Samples Training::learn_in_rounds(LinearStage& linear, TrainingResult& result) {
  say("people");
  Samples samples = people_samples(data_.people, parts_.people.learnt, hog_, options_);
  const bool goes_on = checkpoint_.state().rounds_done > 0;
  result.rounds = checkpoint_.state().rounds;
  add_background(samples, data_.background,
                 goes_on ? checkpoint_.state().background : random_windows(data_, parts_.background.learnt, options_),
                 hog_);
  const int rounds = options_.negatives.rounds;
  int round = std::min(checkpoint_.state().rounds_done, rounds);
  linear = linear_machine(samples, fmt::format("round {}", round));
  while (round < rounds) {
    ++round;
    const std::string name = fmt::format("round {}", round);
    keep_background(samples, [&](std::span<const float> features) {
      return linear_score(linear, features) > options_.negatives.hard_above - kForgetMargin;
    });
    const auto hard =
        hard_windows(parts_.background.learnt, scorer_of(linear), static_cast<std::uint32_t>(round), name);
    add_background(samples, data_.background, hard, hog_);
    result.rounds.push_back({name, hard.size(), samples.background.size()});
    checkpoint_.save({round, samples.background, result.rounds});
    linear = linear_machine(samples, name);
  }
  return samples;
}

/// The kernel machine on what the linear one does not clearly reject, then again with what it took for people. The
/// linear machine does not learn from that: it would reject more people.
Samples Training::learn_kernel_in_rounds(Samples samples, TrainingResult& result) const {
  PeopleModel& model = result.model;
  model.kernel = kernel_machine(samples, model.linear);
  for (int round = 1; model.kernel && round <= options_.rbf.rounds; ++round) {
    const std::string name = fmt::format("kernel machine, round {}", round);
    const auto hard = hard_for_kernel(parts_.background.learnt, model, round, name);
    add_background(samples, data_.background, hard, hog_);
    result.rounds.push_back({name, hard.size(), samples.background.size()});
    model.kernel = kernel_machine(samples, model.linear);
  }
  if (model.kernel) model.linear.reject_below = options_.rbf.reject_below;
  return samples;
}

/// The same windows and those that were kept apart, so that no picture is wasted.
Samples Training::learn_what_was_kept_apart(const Samples& samples, const Samples& of_kernel,
                                            TrainingResult& result) const {
  const std::string name = "pictures kept apart";
  PeopleModel& model = result.model;
  std::vector<TrainingWindow> for_linear = samples.background, for_kernel = of_kernel.background;
  for (int round = 1; round <= std::max(1, options_.negatives.rounds); ++round)
    std::ranges::copy(
        hard_windows(parts_.background.kept_apart, scorer_of(model.linear), static_cast<std::uint32_t>(round), name),
        std::back_inserter(for_linear));
  for (int round = 1; model.kernel && round <= options_.rbf.rounds; ++round)
    std::ranges::copy(hard_for_kernel(parts_.background.kept_apart, model, round, name),
                      std::back_inserter(for_kernel));
  std::vector<std::uint32_t> everyone = parts_.people.learnt;
  std::ranges::copy(parts_.people.kept_apart, std::back_inserter(everyone));
  Samples all = people_samples(data_.people, everyone, hog_, options_);
  add_background(all, data_.background, for_linear, hog_);
  LinearStage linear = linear_machine(all, "all pictures");
  linear.calibration = model.linear.calibration;
  linear.reject_below = model.linear.reject_below;
  model.linear = std::move(linear);
  if (model.kernel) {
    add_background(all, data_.background, for_kernel, hog_);
    const ScoreCalibration calibration = model.kernel->calibration;
    model.kernel = kernel_machine(all, model.linear);
    if (model.kernel) model.kernel->calibration = calibration;
  }
  result.rounds.push_back({name, all.background.size() - of_kernel.background.size(), all.background.size()});
  return all;
}

std::optional<KernelStage> Training::kernel_machine(const Samples& samples, const LinearStage& linear) const {
  if (options_.kernel == SvmKernel::linear) return std::nullopt;
  say("kernel machine");
  Samples near = samples;
  keep_background(near, [&](std::span<const float> features) {
    return linear_score(linear, features) > options_.rbf.reject_below;
  });
  if (near.background.empty()) return std::nullopt;  // the linear machine already rejects all of it
  return train_kernel(near.features, near.is_person, options_.rbf, options_.seed);
}

TrainingResult Training::run() {
  TrainingResult result;
  PeopleModel& model = result.model;
  model.hog = hog_;
  const Samples samples = learn_in_rounds(model.linear, result);
  Samples of_kernel = learn_kernel_in_rounds(samples, result);
  validate(data_, parts_.people.kept_apart, parts_.background.kept_apart, kWindowsKeptApart, options_, result,
           [&](std::size_t done, std::size_t total) { say("validation", done, total); });
  const Samples all = options_.refit ? learn_what_was_kept_apart(samples, of_kernel, result) : std::move(of_kernel);
  result.people = all.people;
  result.background = all.background.size();
  return result;
}

}  // namespace

TrainingResult train_people(const TrainingData& data, const TrainOptions& options, Checkpoint& checkpoint,
                            const TrainingProgress& progress) {
  check_options(options, "options");
  checkpoint.check_pictures(data.background.size());
  std::optional<tbb::global_control> threads;
  if (options.threads > 0)
    threads.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(options.threads));
  return Training(data, options, checkpoint, progress).run();
}

}  // namespace flies
