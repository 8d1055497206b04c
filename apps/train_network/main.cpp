// flies-train-network: trains the network of convolutions that has the last word in a people model. The only program
// that needs libtorch.
#include <fmt/format.h>
#include <malloc.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "flies/classify/convolution.hpp"
#include "flies/classify/hog.hpp"
#include "flies/classify/model_file.hpp"
#include "flies/classify/named_models.hpp"
#include "flies/classify/people_classifier.hpp"
#include "flies/core/error.hpp"
#include "flies/train/calibrate.hpp"
#include "network.hpp"
#include "windows.hpp"

namespace {

using namespace flies;

struct Arguments {
  DataFolders folders;
  bool all = false;
  LearningOptions learning;
  std::string first = "flies-48x96-linear", state, out, calibration_of, network_of;
  bool only_judge = false;
  double reject_below = -2.0;
  double background_share = 1e-3;
};

constexpr std::size_t kJudgedBackground = 30'000, kSample = 3'000;

/// Windows that were kept apart.
struct Judged {
  std::vector<Place> people, background;
};

Judged judged_places(const NetworkData& data, std::uint64_t seed) {
  Judged judged;
  Random random(seed);
  for (const Place& place : places_of_people(data.kept_apart)) {
    judged.people.push_back(place);
    judged.people.push_back({place.picture, jittered(place.window, random)});
  }
  const BackgroundPlaces places(data.kept_apart);
  for (std::size_t i = 0; i < kJudgedBackground; ++i) judged.background.push_back(places.draw(random));
  return judged;
}

std::vector<double> probabilities(const PeopleModel& model, const std::vector<Picture>& pictures,
                                  const std::vector<Place>& places) {
  const auto classifier = hog_classifier(model);
  std::vector<double> result;
  for (const Place& place : places)
    result.push_back(
        classifier->classify(pictures[place.picture].image.view(), std::vector<ImageBox>{place.window}).front());
  return result;
}

/// The least value that no more than this share exceeds.
double value_at(std::vector<double> values, double share) {
  std::ranges::sort(values, std::greater<>());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size()))];
}

double share_above(const std::vector<double>& values, double threshold) {
  return static_cast<double>(std::ranges::count_if(values, [&](double value) { return value > threshold; })) /
         static_cast<double>(values.size());
}

/// Mean distance of probability and share of people in ten bins of probability, weighted by windows.
double expected_calibration_error(const std::vector<double>& people, const std::vector<double>& background) {
  constexpr std::size_t kBins = 10;
  double count[kBins] = {}, sum[kBins] = {}, hits[kBins] = {};
  const auto add = [&](double probability, double hit) {
    const auto bin = std::min(kBins - 1, static_cast<std::size_t>(probability * kBins));
    count[bin] += 1.0;
    sum[bin] += probability;
    hits[bin] += hit;
  };
  for (const double p : people) add(p, 1.0);
  for (const double p : background) add(p, 0.0);
  double error = 0.0;
  for (std::size_t bin = 0; bin < kBins; ++bin) error += std::abs(sum[bin] - hits[bin]);
  return error / static_cast<double>(people.size() + background.size());
}

void print_rates(const std::string& name, const std::vector<double>& people, const std::vector<double>& background) {
  fmt::print("{:<22}", name);
  for (const double share : {1e-3, 3e-3, 1e-2, 3e-2})
    fmt::print("  {:g}: {:.3f}", share, 1.0 - share_above(people, value_at(background, share)));
  fmt::print("  ECE {:.4f}\n", expected_calibration_error(people, background));
}

/// Calibration, the say of the linear machine, and threshold, on the windows that were kept apart and that the first
/// look lets through.
void calibrate(PeopleModel& model, const NetworkData& data, const Judged& judged, double share) {
  const HogGeometry& hog = model.hog;
  const ConvolutionMachine machine(*model.convolution);
  const auto scores_of = [&](const std::vector<Place>& places) {
    std::vector<std::pair<double, double>> scores;  // by the network, by the linear machine
    std::vector<float> features(feature_count(hog));
    for (const Place& place : places) {
      const GrayView image = data.kept_apart[place.picture].image.view();
      if (!is_worth_a_look(place.window, image)) continue;
      window_features(image, place.window, hog, features);
      const double linear = linear_score(model.linear, features);
      if (linear >= model.linear.reject_below)
        scores.emplace_back(machine.score(convolution_input(image, place.window)), linear);
    }
    return scores;
  };
  const auto people = scores_of(judged.people), background = scores_of(judged.background);
  double least_loss = std::numeric_limits<double>::infinity();
  constexpr double kStep = 0.1, kMost = 3.0;
  for (double weight = 0.0; weight <= kMost; weight += kStep) {
    const auto sums = [&](const std::vector<std::pair<double, double>>& scores) {
      std::vector<double> values;
      for (const auto& [network, linear] : scores) values.push_back(network + weight * linear);
      return values;
    };
    const auto with = sums(people), without = sums(background);
    const ScoreCalibration calibration = fit_calibration(with, without);
    double loss = 0.0;
    for (const double score : with) loss -= std::log(std::max(probability(calibration, score), 1e-12));
    for (const double score : without) loss -= std::log(std::max(1.0 - probability(calibration, score), 1e-12));
    if (loss >= least_loss) continue;
    least_loss = loss;
    model.convolution->linear_weight = weight;
    model.convolution->calibration = calibration;
  }
  fmt::print("linear machine's weight {:.1f}\n", model.convolution->linear_weight);
  model.threshold = value_at(probabilities(model, data.kept_apart, judged.background), share);
}

void take_calibration(PeopleModel& model, const std::string& of) {
  const PeopleModel other = people_model(of);
  if (!other.convolution) throw InputError(of, "convolution", "missing, expected a model with a network");
  model.convolution->calibration = other.convolution->calibration;
  model.convolution->linear_weight = other.convolution->linear_weight;
  model.threshold = other.threshold;
}

void take_first_look(PeopleModel& model, const Arguments& arguments) {
  const PeopleModel first = people_model(arguments.first);
  model.hog = first.hog;
  model.linear = first.linear;
  model.linear.reject_below = arguments.reject_below;
  model.name = std::filesystem::path(arguments.out).stem().string();
}

/// A network that is there already behind another first look.
void put_together(const Arguments& arguments) {
  PeopleModel model = people_model(arguments.network_of);
  if (!model.convolution)
    throw InputError(arguments.network_of, "convolution", "missing, expected a model with a network");
  take_first_look(model, arguments);
  take_calibration(model, arguments.calibration_of);
  write_people_model(arguments.out, model);
}

void run(const Arguments& arguments) {
  if (!arguments.network_of.empty()) return put_together(arguments);
  DataFolders folders = arguments.folders;
  folders.keep_apart = !arguments.all;
  const NetworkData data = load_network_data(folders);
  const std::optional<Judged> judged =
      arguments.all ? std::nullopt : std::optional(judged_places(data, arguments.learning.seed));
  fmt::print("{} pictures with {} people to learn from, {} kept apart\n", data.learnt.size(),
             places_of_people(data.learnt).size(), data.kept_apart.size());
  torch::manual_seed(arguments.learning.seed);
  Network network;
  if (arguments.only_judge) {
    torch::load(network.module(), arguments.state);
  } else {
    learn(network, data.learnt, arguments.learning, [&](int epoch, double loss, std::size_t hard) {
      fmt::print("epoch {} of {}: loss {:.4f}, {} hard windows\n", epoch, arguments.learning.epochs, loss, hard);
      std::fflush(stdout);
      if (!arguments.state.empty()) torch::save(network.module(), arguments.state);
    });
  }
  std::vector<Place> sample = places_of_people(data.learnt);
  const BackgroundPlaces background(data.learnt);
  Random random(arguments.learning.seed);
  for (std::size_t i = 0; i < kSample; ++i) sample.push_back(background.draw(random));

  PeopleModel model;
  take_first_look(model, arguments);
  model.convolution = network.stage(data.learnt, sample);
  model.about = {
      {"data",
       fmt::format("{} pictures with {} people: pedestrian crops, street pictures with labelled people and without, "
                   "proposed boxes of {} folders of pairs",
                   data.learnt.size(), places_of_people(data.learnt).size(), folders.stereo.size())},
      {"kept apart", fmt::format("{} pictures of other scenes", data.kept_apart.size())},
      {"licence", "weights learnt from research data that may be used for research; no pictures are included"}};
  if (!arguments.calibration_of.empty()) {
    take_calibration(model, arguments.calibration_of);
  } else if (judged) {
    calibrate(model, data, *judged, arguments.background_share);
  }
  if (judged) {
    fmt::print("missed of {} windows with people kept apart, at the share of {} without that pass\n",
               judged->people.size(), judged->background.size());
    for (const auto& other : {people_model("flies-48x96-linear"), people_model("flies-48x96"), model})
      print_rates(other.name, probabilities(other, data.kept_apart, judged->people),
                  probabilities(other, data.kept_apart, judged->background));
  }
  write_people_model(arguments.out, model);
}

}  // namespace

int main(int argc, char** argv) {
  // Large buffers come and go by the thousand: to give them back each time takes as long as to learn.
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  Arguments arguments;
  CLI::App app(
      "trains the network of convolutions of a people model; needs street pictures with labelled people, crops\n"
      "of people, and pictures without people (docs/training.md)");
  auto* people = app.add_option("--people", arguments.folders.people, "folder with `train` and `pictures`");
  app.add_option("--stereo", arguments.folders.stereo, "pairs with truth, whose proposed boxes are learnt from");
  app.add_option("--out", arguments.out, "model file to write")->required();
  app.add_option("--first", arguments.first, "model whose linear machine looks first; default flies-48x96-linear");
  app.add_option("--reject-below", arguments.reject_below, "score of the linear machine that boxes need; default -2");
  app.add_option("--state", arguments.state, "file that the network is saved in after every epoch");
  app.add_flag("--only-judge", arguments.only_judge, "no training: the network of --state");
  app.add_flag("--all", arguments.all, "learn from all pictures, keep none apart");
  auto* calibration =
      app.add_option("--calibration-of", arguments.calibration_of, "model whose calibration and threshold are taken");
  app.add_option("--network-of", arguments.network_of,
                 "no training and no data: the network of this model, behind the first look of --first, with the\n"
                 "calibration of --calibration-of")
      ->needs(calibration)
      ->excludes(people);
  app.add_option("--background-share", arguments.background_share,
                 "share of the windows without people kept apart that pass the threshold; default 0.001")
      ->check(CLI::Range(0.0, 0.5));
  app.add_option("--epochs", arguments.learning.epochs, "default 24")->check(CLI::Range(1, 1000));
  app.add_option("--steps", arguments.learning.steps, "batches of 128 an epoch, default 400")
      ->check(CLI::Range(1, 100000));
  app.add_option("--seed", arguments.learning.seed, "default 1");
  try {
    app.parse(argc, argv);
    if (arguments.folders.people.empty() && arguments.network_of.empty())
      throw CLI::RequiredError("--people or --network-of");
    torch::set_num_threads(1);
    run(arguments);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const InputError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  } catch (const c10::Error& error) {
    fmt::print(stderr, "{}: cannot be read as a network of this shape\n", arguments.state);
    return 2;
  }
  return 0;
}
