#include "flies/train/validate.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "flies/train/calibrate.hpp"

namespace flies {
namespace {

constexpr std::size_t kHardestShown = 48;  // of each kind, in the report

/// What the machines say of one window.
struct Scored {
  TrainingWindow window;
  double linear = 0.0;
  std::optional<double> kernel;  ///< nothing where the linear machine rejects
};

std::vector<Scored> scores_in(const GrayImage& image, std::span<const TrainingWindow> windows,
                              const PeopleModel& model) {
  const Matrix features = features_in(image, windows, model.hog);
  std::vector<Scored> scores;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    Scored scored{windows[i], linear_score(model.linear, features.row(i)), {}};
    if (model.kernel && scored.linear >= model.linear.reject_below)
      scored.kernel = kernel_score(*model.kernel, features.row(i));
    scores.push_back(scored);
  }
  return scores;
}

/// As `person_probability`, from the scores.
double probability_of(const Scored& scored, const PeopleModel& model) {
  const double first = probability(model.linear.calibration, scored.linear);
  if (!model.kernel) return first;
  if (!scored.kernel)
    return kRejectedProbability * first / probability(model.linear.calibration, model.linear.reject_below);
  return kRejectedProbability + (1.0 - kRejectedProbability) * probability(model.kernel->calibration, *scored.kernel);
}

/// Both machines learn their calibration from the windows that the second one is asked about: nobody asks about sky,
/// and its share would decide what "probable" means.
void fit_calibrations(std::span<const Scored> people, std::span<const Scored> background, double near,
                      PeopleModel& model) {
  const auto near_scores = [&](std::span<const Scored> windows, const auto& score) {
    std::vector<double> scores;
    for (const auto& window : windows)
      if (window.linear >= near) scores.push_back(score(window));
    return scores;
  };
  const auto linear = [](const Scored& window) { return window.linear; };
  model.linear.calibration = fit_calibration(near_scores(people, linear), near_scores(background, linear));
  if (!model.kernel) return;
  const auto kernel = [](const Scored& window) { return *window.kernel; };
  model.kernel->calibration = fit_calibration(near_scores(people, kernel), near_scores(background, kernel));
}

std::vector<JudgedWindow> judged(std::span<const Scored> windows, const PeopleModel& model) {
  std::vector<JudgedWindow> result;
  for (const auto& window : windows) result.push_back({window.window, probability_of(window, model)});
  return result;
}

template <class Before>
std::vector<JudgedWindow> first_few(std::span<const JudgedWindow> all, const Before& before) {
  std::vector<JudgedWindow> windows(all.begin(), all.end());
  std::stable_sort(windows.begin(), windows.end(), before);
  windows.resize(std::min(windows.size(), kHardestShown));
  return windows;
}

}  // namespace

void validate(const TrainingData& data, std::span<const std::uint32_t> people,
              std::span<const std::uint32_t> background, std::uint32_t round, const TrainOptions& options,
              TrainingResult& result, const std::function<void(std::size_t done, std::size_t total)>& progress) {
  PeopleModel& model = result.model;
  std::vector<Scored> people_scores, background_scores;
  std::vector<std::size_t> of_picture;  // background windows
  std::size_t done = 0;
  const auto judge = [&](const GrayImage& image, std::span<const TrainingWindow> windows, std::vector<Scored>& all) {
    const auto scores = scores_in(image, windows, model);
    all.insert(all.end(), scores.begin(), scores.end());
    progress(++done, people.size() + background.size());
  };
  for (const std::uint32_t i : people)
    judge(load_picture(data.people[i]), exact_windows_with_people(data.people[i], i, options.positives.person_share),
          people_scores);
  for (const std::uint32_t i : background) {
    const GrayImage image = load_picture(data.background[i]);
    const auto windows = windows_without_people(data.background[i], image.width_px, image.height_px, i, round,
                                                options.negatives.validation_per_picture, options);
    judge(image, windows, background_scores);
    of_picture.push_back(windows.size());
  }
  fit_calibrations(people_scores, background_scores, options.rbf.reject_below, model);

  const auto judged_people = judged(people_scores, model), judged_background = judged(background_scores, model);
  std::vector<double> all;
  for (const auto& window : judged_background) all.push_back(window.probability);
  if (!all.empty()) model.threshold = std::max(0.0, threshold_at(all, options.false_positive_rate));

  auto next = all.begin();
  for (const std::size_t count : of_picture) {
    result.validation.negatives.emplace_back(next, next + static_cast<std::ptrdiff_t>(count));
    next += static_cast<std::ptrdiff_t>(count);
  }
  note_mistakes(judged_people, judged_background, result);
}

void note_mistakes(std::span<const JudgedWindow> people, std::span<const JudgedWindow> background,
                   TrainingResult& result) {
  result.validation.positives = {{"kept apart", {}}};
  std::size_t found = 0;
  for (const auto& window : people) {
    result.validation.positives.front().scores.push_back(window.probability);
    found += window.probability > result.model.threshold;
  }
  result.validation_rate = people.empty() ? 0.0 : static_cast<double>(found) / static_cast<double>(people.size());
  result.missed = first_few(people, [](const auto& a, const auto& b) { return a.probability < b.probability; });
  result.mistaken = first_few(background, [](const auto& a, const auto& b) { return a.probability > b.probability; });
}

}  // namespace flies
