#include "flies/classify/people_classifier.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

#include "flies/classify/convolution.hpp"
#include "flies/classify/first_network.hpp"
#include "flies/classify/kernel_machine.hpp"
#include "flies/classify/model_file.hpp"
#include "flies/classify/svm_scores.hpp"
#include "flies/classify/window_sets.hpp"
#include "flies/core/error.hpp"

namespace flies {
namespace {

std::vector<ImageBox> chosen(std::span<const ImageBox> windows, std::span<const std::size_t> some) {
  std::vector<ImageBox> result;
  for (const std::size_t i : some) result.push_back(windows[i]);
  return result;
}

/// For classifiers that keep nothing from one look to the next.
class SeparateLooks final : public PeopleLooks {
 public:
  SeparateLooks(const PeopleClassifier& classifier, const GrayView& image, std::span<const ImageBox> windows)
      : classifier_(classifier), image_(image), windows_(windows) {}

  std::vector<double> screen(std::span<const std::size_t> some) override {
    return classifier_.screen(image_, chosen(windows_, some));
  }
  std::vector<double> classify(std::span<const std::size_t> some) override {
    return classifier_.classify(image_, chosen(windows_, some));
  }

 private:
  const PeopleClassifier& classifier_;
  GrayView image_;
  std::span<const ImageBox> windows_;
};

/// Networks and kernel machine of a model, ready to run.
struct Machines {
  std::optional<FirstNetworkMachine> first;
  std::optional<KernelMachine> kernel;
  std::optional<ConvolutionMachine> convolution;
};

/// Keeps the blocks of all sets of windows whose histograms it has made: some 100 kB for an obstacle.
class ModelLooks final : public PeopleLooks {
 public:
  ModelLooks(const PeopleModel& model, const Machines& machines, const GrayView& image,
             std::span<const ImageBox> windows)
      : model_(model), machines_(machines), image_(image), windows_(windows), seen_(windows.size()) {}

  std::vector<double> screen(std::span<const std::size_t> some) override {
    look(some);
    std::vector<double> probabilities;
    for (const std::size_t i : some) probabilities.push_back(screened(seen_[i]));
    return probabilities;
  }

  std::vector<double> classify(std::span<const std::size_t> some) override {
    look(some);
    std::vector<double> probabilities;
    std::vector<std::size_t> asked;  // the second stage, about all that the first lets pass together
    for (std::size_t k = 0; k < some.size(); ++k) {
      const Seen& seen = seen_[some[k]];
      probabilities.push_back(seen.is_accepted   ? person_probability(model_, seen.linear, 0.0)
                              : seen.is_rejected ? rejected_probability(model_, seen.network)
                                                 : 0.0);
      if (has_second_stage(model_) && seen.is_accepted && seen.linear >= model_.linear.reject_below) asked.push_back(k);
    }
    if (asked.empty()) return probabilities;
    const auto scores = second_scores(some, asked);
    for (std::size_t a = 0; a < asked.size(); ++a)
      probabilities[asked[a]] = person_probability(model_, seen_[some[asked[a]]].linear, scores[a]);
    return probabilities;
  }

 private:
  struct Seen {
    bool is_looked_at = false;
    bool is_rejected = false;  ///< by the network in front
    bool is_accepted = false;  ///< worth a look, and not that
    double network = 0.0;      ///< scores, where there are such
    double linear = 0.0;
    FeaturePieces features;
  };

  /// @param asked places in `some`
  std::vector<double> second_scores(std::span<const std::size_t> some, std::span<const std::size_t> asked) const {
    if (machines_.convolution) {
      std::vector<ImageBox> windows;
      for (const std::size_t k : asked) windows.push_back(windows_[some[k]]);
      return machines_.convolution->scores(image_, windows);
    }
    const std::size_t length = feature_count(model_.hog);
    std::vector<float> features(asked.size() * length);
    for (std::size_t a = 0; a < asked.size(); ++a) seen_[some[asked[a]]].features.copy_to(features.data() + a * length);
    return machines_.kernel->scores(features);
  }

  /// What the network rejects stays below what the linear machine rejects.
  double screened(const Seen& seen) const {
    const LinearStage& linear = model_.linear;
    if (seen.is_accepted) return probability(linear.calibration, seen.linear);
    if (!seen.is_rejected) return 0.0;
    return rejected_probability(model_, seen.network) * probability(linear.calibration, linear.reject_below);
  }

  /// The first stage, where it has not looked yet.
  void look(std::span<const std::size_t> some) {
    std::vector<std::size_t> fresh;
    for (const std::size_t i : some)
      if (!std::exchange(seen_[i].is_looked_at, true)) fresh.push_back(i);
    if (machines_.first) {
      look_by_network(fresh);
      std::erase_if(fresh, [&](std::size_t i) { return seen_[i].is_rejected; });
    }
    look_by_histograms(fresh);
  }

  void look_by_network(std::span<const std::size_t> fresh) {
    const auto sets = window_sets(chosen(windows_, fresh), image_, machines_.first->raster());
    tbb::parallel_for(std::size_t{0}, sets.size(), [&](std::size_t s) {
      const auto scores = machines_.first->scores(image_, sets[s]);
      for (std::size_t k = 0; k < scores.size(); ++k) {
        Seen& seen = seen_[fresh[sets[s].windows[k]]];
        seen.network = scores[k];
        seen.is_rejected = seen.network < model_.first_network->reject_below;
      }
    });
  }

  void look_by_histograms(std::span<const std::size_t> fresh) {
    const auto sets = window_sets(chosen(windows_, fresh), image_, WindowRaster::of(model_.hog));
    const std::size_t before = blocks_.size();
    blocks_.resize(before + sets.size());
    tbb::parallel_for(std::size_t{0}, sets.size(), [&](std::size_t s) {
      HogBlocks& blocks = blocks_[before + s];
      blocks = blocks_of(sets[s], image_, model_.hog);
      for (std::size_t k = 0; k < sets[s].windows.size(); ++k) {
        Seen& seen = seen_[fresh[sets[s].windows[k]]];
        seen.is_accepted = true;
        seen.features = features_of(blocks, sets[s], k, model_.hog);
        seen.linear = linear_score(model_.linear, seen.features);
      }
    });
  }

  const PeopleModel& model_;
  const Machines& machines_;
  GrayView image_;
  std::span<const ImageBox> windows_;
  std::vector<Seen> seen_;
  std::vector<HogBlocks> blocks_;
};

class ModelClassifier final : public PeopleClassifier {
 public:
  explicit ModelClassifier(PeopleModel model) : model_(std::move(model)) {
    check_people_model(model_, model_.name.empty() ? "people model" : model_.name);
    if (model_.first_network) machines_.first.emplace(*model_.first_network);
    if (model_.kernel) machines_.kernel.emplace(*model_.kernel);
    if (model_.convolution) machines_.convolution.emplace(*model_.convolution);
  }

  const std::string& name() const override { return model_.name; }
  double threshold() const override { return model_.threshold; }

  std::vector<double> classify(const GrayView& image, std::span<const ImageBox> windows) const override {
    return in_parts(image, windows,
                    [](PeopleLooks& looks, std::span<const std::size_t> all) { return looks.classify(all); });
  }

  std::vector<double> screen(const GrayView& image, std::span<const ImageBox> windows) const override {
    return in_parts(image, windows,
                    [](PeopleLooks& looks, std::span<const std::size_t> all) { return looks.screen(all); });
  }

  bool looks_twice() const override { return has_second_stage(model_); }

  double screen_threshold() const override {
    return has_second_stage(model_) ? probability(model_.linear.calibration, model_.linear.reject_below) : threshold();
  }

  double step() const override {
    return static_cast<double>(model_.hog.stride_px) / static_cast<double>(model_.hog.window_height_px);
  }

  std::unique_ptr<PeopleLooks> look_at(const GrayView& image, std::span<const ImageBox> windows) const override {
    return std::make_unique<ModelLooks>(model_, machines_, image, windows);
  }

 private:
  /// So many windows at a time that their features take little memory.
  template <class Ask>
  std::vector<double> in_parts(const GrayView& image, std::span<const ImageBox> windows, const Ask& ask) const {
    constexpr std::size_t kWindowsAtOnce = 256;
    std::vector<double> probabilities;
    for (std::size_t first = 0; first < windows.size(); first += kWindowsAtOnce) {
      const auto part = windows.subspan(first, std::min(kWindowsAtOnce, windows.size() - first));
      std::vector<std::size_t> all(part.size());
      std::iota(all.begin(), all.end(), std::size_t{0});
      ModelLooks looks(model_, machines_, image, part);
      const auto of_part = ask(looks, all);
      probabilities.insert(probabilities.end(), of_part.begin(), of_part.end());
    }
    return probabilities;
  }

  PeopleModel model_;
  Machines machines_;
};

}  // namespace

std::unique_ptr<PeopleLooks> PeopleClassifier::look_at(const GrayView& image, std::span<const ImageBox> windows) const {
  return std::make_unique<SeparateLooks>(*this, image, windows);
}

std::shared_ptr<const PeopleClassifier> model_classifier(PeopleModel model) {
  return std::make_shared<ModelClassifier>(std::move(model));
}

std::shared_ptr<const PeopleClassifier> default_people_classifier() {
  static const auto classifier = model_classifier(shipped_people_model());
  return classifier;
}

}  // namespace flies
