#include "flies/classify/people_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <regex>

#include "flies/core/error.hpp"

namespace flies {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// A file that is gone when the test is over.
class ModelFile {
 public:
  explicit ModelFile(const std::string& text)
      : path_(std::filesystem::path(testing::TempDir()) /
              (std::string("flies-model-") + testing::UnitTest::GetInstance()->current_test_info()->name() + ".yaml")) {
    std::ofstream(path_) << text;
  }
  ~ModelFile() { std::filesystem::remove(path_); }
  ModelFile(const ModelFile&) = delete;
  ModelFile& operator=(const ModelFile&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// The smallest model there is: one block of one cell.
PeopleModel tiny_model() {
  PeopleModel model;
  model.name = "tiny: \"quoted\"";
  model.window_width_px = model.block_px = model.stride_px = model.cell_px = 8;
  model.window_height_px = 16;
  model.bins = 3;
  model.gamma = false;
  model.weights = {0.1F, -1e-20F, 3.25F, 1.0F / 3.0F, 0.0F, 12345.678F};
  model.bias = -1.0 / 3.0;
  model.threshold = 0.1;
  return model;
}

std::string replaced(const std::string& text, const std::string& pattern, const std::string& by) {
  std::string result = std::regex_replace(text, std::regex(pattern), by);
  EXPECT_NE(result, text) << pattern << " is not in the model file";
  return result;
}

std::string error_of(const std::string& text) {
  const ModelFile file(text);
  try {
    load_people_model(file.path());
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr(file.path().filename().string()));
    EXPECT_THAT(error.what(), Not(HasSubstr("\n")));
    return error.what();
  }
  ADD_FAILURE() << "accepted: " << text;
  return {};
}

void expect_equal(const PeopleModel& a, const PeopleModel& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.window_width_px, b.window_width_px);
  EXPECT_EQ(a.window_height_px, b.window_height_px);
  EXPECT_EQ(a.block_px, b.block_px);
  EXPECT_EQ(a.stride_px, b.stride_px);
  EXPECT_EQ(a.cell_px, b.cell_px);
  EXPECT_EQ(a.bins, b.bins);
  EXPECT_EQ(a.gamma, b.gamma);
  EXPECT_EQ(a.weights, b.weights);
  EXPECT_EQ(a.bias, b.bias);
  EXPECT_EQ(a.threshold, b.threshold);
}

TEST(PeopleModel, NamedModelsAreConsistent) {
  EXPECT_NO_THROW(check_people_model(builtin_people_model(), "built-in"));
  EXPECT_EQ(people_model("opencv-48x96").weights.size(), 1980U);
  EXPECT_EQ(people_model("opencv-64x128").weights.size(), 3780U);
  EXPECT_NO_THROW(check_people_model(people_model("opencv-64x128"), "64x128"));
}

TEST(PeopleModel, UnknownNameListsTheKnownOnes) {
  try {
    people_model("opencv-32x64");
    FAIL() << "accepted an unknown name";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("opencv-32x64"), HasSubstr("opencv-48x96"), HasSubstr("opencv-64x128")));
  }
}

TEST(PeopleModel, ReadsBackWhatItWrites) {
  for (const PeopleModel& model : {tiny_model(), builtin_people_model(), people_model("opencv-64x128")}) {
    const ModelFile file(people_model_yaml(model));
    expect_equal(load_people_model(file.path()), model);
    expect_equal(people_model(file.path().string()), model);
  }
}

TEST(LoadPeopleModel, NamesFileAndFieldOfWhatIsWrong) {
  const std::string good = people_model_yaml(tiny_model());
  struct Case {
    std::string text, field, complaint;
  };
  const std::vector<Case> cases = {
      {"", "", "expected a YAML map"},
      {"just text", "", "expected a YAML map"},
      {"- 1\n- 2\n", "", "expected a YAML map"},
      {"a: [1, 2\nb: 3", "line", "not a YAML file"},
      {replaced(good, "bias: .*\n", ""), "bias", "missing"},
      {replaced(good, "weights: [^\\]]*\\]", ""), "weights", "missing"},
      {good + "colour: red\n", "colour", "unknown key"},
      {replaced(good, "bins: 3", "bins: three"), "bins", "found 'three', expected a whole number"},
      {replaced(good, "bins: 3", "bins: 2.5"), "bins", "expected a whole number"},
      {replaced(good, "bins: 3", "bins: [3]"), "bins", "expected a whole number"},
      {replaced(good, "bins: 3", "bins: 4"), "weights", "found 6 numbers, expected 8"},
      {replaced(good, "bins: 3", "bins: 0"), "bins", "found 0"},
      {replaced(good, "gamma: false", "gamma: maybe"), "gamma", "expected true or false"},
      {replaced(good, "weights: \\[", "weights: [1, "), "weights", "found 7 numbers, expected 6"},
      {replaced(good, "weights: \\[[^,]*", "weights: [.nan"), "weights[0]", "found nan"},
      {replaced(good, "weights: \\[[^,]*", "weights: [.inf"), "weights[0]", "found inf"},
      {replaced(good, "weights: \\[[^,]*", "weights: [1e300"), "weights[0]", "expected a finite number"},
      {replaced(good, "weights: \\[[^,]*", "weights: [big"), "weights[0]", "found 'big', expected a number"},
      {replaced(good, "weights: [^\\]]*\\]", "weights: 5"), "weights", "expected a list of numbers"},
      {replaced(good, "bias: [^\n]*", "bias: .nan"), "bias", "found nan"},
      {replaced(good, "threshold: [^\n]*", "threshold: .inf"), "threshold", "found inf"},
      {replaced(good, "cell_px: 8", "cell_px: 0"), "cell_px", "found 0"},
      {replaced(good, "cell_px: 8", "cell_px: 3"), "cell_px", "divisor of block_px"},
      {replaced(good, "stride_px: 8", "stride_px: 5"), "stride_px", "tiles the window"},
      {replaced(good, "block_px: 8", "block_px: 9"), "block_px", "1 to 8"},
      {replaced(good, "window_width_px: 8", "window_width_px: 9"), "window_width_px", "half of window_height_px"},
      {replaced(good, "window_height_px: 16", "window_height_px: -16"), "window_height_px", "8 to 1024"},
      {replaced(good, "window_height_px: 16", "window_height_px: 99999999999"), "window_height_px", "whole number"},
  };
  for (const Case& bad : cases) EXPECT_THAT(error_of(bad.text), AllOf(HasSubstr(bad.field), HasSubstr(bad.complaint)));
}

TEST(LoadPeopleModel, RejectsFoldersAndMissingFiles) {
  EXPECT_THROW(load_people_model(testing::TempDir()), InputError);
  EXPECT_THROW(load_people_model("no/such/model.yaml"), InputError);
}

}  // namespace
}  // namespace flies
