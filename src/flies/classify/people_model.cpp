#include "flies/classify/people_model.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <opencv2/objdetect.hpp>
#include <vector>

#include "flies/core/error.hpp"

namespace flies {
namespace {

constexpr std::string_view kOpencv48 = "opencv-48x96";
constexpr std::string_view kOpencv64 = "opencv-64x128";
/// Larger windows than this are a mistake in the file, and would ask for absurd amounts of memory.
constexpr int kMaxWindow_px = 1024;
constexpr int kMaxBins = 64;

/// Chosen on real street pairs (docs/people.md): up to here false alarms fall faster than people are lost.
constexpr double kThreshold48 = 1.0;
constexpr double kThreshold64 = 0.0;

/// OpenCV's weights end with the bias.
PeopleModel from_opencv(std::string_view name, double threshold, std::vector<float> weights_and_bias) {
  PeopleModel model;
  model.name = name;
  model.threshold = threshold;
  model.bias = weights_and_bias.back();
  weights_and_bias.pop_back();
  model.weights = std::move(weights_and_bias);
  return model;
}

PeopleModel opencv_64x128() {
  PeopleModel model = from_opencv(kOpencv64, kThreshold64, cv::HOGDescriptor::getDefaultPeopleDetector());
  model.window_width_px = 64;
  model.window_height_px = 128;
  return model;
}

/// The model's fields, once for reading and writing. `visit(key, field)`.
template <class Model, class Visit>
void for_each_field(Model& model, const Visit& visit) {
  visit("name", model.name);
  visit("window_width_px", model.window_width_px);
  visit("window_height_px", model.window_height_px);
  visit("block_px", model.block_px);
  visit("stride_px", model.stride_px);
  visit("cell_px", model.cell_px);
  visit("bins", model.bins);
  visit("gamma", model.gamma);
  visit("bias", model.bias);
  visit("threshold", model.threshold);
  visit("weights", model.weights);
}

const char* expected(const std::string&) { return "a text"; }
const char* expected(const int&) { return "a whole number"; }
const char* expected(const bool&) { return "true or false"; }
const char* expected(const double&) { return "a number"; }

template <class T>
void read_field(const YAML::Node& node, const std::string& source, const std::string& key, T& field) {
  if (!node.IsScalar())
    throw InputError(source, key, fmt::format("found a list or a map, expected {}", expected(field)));
  try {
    field = node.as<T>();
  } catch (const YAML::Exception&) {
    throw InputError(source, key, fmt::format("found '{}', expected {}", node.Scalar(), expected(field)));
  }
}

void read_field(const YAML::Node& node, const std::string& source, const std::string& key, std::vector<float>& field) {
  if (!node.IsSequence()) throw InputError(source, key, "expected a list of numbers");
  field.clear();
  for (const auto& item : node) {
    double value = 0.0;
    read_field(item, source, fmt::format("{}[{}]", key, field.size()), value);
    field.push_back(static_cast<float>(value));
  }
}

std::string read_text(const std::filesystem::path& path) {
  const std::string source = path.string();
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw InputError(source, "", "no such model file");
  if (!std::filesystem::is_regular_file(path, error)) throw InputError(source, "", "not a file");
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file) throw InputError(source, "", "cannot be read");
  return text;
}

YAML::Node parse_map(const std::string& text, const std::string& source) {
  YAML::Node root;
  try {
    root = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    throw InputError(source, fmt::format("line {}", error.mark.line + 1), "not a YAML file: " + error.msg);
  }
  if (!root.IsMap()) throw InputError(source, "", "not a people model: expected a YAML map with the key 'weights'");
  return root;
}

}  // namespace

std::size_t feature_count(const PeopleModel& model) {
  const auto blocks = [&](int window_px) { return (window_px - model.block_px) / model.stride_px + 1; };
  const int cells = model.block_px / model.cell_px;
  return static_cast<std::size_t>(blocks(model.window_width_px)) *
         static_cast<std::size_t>(blocks(model.window_height_px)) *
         static_cast<std::size_t>(cells * cells * model.bins);
}

void check_people_model(const PeopleModel& model, const std::string& source) {
  const auto require = [&](bool ok, const char* field, int found, const std::string& allowed) {
    if (!ok) throw InputError(source, field, fmt::format("found {}, expected {}", found, allowed));
  };
  const int height = model.window_height_px, width = model.window_width_px;
  require(height >= 8 && height <= kMaxWindow_px, "window_height_px", height, fmt::format("8 to {}", kMaxWindow_px));
  require(2 * width == height, "window_width_px", width, fmt::format("half of window_height_px, which is {}", height));
  require(model.block_px >= 1 && model.block_px <= width, "block_px", model.block_px, fmt::format("1 to {}", width));
  require(model.stride_px >= 1 && (width - model.block_px) % model.stride_px == 0 &&
              (height - model.block_px) % model.stride_px == 0,
          "stride_px", model.stride_px, "a step that tiles the window with blocks");
  require(model.cell_px >= 1 && model.block_px % model.cell_px == 0, "cell_px", model.cell_px,
          fmt::format("a divisor of block_px, which is {}", model.block_px));
  require(model.bins >= 2 && model.bins <= kMaxBins, "bins", model.bins, fmt::format("2 to {}", kMaxBins));

  if (model.weights.size() != feature_count(model))
    throw InputError(source, "weights",
                     fmt::format("found {} numbers, expected {}", model.weights.size(), feature_count(model)));
  for (std::size_t i = 0; i < model.weights.size(); ++i)
    if (!std::isfinite(model.weights[i]))
      throw InputError(source, fmt::format("weights[{}]", i),
                       fmt::format("found {}, expected a finite number", model.weights[i]));
  for (const auto& [field, value] : {std::pair{"bias", model.bias}, std::pair{"threshold", model.threshold}})
    if (!std::isfinite(value))
      throw InputError(source, field, fmt::format("found {}, expected a finite number", value));
}

PeopleModel builtin_people_model() {
  return from_opencv(kOpencv48, kThreshold48, cv::HOGDescriptor::getDaimlerPeopleDetector());
}

PeopleModel people_model(std::string_view name_or_path) {
  if (name_or_path == kOpencv48) return builtin_people_model();
  if (name_or_path == kOpencv64) return opencv_64x128();
  std::error_code error;
  if (!std::filesystem::exists(name_or_path, error))
    throw InputError(std::string(name_or_path), "",
                     fmt::format("no such people model; expected {}, {} or a model file", kOpencv48, kOpencv64));
  return load_people_model(name_or_path);
}

PeopleModel load_people_model(const std::filesystem::path& path) {
  const std::string source = path.string();
  const YAML::Node root = parse_map(read_text(path), source);
  PeopleModel model;
  std::vector<std::string> known;
  for_each_field(model, [&](const std::string& key, auto& field) {
    known.push_back(key);
    if (!root[key]) throw InputError(source, key, "missing");
    read_field(root[key], source, key, field);
  });
  for (const auto& entry : root) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "a list or a map";
    if (std::find(known.begin(), known.end(), key) == known.end())
      throw InputError(source, key, fmt::format("unknown key; expected {}", fmt::join(known, ", ")));
  }
  check_people_model(model, source);
  return model;
}

std::string people_model_yaml(const PeopleModel& model) {
  YAML::Emitter yaml;
  yaml << YAML::BeginMap;
  for_each_field(model, [&]<class T>(const std::string& key, const T& field) {
    yaml << YAML::Key << key << YAML::Value;
    if constexpr (std::is_same_v<T, std::vector<float>>) yaml << YAML::Flow;
    yaml << field;
  });
  yaml << YAML::EndMap;
  return std::string("# Linear SVM on HOG features, to be used with --model; see docs/people.md\n") + yaml.c_str() +
         "\n";
}

}  // namespace flies
