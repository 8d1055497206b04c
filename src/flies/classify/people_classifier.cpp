#include "flies/classify/people_classifier.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "flies/classify/kernel_machine.hpp"
#include "flies/classify/window_sets.hpp"
#include "flies/core/error.hpp"

namespace flies {
namespace {

class HogClassifier final : public PeopleClassifier {
 public:
  explicit HogClassifier(PeopleModel model) : model_(std::move(model)) {
    check_people_model(model_, model_.name.empty() ? "people model" : model_.name);
    if (model_.kernel) kernel_.emplace(*model_.kernel);
  }

  const std::string& name() const override { return model_.name; }
  double threshold() const override { return model_.threshold; }

  std::vector<double> classify(const GrayView& image, std::span<const ImageBox> windows) const override {
    std::vector<double> probabilities;
    // So many windows at a time that their features take little memory.
    for (std::size_t first = 0; first < windows.size(); first += kWindowsAtOnce) {
      const auto some = judge(image, windows.subspan(first, std::min(kWindowsAtOnce, windows.size() - first)));
      probabilities.insert(probabilities.end(), some.begin(), some.end());
    }
    return probabilities;
  }

  std::vector<double> screen(const GrayView& image, std::span<const ImageBox> windows) const override {
    std::vector<double> probabilities(windows.size(), 0.0);
    over_windows(image, windows, [&](std::size_t i, std::span<const float> features) {
      probabilities[i] = probability(model_.linear.calibration, linear_score(model_.linear, features));
    });
    return probabilities;
  }

  bool looks_twice() const override { return model_.kernel.has_value(); }

  double screen_threshold() const override {
    return model_.kernel ? probability(model_.linear.calibration, model_.linear.reject_below) : threshold();
  }

 private:
  static constexpr std::size_t kWindowsAtOnce = 256;

  /// The verdicts of both stages; the second sees all that the first lets pass together.
  std::vector<double> judge(const GrayView& image, std::span<const ImageBox> windows) const {
    const std::size_t length = feature_count(model_.hog);
    std::vector<float> all_features(windows.size() * length);
    std::vector<double> probabilities(windows.size(), 0.0), linear(windows.size());
    std::vector<char> is_asked(windows.size(), 0);
    over_windows(image, windows, [&](std::size_t i, std::span<const float> features) {
      linear[i] = linear_score(model_.linear, features);
      is_asked[i] = kernel_ && linear[i] >= model_.linear.reject_below;
      if (is_asked[i])
        std::copy(features.begin(), features.end(), all_features.begin() + static_cast<std::ptrdiff_t>(i * length));
      else
        probabilities[i] = person_probability(model_, linear[i], 0.0);
    });
    if (!kernel_) return probabilities;
    std::vector<std::size_t> asked;
    for (std::size_t i = 0; i < windows.size(); ++i) {
      if (!is_asked[i]) continue;
      std::copy_n(all_features.begin() + static_cast<std::ptrdiff_t>(i * length), length,
                  all_features.begin() + static_cast<std::ptrdiff_t>(asked.size() * length));
      asked.push_back(i);
    }
    const auto scores = kernel_->scores({all_features.data(), asked.size() * length});
    for (std::size_t k = 0; k < asked.size(); ++k)
      probabilities[asked[k]] = person_probability(model_, linear[asked[k]], scores[k]);
    return probabilities;
  }

  /// Calls `look(i, features)` for every window that is worth it.
  template <class Look>
  void over_windows(const GrayView& image, std::span<const ImageBox> windows, const Look& look) const {
    const auto sets = window_sets(windows, image, model_.hog);
    tbb::parallel_for(std::size_t{0}, sets.size(), [&](std::size_t s) {
      const HogBlocks blocks = blocks_of(sets[s], image, model_.hog);
      std::vector<float> features(feature_count(model_.hog));
      for (std::size_t i = 0; i < sets[s].windows.size(); ++i) {
        copy_features(blocks, sets[s], i, model_.hog, features);
        look(sets[s].windows[i], features);
      }
    });
  }

  PeopleModel model_;
  std::optional<KernelMachine> kernel_;
};

}  // namespace

std::shared_ptr<const PeopleClassifier> hog_classifier(PeopleModel model) {
  return std::make_shared<HogClassifier>(std::move(model));
}

std::shared_ptr<const PeopleClassifier> default_people_classifier() {
  static const auto classifier = hog_classifier(shipped_people_model());
  return classifier;
}

}  // namespace flies
