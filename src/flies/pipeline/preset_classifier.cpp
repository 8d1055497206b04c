#include "flies/classify/people_classifier.hpp"
#include "flies/pipeline/detector.hpp"

// Apart from the presets' options: models found by name bring OpenCV along, which who only detects need not load.
namespace flies {

std::shared_ptr<const PeopleClassifier> preset_classifier(Preset preset) {
  return preset == Preset::paper ? people_classifier("flies-48x96-linear") : default_people_classifier();
}

}  // namespace flies
