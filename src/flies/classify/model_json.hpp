#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "flies/classify/people_model.hpp"

namespace flies {

using ModelJson = nlohmann::ordered_json;

/// A model's text without the numbers that are all but a thousandth of it, so that the JSON parser has little to do:
/// every value of a key `base64` is replaced by its index behind a sign that base64 does not have.
struct SplitText {
  static constexpr char kMark = '#';
  std::string rest;
  std::vector<std::string_view> arrays;  ///< parts of the text that was split
};
SplitText split_arrays(std::string_view text);

ModelJson json_of(const ScoreCalibration& calibration);
/// Shape, type and base64; in 16 bits where that loses nothing.
ModelJson json_of(const Matrix& matrix);
ModelJson json_of(const std::vector<float>& values);

/// A JSON object of a model file that knows where it stands in which file, and that every one of its keys has a reader.
/// Whatever is missing or of another type is refused.
/// @throws InputError naming file and key
class ModelReader {
 public:
  /// @param object, arrays  what `split_arrays` left of the text, and what it took out; both stay with the caller
  ModelReader(const ModelJson& object, std::string source, std::string prefix,
              const std::vector<std::string_view>& arrays);

  bool has(const char* key) const { return object_.contains(key); }
  ModelReader child(const char* key) { return {get(key), source_, path(key), arrays_}; }

  void read(const char* key, std::string& text);
  void read(const char* key, bool& value);
  void read(const char* key, int& value);
  void read(const char* key, double& value);
  void read(const char* key, ScoreCalibration& calibration);
  void read(const char* key, std::vector<float>& values);
  void read(const char* key, Matrix& matrix) { read_array(key, 2, matrix); }
  void read(const char* key, std::vector<std::pair<std::string, std::string>>& texts);

  /// Refuses keys that nobody asked for.
  void finish() const;
  [[noreturn]] void fail(const std::string& key, const std::string& complaint) const;

 private:
  std::string path(const std::string& key) const { return prefix_.empty() ? key : prefix_ + "." + key; }
  const ModelJson& get(const char* key);
  std::string_view whole(const std::string& text) const;
  void read_array(const char* key, std::size_t dimensions, Matrix& matrix);

  const ModelJson& object_;
  std::string source_, prefix_;
  const std::vector<std::string_view>& arrays_;
  std::vector<std::string> known_;
};

}  // namespace flies
