#include "flies/classify/model_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <nlohmann/json.hpp>

#include "flies/classify/half.hpp"
#include "flies/classify/shipped_model.hpp"
#include "flies/core/base64.hpp"
#include "flies/core/error.hpp"

static_assert(std::endian::native == std::endian::little, "numbers in model files are little-endian");

namespace flies {
namespace {

using Json = nlohmann::ordered_json;

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

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

template <class T>
std::vector<T> from_bytes(const std::string& bytes) {
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

/// In 16 bits where that loses nothing.
Json packed(const std::vector<float>& values, const std::vector<std::size_t>& shape) {
  std::vector<std::uint16_t> halves;
  std::transform(values.begin(), values.end(), std::back_inserter(halves), half_of);
  const bool lossless = std::equal(values.begin(), values.end(), halves.begin(),
                                   [](float value, std::uint16_t half) { return value == from_half(half); });
  return {{"shape", shape},
          {"type", lossless ? "float16" : "float32"},
          {"base64", to_base64(lossless ? bytes_of(halves) : bytes_of(values))}};
}

/// A model's text without the numbers that are all but a thousandth of it, so that the JSON parser has little to do:
/// every value of a key `base64` is replaced by its index behind a sign that base64 does not have.
struct SplitText {
  static constexpr char kMark = '#';
  std::string rest;
  std::vector<std::string_view> arrays;
};

SplitText split(std::string_view text) {
  constexpr std::string_view kKey = "\"base64\"", kBlanks = " \t\r\n";
  SplitText split;
  std::size_t taken = 0, at = 0;
  while ((at = text.find(kKey, at)) != std::string_view::npos) {
    at += kKey.size();
    const std::size_t colon = text.find_first_not_of(kBlanks, at);
    if (colon == std::string_view::npos || text[colon] != ':') continue;
    const std::size_t open = text.find_first_not_of(kBlanks, colon + 1);
    if (open == std::string_view::npos || text[open] != '"') continue;
    const std::size_t close = text.find('"', open + 1);
    const auto value = text.substr(open + 1, close - open - 1);
    if (close == std::string_view::npos || value.find('\\') != std::string_view::npos) continue;
    split.rest.append(text.substr(taken, open + 1 - taken));
    split.rest += SplitText::kMark + std::to_string(split.arrays.size());
    split.arrays.push_back(value);
    taken = at = close;
  }
  split.rest.append(text.substr(taken));
  return split;
}

/// A JSON object that knows where it stands in which file, and that every one of its keys has a reader.
class Reader {
 public:
  /// @param arrays what `split` took out of the text
  Reader(const Json& object, std::string source, std::string prefix, const std::vector<std::string_view>& arrays)
      : object_(object), source_(std::move(source)), prefix_(std::move(prefix)), arrays_(arrays) {
    if (!object_.is_object()) throw InputError(source_, prefix_, "expected an object");
  }

  bool has(const char* key) const { return object_.contains(key); }
  Reader child(const char* key) { return {get(key), source_, path(key), arrays_}; }

  void read(const char* key, std::string& text) {
    if (!get(key).is_string()) fail(key, "expected a text");
    text = get(key).get<std::string>();
  }
  void read(const char* key, bool& value) {
    if (!get(key).is_boolean()) fail(key, "expected true or false");
    value = get(key).get<bool>();
  }
  void read(const char* key, int& value) {
    if (!get(key).is_number_integer() || get(key).get<double>() != get(key).get<int>())
      fail(key, "expected a whole number");
    value = get(key).get<int>();
  }
  void read(const char* key, double& value) {
    if (!get(key).is_number()) fail(key, "expected a number");
    value = get(key).get<double>();
  }
  void read(const char* key, ScoreCalibration& calibration) {
    Reader fields = child(key);
    fields.read("slope", calibration.slope);
    fields.read("offset", calibration.offset);
    fields.finish();
  }
  void read(const char* key, std::vector<float>& values) {
    Matrix matrix;
    read_array(key, 1, matrix);
    values = std::move(matrix.values);
  }
  void read(const char* key, Matrix& matrix) { read_array(key, 2, matrix); }
  void read(const char* key, std::vector<std::pair<std::string, std::string>>& texts) {
    Reader fields = child(key);
    for (const auto& [name, text] : fields.object_.items()) {
      if (!text.is_string()) fields.fail(name, "expected a text");
      texts.emplace_back(name, std::string(whole(text.get_ref<const std::string&>())));
    }
  }

  /// Refuses keys that nobody asked for.
  void finish() const {
    for (const auto& [key, value] : object_.items())
      if (std::find(known_.begin(), known_.end(), key) == known_.end())
        fail(key, fmt::format("unknown key; expected {}", fmt::join(known_, ", ")));
  }
  [[noreturn]] void fail(const std::string& key, const std::string& complaint) const {
    throw InputError(source_, path(key), complaint);
  }

 private:
  std::string path(const std::string& key) const { return prefix_.empty() ? key : prefix_ + "." + key; }

  const Json& get(const char* key) {
    if (!object_.contains(key)) fail(key, "missing");
    if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.emplace_back(key);
    return object_[key];
  }

  /// Puts back what was taken out of the text.
  std::string_view whole(const std::string& text) const {
    std::size_t index = 0;
    if (!text.starts_with(SplitText::kMark)) return text;
    const auto [end, error] = std::from_chars(text.data() + 1, text.data() + text.size(), index);
    const bool is_index = error == std::errc{} && end == text.data() + text.size() && index < arrays_.size();
    return is_index ? arrays_[index] : std::string_view(text);
  }

  void read_array(const char* key, std::size_t dimensions, Matrix& matrix) {
    Reader fields = child(key);
    std::vector<std::size_t> shape;
    const Json& list = fields.get("shape");
    if (!list.is_array() || list.size() != dimensions)
      fields.fail("shape", fmt::format("expected a list of {} whole numbers", dimensions));
    for (const auto& length : list) {
      if (!length.is_number_unsigned() || length.get<std::uint64_t>() > kMaxModelFile_bytes)
        fields.fail("shape", "expected whole numbers");
      shape.push_back(length.get<std::size_t>());
    }
    std::string type, text;
    fields.read("type", type);
    fields.read("base64", text);
    fields.finish();
    if (type != "float16" && type != "float32")
      fields.fail("type", fmt::format("found '{}', expected float16 or float32", type));
    const auto bytes = from_base64(whole(text));
    if (!bytes) fields.fail("base64", "is not base64");

    matrix.rows = shape.front();
    matrix.columns = dimensions == 2 ? shape.back() : 1;
    const std::size_t expected = matrix.rows * matrix.columns * (type == "float16" ? 2 : 4);
    if (bytes->size() != expected)
      fields.fail("base64", fmt::format("holds {} bytes, expected {} by its shape", bytes->size(), expected));
    if (type == "float32") {
      matrix.values = from_bytes<float>(*bytes);
      return;
    }
    matrix.values.resize(matrix.rows * matrix.columns);
    for (std::size_t i = 0; i < matrix.values.size(); ++i) {
      std::uint16_t half = 0;
      std::memcpy(&half, bytes->data() + i * sizeof(half), sizeof(half));
      matrix.values[i] = from_half(half);
    }
  }

  const Json& object_;
  std::string source_, prefix_;
  const std::vector<std::string_view>& arrays_;
  std::vector<std::string> known_;
};

Json json_of(const ScoreCalibration& calibration) {
  return {{"slope", calibration.slope}, {"offset", calibration.offset}};
}

Json json_of(const Matrix& matrix) { return packed(matrix.values, {matrix.rows, matrix.columns}); }
Json json_of(const std::vector<float>& values) { return packed(values, {values.size()}); }

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

KernelStage read_kernel(Reader fields) {
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
ConvolutionStage read_convolution(Reader fields) {
  ConvolutionStage stage;
  for (std::size_t i = 1; i <= kMaxConvolutionLayers + 1; ++i) {
    const std::string key = fmt::format("layer_{}", i);
    if (!fields.has(key.c_str())) break;
    Reader from = fields.child(key.c_str());
    ConvolutionLayer& layer = stage.layers.emplace_back();
    from.read("stride", layer.stride);
    from.read("weights", layer.weights);
    from.read("biases", layer.biases);
    from.read("largest", layer.largest);
    from.finish();
  }
  fields.read("last", stage.last);
  fields.read("bias", stage.bias);
  fields.read("linear_weight", stage.linear_weight);
  fields.read("calibration", stage.calibration);
  fields.finish();
  return stage;
}

PeopleModel read_model(Reader root) {
  PeopleModel model;
  root.read("name", model.name);
  root.read("about", model.about);
  root.read("threshold", model.threshold);
  Reader hog = root.child("hog");
  for_each_field(model.hog, [&](const char* key, auto& field) { hog.read(key, field); });
  hog.finish();
  Reader linear = root.child("linear");
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

void check_checksum(std::string_view text, const std::string& found, const std::string& source) {
  const auto end = text.rfind(kChecksumKey);
  const std::string expected = checksum_of(text.substr(0, end));
  if (end == std::string::npos || found != expected)
    throw InputError(source, "checksum",
                     fmt::format("found '{}', but the file was cut or changed: its content has '{}'", found, expected));
}

/// @param is_checked against its checksum
PeopleModel parse(std::string_view text, const std::string& source, bool is_checked) {
  const SplitText parts = split(text);
  if (parts.rest.size() > kMaxRest_bytes)
    throw InputError(
        source, "",
        fmt::format("holds {} bytes beside its numbers, expected at most {}", parts.rest.size(), kMaxRest_bytes));
  Json json;
  try {
    json = Json::parse(parts.rest);
  } catch (const Json::out_of_range&) {
    throw InputError(source, "", "not a people model: holds a number that is not finite");
  } catch (const Json::exception&) {
    std::size_t byte = 0;
    try {
      json = Json::parse(text);  // whole, to say where it ends to be JSON
    } catch (const Json::parse_error& error) {
      byte = error.byte;
    }
    throw InputError(source, fmt::format("byte {}", byte), "not a people model: expected JSON");
  }
  Reader root(json, source, "", parts.arrays);
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

PeopleModel parse_people_model(std::string_view text, const std::string& source) { return parse(text, source, true); }

PeopleModel parse_embedded_model(std::string_view text, const std::string& source) {
  return parse(text, source, false);
}

PeopleModel shipped_people_model() { return parse_embedded_model(shipped_network_model_text(), "flies-48x96-network"); }

std::string people_model_text(const PeopleModel& model) {
  check_people_model(model, model.name);
  Json hog = Json::object(), about = Json::object();
  for_each_field(model.hog, [&](const char* key, const auto& field) { hog[key] = field; });
  for (const auto& [key, text] : model.about) about[key] = text;
  Json linear = {{"weights", json_of(model.linear.weights)},
                 {"bias", model.linear.bias},
                 {"calibration", json_of(model.linear.calibration)}};
  if (has_second_stage(model)) linear["reject_below"] = model.linear.reject_below;
  Json json = {{"format", kFormat}, {"version", kVersion},          {"name", model.name}, {"about", about},
               {"hog", hog},        {"threshold", model.threshold}, {"linear", linear}};
  if (const auto& kernel = model.kernel) {
    Json object = {{"mean", json_of(kernel->mean)}};
    if (kernel->projection.rows > 0) object["projection"] = json_of(kernel->projection);
    object["support_vectors"] = json_of(kernel->support_vectors);
    object["coefficients"] = json_of(kernel->coefficients);
    object["gamma"] = kernel->gamma;
    object["bias"] = kernel->bias;
    object["calibration"] = json_of(kernel->calibration);
    json["kernel"] = std::move(object);
  }
  if (const auto& stage = model.convolution) {
    Json object = Json::object();
    for (std::size_t i = 0; i < stage->layers.size(); ++i) {
      const ConvolutionLayer& layer = stage->layers[i];
      object[fmt::format("layer_{}", i + 1)] = {{"stride", layer.stride},
                                                {"weights", json_of(layer.weights)},
                                                {"biases", json_of(layer.biases)},
                                                {"largest", layer.largest}};
    }
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
