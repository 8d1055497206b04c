#include "flies/classify/model_file.hpp"

#include <fmt/format.h>

#include <cstdint>

#include "flies/classify/half.hpp"
#include "flies/classify/model_json.hpp"
#include "flies/classify/shipped_model.hpp"
#include "flies/core/error.hpp"

namespace flies {
namespace {

constexpr const char* kFormat = "flies people model";
constexpr int kVersion = 1;
/// Without the numbers of arrays. Keys are looked up one after the other: more of them would take minutes.
constexpr std::size_t kMaxRest_bytes = std::size_t{1} << 17;
constexpr std::string_view kChecksumKey = "\n \"checksum\": ";

/// FNV-1a with 64 bits: short to write in any language, and enough against files cut short or edited.
std::string checksum_of(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3U;
  return fmt::format("fnv1a64 {:016x}", hash);
}

/// The geometry's fields, once for reading and writing.
template <class Geometry, class Visit>
void for_each_field(Geometry& hog, const Visit& visit) {
  visit("window_width_px", hog.window_width_px);
  visit("window_height_px", hog.window_height_px);
  visit("block_px", hog.block_px);
  visit("stride_px", hog.stride_px);
  visit("cell_px", hog.cell_px);
  visit("bins", hog.bins);
  visit("gamma", hog.gamma);
}

KernelStage read_kernel(ModelReader fields) {
  KernelStage kernel;
  fields.read("mean", kernel.mean);
  if (fields.has("projection")) fields.read("projection", kernel.projection);
  fields.read("support_vectors", kernel.support_vectors);
  fields.read("coefficients", kernel.coefficients);
  fields.read("gamma", kernel.gamma);
  fields.read("bias", kernel.bias);
  fields.read("calibration", kernel.calibration);
  fields.finish();
  return kernel;
}

/// Layers are numbered from 1, the first that is not there ends them.
std::vector<ConvolutionLayer> read_layers(ModelReader& fields, bool have_biases) {
  std::vector<ConvolutionLayer> layers;
  for (std::size_t i = 1; i <= kMaxConvolutionLayers + 1; ++i) {
    const std::string key = fmt::format("layer_{}", i);
    if (!fields.has(key.c_str())) break;
    ModelReader from = fields.child(key.c_str());
    ConvolutionLayer& layer = layers.emplace_back();
    from.read("stride", layer.stride);
    from.read("weights", layer.weights);
    if (have_biases) from.read("biases", layer.biases);
    from.read("largest", layer.largest);
    from.finish();
  }
  return layers;
}

FirstNetwork read_first_network(ModelReader fields) {
  FirstNetwork network;
  network.layers = read_layers(fields, false);
  fields.read("last", network.last);
  fields.read("bias", network.bias);
  fields.read("reject_below", network.reject_below);
  fields.finish();
  return network;
}

ConvolutionStage read_convolution(ModelReader fields) {
  ConvolutionStage stage;
  stage.layers = read_layers(fields, true);
  fields.read("last", stage.last);
  fields.read("bias", stage.bias);
  fields.read("linear_weight", stage.linear_weight);
  fields.read("calibration", stage.calibration);
  fields.finish();
  return stage;
}

PeopleModel read_model(ModelReader root) {
  PeopleModel model;
  root.read("name", model.name);
  root.read("about", model.about);
  root.read("threshold", model.threshold);
  if (root.has("first_network")) model.first_network = read_first_network(root.child("first_network"));
  ModelReader hog = root.child("hog");
  for_each_field(model.hog, [&](const char* key, auto& field) { hog.read(key, field); });
  hog.finish();
  ModelReader linear = root.child("linear");
  linear.read("weights", model.linear.weights);
  linear.read("bias", model.linear.bias);
  linear.read("calibration", model.linear.calibration);
  if (root.has("kernel")) model.kernel = read_kernel(root.child("kernel"));
  if (root.has("convolution")) model.convolution = read_convolution(root.child("convolution"));
  if (has_second_stage(model)) linear.read("reject_below", model.linear.reject_below);
  linear.finish();
  root.finish();
  return model;
}

ModelJson json_of_layers(const std::vector<ConvolutionLayer>& layers) {
  ModelJson object = ModelJson::object();
  for (std::size_t i = 0; i < layers.size(); ++i) {
    ModelJson layer = {{"stride", layers[i].stride}, {"weights", json_of(layers[i].weights)}};
    if (!layers[i].biases.empty()) layer["biases"] = json_of(layers[i].biases);
    layer["largest"] = layers[i].largest;
    object[fmt::format("layer_{}", i + 1)] = std::move(layer);
  }
  return object;
}

void check_checksum(std::string_view text, const std::string& found, const std::string& source) {
  const auto end = text.rfind(kChecksumKey);
  const std::string expected = checksum_of(text.substr(0, end));
  if (end == std::string::npos || found != expected)
    throw InputError(source, "checksum",
                     fmt::format("found '{}', but the file was cut or changed: its content has '{}'", found, expected));
}

/// @param is_checked against its checksum
PeopleModel parse(std::string_view text, const std::string& source, bool is_checked) {
  const SplitText parts = split_arrays(text);
  if (parts.rest.size() > kMaxRest_bytes)
    throw InputError(
        source, "",
        fmt::format("holds {} bytes beside its numbers, expected at most {}", parts.rest.size(), kMaxRest_bytes));
  ModelJson json;
  try {
    json = ModelJson::parse(parts.rest);
  } catch (const ModelJson::out_of_range&) {
    throw InputError(source, "", "not a people model: holds a number that is not finite");
  } catch (const ModelJson::exception&) {
    std::size_t byte = 0;
    try {
      json = ModelJson::parse(text);  // whole, to say where it ends to be JSON
    } catch (const ModelJson::parse_error& error) {
      byte = error.byte;
    }
    throw InputError(source, fmt::format("byte {}", byte), "not a people model: expected JSON");
  }
  ModelReader root(json, source, "", parts.arrays);
  std::string format, checksum;
  int version = 0;
  root.read("format", format);
  if (format != kFormat) root.fail("format", fmt::format("found '{}', expected '{}'", format, kFormat));
  root.read("version", version);
  if (version != kVersion) root.fail("version", fmt::format("found {}, expected {}", version, kVersion));
  root.read("checksum", checksum);
  PeopleModel model = read_model(std::move(root));
  if (is_checked) check_checksum(text, checksum, source);
  check_people_model(model, source);
  return model;
}

}  // namespace

void check_model_text(const std::string& text, const std::string& source, const std::string& field) {
  try {
    static_cast<void>(ModelJson(text).dump());
  } catch (const ModelJson::exception&) {
    throw InputError(source, field, "is not UTF-8, which the texts of a model file are");
  }
}

PeopleModel parse_people_model(std::string_view text, const std::string& source) { return parse(text, source, true); }

PeopleModel parse_embedded_model(std::string_view text, const std::string& source) {
  return parse(text, source, false);
}

PeopleModel shipped_people_model() { return parse_embedded_model(shipped_network_model_text(), "flies-48x96-network"); }

std::string people_model_text(const PeopleModel& model) {
  check_people_model(model, model.name);
  check_model_text(model.name, "people model", "name");
  for (const auto& [key, text] : model.about) {
    check_model_text(key, "people model", "about");
    check_model_text(text, "people model", "about." + key);
  }
  ModelJson hog = ModelJson::object(), about = ModelJson::object();
  for_each_field(model.hog, [&](const char* key, const auto& field) { hog[key] = field; });
  for (const auto& [key, text] : model.about) about[key] = text;
  ModelJson linear = {{"weights", json_of(model.linear.weights)},
                      {"bias", model.linear.bias},
                      {"calibration", json_of(model.linear.calibration)}};
  if (has_second_stage(model)) linear["reject_below"] = model.linear.reject_below;
  ModelJson json = {{"format", kFormat}, {"version", kVersion},          {"name", model.name}, {"about", about},
                    {"hog", hog},        {"threshold", model.threshold}, {"linear", linear}};
  if (const auto& network = model.first_network) {
    ModelJson object = json_of_layers(network->layers);
    object["last"] = json_of(network->last);
    object["bias"] = network->bias;
    object["reject_below"] = network->reject_below;
    json["first_network"] = std::move(object);
  }
  if (const auto& kernel = model.kernel) {
    ModelJson object = {{"mean", json_of(kernel->mean)}};
    if (kernel->projection.rows > 0) object["projection"] = json_of(kernel->projection);
    object["support_vectors"] = json_of(kernel->support_vectors);
    object["coefficients"] = json_of(kernel->coefficients);
    object["gamma"] = kernel->gamma;
    object["bias"] = kernel->bias;
    object["calibration"] = json_of(kernel->calibration);
    json["kernel"] = std::move(object);
  }
  if (const auto& stage = model.convolution) {
    ModelJson object = json_of_layers(stage->layers);
    object["last"] = json_of(stage->last);
    object["bias"] = stage->bias;
    object["linear_weight"] = stage->linear_weight;
    object["calibration"] = json_of(stage->calibration);
    json["convolution"] = std::move(object);
  }
  constexpr int kIndent = 1;
  std::string text = json.dump(kIndent);
  text.resize(text.rfind('\n'));
  text += ',';
  const std::string checksum = checksum_of(text);
  text.append(kChecksumKey).append(1, '"').append(checksum).append("\"\n}\n");
  return text;
}

void round_to_half(std::vector<float>& values) {
  for (float& value : values) value = from_half(half_of(value));
}

}  // namespace flies
