#include "flies/classify/model_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>

#include "flies/classify/half.hpp"
#include "flies/classify/model_file.hpp"
#include "flies/core/base64.hpp"
#include "flies/core/error.hpp"

static_assert(std::endian::native == std::endian::little, "numbers in model files are little-endian");

namespace flies {
namespace {

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
ModelJson packed(const std::vector<float>& values, const std::vector<std::size_t>& shape) {
  std::vector<std::uint16_t> halves;
  std::transform(values.begin(), values.end(), std::back_inserter(halves), half_of);
  const bool lossless = std::equal(values.begin(), values.end(), halves.begin(),
                                   [](float value, std::uint16_t half) { return value == from_half(half); });
  return {{"shape", shape},
          {"type", lossless ? "float16" : "float32"},
          {"base64", to_base64(lossless ? bytes_of(halves) : bytes_of(values))}};
}

}  // namespace

SplitText split_arrays(std::string_view text) {
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

ModelJson json_of(const ScoreCalibration& calibration) {
  return {{"slope", calibration.slope}, {"offset", calibration.offset}};
}

ModelJson json_of(const Matrix& matrix) { return packed(matrix.values, {matrix.rows, matrix.columns}); }
ModelJson json_of(const std::vector<float>& values) { return packed(values, {values.size()}); }

ModelReader::ModelReader(const ModelJson& object, std::string source, std::string prefix,
                         const std::vector<std::string_view>& arrays)
    : object_(object), source_(std::move(source)), prefix_(std::move(prefix)), arrays_(arrays) {
  if (!object_.is_object()) throw InputError(source_, prefix_, "expected an object");
}

void ModelReader::read(const char* key, std::string& text) {
  if (!get(key).is_string()) fail(key, "expected a text");
  text = get(key).get<std::string>();
}

void ModelReader::read(const char* key, bool& value) {
  if (!get(key).is_boolean()) fail(key, "expected true or false");
  value = get(key).get<bool>();
}

void ModelReader::read(const char* key, int& value) {
  if (!get(key).is_number_integer() || get(key).get<double>() != get(key).get<int>())
    fail(key, "expected a whole number");
  value = get(key).get<int>();
}

void ModelReader::read(const char* key, double& value) {
  if (!get(key).is_number()) fail(key, "expected a number");
  value = get(key).get<double>();
}

void ModelReader::read(const char* key, ScoreCalibration& calibration) {
  ModelReader fields = child(key);
  fields.read("slope", calibration.slope);
  fields.read("offset", calibration.offset);
  fields.finish();
}

void ModelReader::read(const char* key, std::vector<float>& values) {
  Matrix matrix;
  read_array(key, 1, matrix);
  values = std::move(matrix.values);
}

void ModelReader::read(const char* key, std::vector<std::pair<std::string, std::string>>& texts) {
  ModelReader fields = child(key);
  for (const auto& [name, text] : fields.object_.items()) {
    if (!text.is_string()) fields.fail(name, "expected a text");
    texts.emplace_back(name, std::string(whole(text.get_ref<const std::string&>())));
  }
}

void ModelReader::finish() const {
  for (const auto& [key, value] : object_.items())
    if (std::find(known_.begin(), known_.end(), key) == known_.end())
      fail(key, fmt::format("unknown key; expected {}", fmt::join(known_, ", ")));
}

void ModelReader::fail(const std::string& key, const std::string& complaint) const {
  throw InputError(source_, path(key), complaint);
}

const ModelJson& ModelReader::get(const char* key) {
  if (!object_.contains(key)) fail(key, "missing");
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.emplace_back(key);
  return object_[key];
}

/// Puts back what was taken out of the text.
std::string_view ModelReader::whole(const std::string& text) const {
  std::size_t index = 0;
  if (!text.starts_with(SplitText::kMark)) return text;
  const auto [end, error] = std::from_chars(text.data() + 1, text.data() + text.size(), index);
  const bool is_index = error == std::errc{} && end == text.data() + text.size() && index < arrays_.size();
  return is_index ? arrays_[index] : std::string_view(text);
}

void ModelReader::read_array(const char* key, std::size_t dimensions, Matrix& matrix) {
  ModelReader fields = child(key);
  std::vector<std::size_t> shape;
  const ModelJson& list = fields.get("shape");
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

}  // namespace flies
