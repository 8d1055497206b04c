#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "flies/classify/people_classifier.hpp"
#include "flies/core/error.hpp"

namespace flies {

/// Looks whose answers are as many and as probable as they must be, whoever wrote the classifier.
/// @param image, windows outlive it, as does the classifier
class CheckedLooks {
 public:
  CheckedLooks(const PeopleClassifier& classifier, const GrayView& image, std::span<const ImageBox> windows)
      : classifier_(classifier), image_(image), looks_(classifier.look_at(image, windows)) {
    if (!looks_) throw InputError(classifier.name(), "look_at", "found none, expected looks at the windows");
    const double threshold = classifier.threshold();
    if (!(threshold >= 0.0 && threshold <= 1.0))
      throw InputError(classifier.name(), "threshold", fmt::format("found {}, expected 0 to 1", threshold));
  }

  std::vector<double> screen(std::span<const std::size_t> some) { return checked(looks_->screen(some), some.size()); }
  std::vector<double> classify(std::span<const std::size_t> some) {
    return checked(looks_->classify(some), some.size());
  }
  /// Windows that were not among those to look at.
  std::vector<double> classify_others(std::span<const ImageBox> windows) const {
    return checked(classifier_.classify(image_, windows), windows.size());
  }

 private:
  std::vector<double> checked(std::vector<double> probabilities, std::size_t expected) const {
    if (probabilities.size() != expected)
      throw InputError(classifier_.name(), "probabilities",
                       fmt::format("found {}, expected {}, one a window", probabilities.size(), expected));
    for (const double p : probabilities)
      if (!(p >= 0.0 && p <= 1.0))
        throw InputError(classifier_.name(), "probability", fmt::format("found {}, expected 0 to 1", p));
    return probabilities;
  }

  const PeopleClassifier& classifier_;
  GrayView image_;
  std::unique_ptr<PeopleLooks> looks_;
};

}  // namespace flies
