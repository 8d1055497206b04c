#include "flies/classify/people_classifier.hpp"

#include <tbb/parallel_for.h>

#include <utility>

#include "flies/classify/network_classifier.hpp"
#include "flies/classify/window_sets.hpp"
#include "flies/core/error.hpp"

namespace flies {
namespace {

class HogClassifier final : public PeopleClassifier {
 public:
  explicit HogClassifier(PeopleModel model) : model_(std::move(model)) {
    check_people_model(model_, model_.name.empty() ? "people model" : model_.name);
  }

  const std::string& name() const override { return model_.name; }
  double threshold() const override { return model_.threshold; }

  std::vector<double> classify(const GrayView& image, std::span<const ImageBox> windows) const override {
    return over_windows(image, windows,
                        [&](std::span<const float> features) { return person_probability(model_, features); });
  }

  std::vector<double> screen(const GrayView& image, std::span<const ImageBox> windows) const override {
    return over_windows(image, windows, [&](std::span<const float> features) {
      return probability(model_.linear.calibration, linear_score(model_.linear, features));
    });
  }

  bool looks_twice() const override { return model_.kernel.has_value(); }

  double screen_threshold() const override {
    return model_.kernel ? probability(model_.linear.calibration, model_.linear.reject_below) : threshold();
  }

 private:
  template <class Judge>
  std::vector<double> over_windows(const GrayView& image, std::span<const ImageBox> windows, const Judge& judge) const {
    std::vector<double> probabilities(windows.size(), 0.0);
    const auto sets = window_sets(windows, image, model_.hog);
    tbb::parallel_for(std::size_t{0}, sets.size(), [&](std::size_t s) {
      const HogBlocks blocks = blocks_of(sets[s], image, model_.hog);
      std::vector<float> features(feature_count(model_.hog));
      for (std::size_t i = 0; i < sets[s].windows.size(); ++i) {
        copy_features(blocks, sets[s], i, model_.hog, features);
        probabilities[sets[s].windows[i]] = judge(features);
      }
    });
    return probabilities;
  }

  PeopleModel model_;
};

}  // namespace

std::shared_ptr<const PeopleClassifier> hog_classifier(PeopleModel model) {
  return std::make_shared<HogClassifier>(std::move(model));
}

std::shared_ptr<const PeopleClassifier> default_people_classifier() { return hog_classifier(shipped_people_model()); }

std::shared_ptr<const PeopleClassifier> people_classifier(std::string_view name_or_path) {
  if (const std::string path(name_or_path); is_network_file(path)) return network_classifier(path);
  return hog_classifier(people_model(name_or_path));
}

}  // namespace flies
