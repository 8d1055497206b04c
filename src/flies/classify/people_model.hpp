#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace flies {

/// A linear support vector machine on histograms of oriented gradients (Dalal and Triggs 2005): plain values.
/// The score of a window is `bias + sum_k weights[k] * feature[k]`, features in the order of `cv::HOGDescriptor`.
struct PeopleModel {
  std::string name;          ///< names the model in errors
  int window_width_px = 48;  ///< windows are resized to this before their features are computed; aspect 1:2
  int window_height_px = 96;
  int block_px = 16;           ///< square blocks of cells, normalised together
  int stride_px = 8;           ///< from one block to the next, both ways
  int cell_px = 8;             ///< square cells; a block holds a whole number of them
  int bins = 9;                ///< unsigned orientations over 180 degrees
  bool gamma = true;           ///< square-root compression of grey levels before the gradients
  std::vector<float> weights;  ///< `feature_count(*this)` of them
  double bias = 0.0;
  double threshold = 0.0;  ///< a window is a person when its score exceeds this
};

/// Length of the feature vector that the model's geometry gives.
/// The geometry must be consistent: see `check_people_model`.
std::size_t feature_count(const PeopleModel& model);

/// Checks geometry (window 1:2, blocks that tile it, cells that tile a block), weight count and that all is finite.
/// @throws InputError naming `source` and the field
void check_people_model(const PeopleModel& model, const std::string& source);

/// The default: the people detector of 48 x 96 px that comes with OpenCV, trained on the Daimler data.
PeopleModel builtin_people_model();

/// Finds a model: `opencv-48x96` (the default), `opencv-64x128` (OpenCV's other people detector, trained on INRIA
/// data; needs taller people), otherwise the path of a model file.
/// @throws InputError as `load_people_model`; for a name that is no file the message lists the names
PeopleModel people_model(std::string_view name_or_path);

/// Reads a model file as written by `people_model_yaml`.
/// @throws InputError naming the file and the field: unreadable, not YAML, missing or unknown key, wrong type, wrong
///         number of weights, a number that is not finite
PeopleModel load_people_model(const std::filesystem::path& path);

/// The model as YAML text that reads back to the same values.
std::string people_model_yaml(const PeopleModel& model);

}  // namespace flies
