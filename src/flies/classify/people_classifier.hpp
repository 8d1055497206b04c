#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "flies/classify/people_model.hpp"
#include "flies/core/gray_view.hpp"
#include "flies/core/results.hpp"

namespace flies {

/// A cascade (Viola and Jones 2001) over windows of one image: the first stage, called the first look or `screen`, is
/// cheap and sees all or some windows; the last, `classify`, sees the few that are left. What one look finds out serves
/// the next. Threads: one object serves one thread at a time.
class PeopleLooks {
 public:
  virtual ~PeopleLooks() = default;
  PeopleLooks() = default;
  PeopleLooks(const PeopleLooks&) = delete;
  PeopleLooks& operator=(const PeopleLooks&) = delete;

  /// As `PeopleClassifier::screen` and `classify`, for the windows with these numbers, each of which once.
  virtual std::vector<double> screen(std::span<const std::size_t> some) = 0;
  virtual std::vector<double> classify(std::span<const std::size_t> some) = 0;
};

/// Says how probable it is that a window shows a person. Threads: calls may run side by side; they run on oneTBB's
/// current arena, and results do not depend on the number of threads.
class PeopleClassifier {
 public:
  virtual ~PeopleClassifier() = default;
  PeopleClassifier() = default;
  PeopleClassifier(const PeopleClassifier&) = delete;
  PeopleClassifier& operator=(const PeopleClassifier&) = delete;

  virtual const std::string& name() const = 0;

  /// Windows with a higher probability are persons.
  virtual double threshold() const = 0;

  /// The probability of every window, by all that the classifier has.
  /// @param image with pixels
  /// @returns one per window, 0 to 1; 0 for a window without area, not finite, or wholly outside the image
  virtual std::vector<double> classify(const GrayView& image, std::span<const ImageBox> windows) const = 0;

  /// A first look that is cheap and keeps the order roughly: what it gives less than `screen_threshold`, `classify`
  /// would not call a person. A classifier of one stage gives its last word here.
  virtual std::vector<double> screen(const GrayView& image, std::span<const ImageBox> windows) const {
    return classify(image, windows);
  }
  virtual double screen_threshold() const { return threshold(); }

  /// Whether `classify` sees more than `screen` does.
  virtual bool looks_twice() const { return false; }

  /// Distance between windows of one size, in their heights, at which the first look shares most between them.
  virtual double step() const { return 1.0 / 12.0; }

  /// The same in turns, on one image. Probabilities differ by rounding from those of other ways to ask.
  /// @param image, windows outlive what is returned, as does the classifier
  virtual std::unique_ptr<PeopleLooks> look_at(const GrayView& image, std::span<const ImageBox> windows) const;
};

/// @throws InputError when the model is inconsistent
std::shared_ptr<const PeopleClassifier> model_classifier(PeopleModel model);

/// The classifier that is used when none is named.
std::shared_ptr<const PeopleClassifier> default_people_classifier();

/// Finds a classifier: by name (see `people_model_names`) by the path of a model
/// file, or of a network that OpenCV reads (see `network_classifier`).
/// @throws InputError naming file and field. In the component `io`.
std::shared_ptr<const PeopleClassifier> people_classifier(std::string_view name_or_path);

}  // namespace flies
