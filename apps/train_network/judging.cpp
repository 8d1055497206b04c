#include "judging.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <utility>

#include "flies/classify/convolution.hpp"
#include "flies/classify/first_network.hpp"
#include "flies/classify/hog.hpp"
#include "flies/classify/people_classifier.hpp"
#include "flies/core/error.hpp"
#include "flies/eval/reliability.hpp"
#include "flies/train/calibrate.hpp"
#include "flies/train/validate.hpp"

namespace flies {
namespace {

/// The least value that no more than this share exceeds.
double value_at(std::span<const double> all, double share) {
  std::vector<double> values(all.begin(), all.end());
  std::ranges::sort(values, std::greater<>());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size()))];
}

double share_above(std::span<const double> values, double threshold) {
  return static_cast<double>(std::ranges::count_if(values, [&](double value) { return value > threshold; })) /
         static_cast<double>(values.size());
}

double calibration_error(std::span<const double> people, std::span<const double> background) {
  const auto log_odds = [](std::span<const double> probabilities) {
    std::vector<double> values;
    for (const double p : probabilities) values.push_back(std::log(p / (1.0 - p)));
    return values;
  };
  return reliability({{{"", log_odds(people)}}, {log_odds(background)}}).calibration_error;
}

/// Of a window that the first look lets through.
struct BothScores {
  double network = 0.0, linear = 0.0;
};

/// Whether the network in front of the linear machine, if there is one, lets a window through.
class Front {
 public:
  explicit Front(const PeopleModel& model) {
    if (!model.first_network) return;
    network_.emplace(*model.first_network);
    reject_below_ = model.first_network->reject_below;
  }

  bool passes(const GrayView& image, const ImageBox& window) const {
    if (!network_) return true;
    const auto sets = window_sets({&window, 1}, image, network_->raster());
    return network_->scores(image, sets.front()).front() >= reject_below_;
  }

 private:
  std::optional<FirstNetworkMachine> network_;
  double reject_below_ = 0.0;
};

std::vector<BothScores> scores_of(const PeopleModel& model, std::span<const Picture> pictures,
                                  std::span<const Place> places) {
  const ConvolutionMachine machine(*model.convolution);
  const Front front(model);
  std::vector<BothScores> scores;
  std::vector<float> features(feature_count(model.hog));
  for (const Place& place : places) {
    const GrayView image = pictures[place.picture].image.view();
    if (!is_worth_a_look(place.window, image) || !front.passes(image, place.window)) continue;
    window_features(image, place.window, model.hog, features);
    const double linear = linear_score(model.linear, features);
    if (linear >= model.linear.reject_below)
      scores.push_back({machine.score(convolution_input(image, place.window)), linear});
  }
  return scores;
}

std::vector<double> weighted(std::span<const BothScores> scores, double linear_weight) {
  std::vector<double> sums;
  for (const auto& score : scores) sums.push_back(score.network + linear_weight * score.linear);
  return sums;
}

double log_loss(const ScoreCalibration& calibration, std::span<const double> people,
                std::span<const double> background) {
  double loss = 0.0;
  for (const double score : people) loss -= std::log(std::max(probability(calibration, score), 1e-12));
  for (const double score : background) loss -= std::log(std::max(1.0 - probability(calibration, score), 1e-12));
  return loss;
}

std::vector<JudgedWindow> judged_windows(std::span<const Place> places, std::span<const double> probabilities) {
  std::vector<JudgedWindow> windows;
  for (std::size_t i = 0; i < places.size(); ++i)
    windows.push_back({{places[i].picture, false, places[i].window}, probabilities[i]});
  return windows;
}

}  // namespace

JudgedPlaces judged_places(std::span<const Picture> kept_apart, std::uint64_t seed, const JudgingOptions& options) {
  JudgedPlaces judged;
  Random random(seed);
  for (const Place& place : places_of_people(kept_apart)) {
    judged.people.push_back(place);
    judged.people.push_back({place.picture, jittered(place.window, random)});
  }
  const BackgroundPlaces places(kept_apart);
  for (int i = 0; i < options.judged; ++i) judged.background.push_back(places.draw(random));
  return judged;
}

std::vector<double> probabilities(const PeopleModel& model, std::span<const Picture> pictures,
                                  std::span<const Place> places, const std::function<void()>& progress) {
  const auto classifier = model_classifier(model);
  std::vector<double> result;
  for (const Place& place : places) {
    result.push_back(
        classifier->classify(pictures[place.picture].image.view(), std::vector<ImageBox>{place.window}).front());
    if (progress) progress();
  }
  return result;
}

void calibrate(PeopleModel& model, std::span<const Picture> kept_apart, const JudgedPlaces& judged, double share) {
  const auto people = scores_of(model, kept_apart, judged.people);
  const auto background = scores_of(model, kept_apart, judged.background);
  if (people.empty() || background.empty())
    throw InputError("pictures kept apart", "",
                     fmt::format("the first look lets {} windows with people through and {} without, which is too "
                                 "little to calibrate by; lower --reject-below or add pictures",
                                 people.size(), background.size()));
  double least_loss = std::numeric_limits<double>::infinity();
  constexpr double kStep = 0.1, kMost = 3.0;
  for (double weight = 0.0; weight <= kMost; weight += kStep) {
    const auto with = weighted(people, weight), without = weighted(background, weight);
    const ScoreCalibration calibration = fit_calibration(with, without);
    const double loss = log_loss(calibration, with, without);
    if (loss >= least_loss) continue;
    least_loss = loss;
    model.convolution->linear_weight = weight;
    model.convolution->calibration = calibration;
  }
  model.threshold = value_at(probabilities(model, kept_apart, judged.background), share);
}

std::string missed_line(const std::string& name, std::span<const double> people, std::span<const double> background) {
  std::string line = fmt::format("{:<22}", name);
  for (const double share : {1e-3, 3e-3, 1e-2, 3e-2})
    line += fmt::format("  {:g}: {:.3f}", share, 1.0 - share_above(people, value_at(background, share)));
  return line + fmt::format("  ECE {:.4f}\n", calibration_error(people, background));
}

TrainingResult validated(const PeopleModel& model, const JudgedPlaces& places, std::span<const double> people,
                         std::span<const double> background) {
  TrainingResult result;
  result.model = model;
  note_mistakes(judged_windows(places.people, people), judged_windows(places.background, background), result);
  std::size_t pictures = 0;
  for (const Place& place : places.background) pictures = std::max<std::size_t>(pictures, place.picture + 1U);
  result.validation.negatives.resize(pictures);
  for (std::size_t i = 0; i < background.size(); ++i)
    result.validation.negatives[places.background[i].picture].push_back(background[i]);
  std::erase_if(result.validation.negatives, [](const auto& picture) { return picture.empty(); });
  return result;
}

}  // namespace flies
