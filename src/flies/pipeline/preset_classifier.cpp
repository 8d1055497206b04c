#include "flies/classify/model_file.hpp"
#include "flies/classify/people_classifier.hpp"
#include "flies/classify/shipped_model.hpp"
#include "flies/pipeline/detector.hpp"

namespace flies {

std::string_view preset_people_model(Preset preset) {
  return preset == Preset::paper ? "flies-48x96-linear" : "flies-48x96-network";
}

std::shared_ptr<const PeopleClassifier> preset_classifier(Preset preset) {
  if (preset != Preset::paper) return default_people_classifier();
  return model_classifier(parse_embedded_model(shipped_linear_model_text(), std::string(preset_people_model(preset))));
}

}  // namespace flies
