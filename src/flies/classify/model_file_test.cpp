#include "flies/classify/model_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>

#include "flies/classify/named_models.hpp"
#include "flies/core/base64.hpp"
#include "flies/core/error.hpp"

namespace flies {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// The smallest model with everything: two blocks of one cell, and a second stage of two support vectors.
PeopleModel tiny_model() {
  PeopleModel model;
  model.name = "tiny: \"quoted\"";
  model.hog.window_width_px = model.hog.block_px = model.hog.stride_px = model.hog.cell_px = 8;
  model.hog.window_height_px = 16;
  model.hog.bins = 3;
  model.hog.gamma = false;
  model.linear.weights = {0.1F, -1e-20F, 3.25F, 1.0F / 3.0F, 0.0F, 12345.678F};
  model.linear.bias = -1.0 / 3.0;
  model.linear.calibration = {1.5, -0.1};
  model.linear.reject_below = -0.7;
  KernelStage kernel;
  kernel.mean = {0.5F, 0.25F, 0.0F, -1.0F, 2.0F, 0.125F};
  kernel.projection = {1, 6, {0.5F, 0.0F, 0.0F, 1.0F, -2.0F, 0.0F}};
  kernel.support_vectors = {2, 1, {0.1F, 0.2F}};
  kernel.coefficients = {1.0F, -0.3F};
  kernel.gamma = 0.05;
  kernel.bias = 0.01;
  kernel.calibration = {2.0, 0.2};
  model.kernel = kernel;
  model.threshold = 0.625;
  model.about = {{"training data", "none"}, {"a first key", "keeps its place"}};
  return model;
}

/// Two layers for the windows that convolutions see.
PeopleModel convolution_model() {
  PeopleModel model;
  model.name = "convolutions";
  model.linear.weights.assign(feature_count(model.hog), 0.25F);
  model.linear.reject_below = -2.0;
  ConvolutionStage stage;
  stage.layers.push_back({2, {2, 9, std::vector<float>(18, 0.5F)}, {0.1F, -0.2F}, 3.5});
  stage.layers.push_back({1, {1, 18, std::vector<float>(18, -0.125F)}, {0.75F}, 7.0});
  stage.last.assign(std::size_t{24} * 48, 0.0625F);
  stage.bias = -0.3;
  stage.linear_weight = 0.4;
  stage.calibration = {1.25, -0.5};
  model.convolution = std::move(stage);
  return model;
}

/// The same behind a network that looks before all else.
PeopleModel network_model() {
  PeopleModel model = convolution_model();
  model.name = "networks";
  FirstNetwork network;
  network.layers.push_back({2, {2, 9, std::vector<float>(18, 0.5F)}, {}, 350.0});
  network.layers.push_back({2, {1, 18, std::vector<float>(18, -0.125F)}, {}, 70.0});
  network.last.assign(std::size_t{4} * 9, 0.0625F);
  network.bias = -0.3;
  network.reject_below = -1.5;
  model.first_network = std::move(network);
  return model;
}

void expect_equal(const Matrix& a, const Matrix& b) {
  EXPECT_EQ(a.rows, b.rows);
  EXPECT_EQ(a.columns, b.columns);
  EXPECT_EQ(a.values, b.values);
}

void expect_equal(const ScoreCalibration& a, const ScoreCalibration& b) {
  EXPECT_EQ(a.slope, b.slope);
  EXPECT_EQ(a.offset, b.offset);
}

void expect_equal(const PeopleModel& a, const PeopleModel& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.hog, b.hog);
  EXPECT_EQ(a.linear.weights, b.linear.weights);
  EXPECT_EQ(a.linear.bias, b.linear.bias);
  expect_equal(a.linear.calibration, b.linear.calibration);
  EXPECT_EQ(a.linear.reject_below, b.linear.reject_below);
  EXPECT_EQ(a.threshold, b.threshold);
  EXPECT_EQ(a.about, b.about);
  ASSERT_EQ(a.kernel.has_value(), b.kernel.has_value());
  if (!a.kernel) return;
  EXPECT_EQ(a.kernel->mean, b.kernel->mean);
  expect_equal(a.kernel->projection, b.kernel->projection);
  expect_equal(a.kernel->support_vectors, b.kernel->support_vectors);
  EXPECT_EQ(a.kernel->coefficients, b.kernel->coefficients);
  EXPECT_EQ(a.kernel->gamma, b.kernel->gamma);
  EXPECT_EQ(a.kernel->bias, b.kernel->bias);
  expect_equal(a.kernel->calibration, b.kernel->calibration);
}

void expect_equal(const std::vector<ConvolutionLayer>& a, const std::vector<ConvolutionLayer>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].stride, b[i].stride);
    expect_equal(a[i].weights, b[i].weights);
    EXPECT_EQ(a[i].biases, b[i].biases);
    EXPECT_EQ(a[i].largest, b[i].largest);
  }
}

std::string complaint_about(const PeopleModel& model) {
  try {
    check_people_model(model, "model.json");
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(ModelFile, KeepsTheNetworkThatLooksFirst) {
  PeopleModel written = network_model();
  for (const bool is_alone : {false, true}) {
    if (is_alone) written.convolution.reset();
    const PeopleModel read = parse_people_model(people_model_text(written), "model.json");
    ASSERT_TRUE(read.first_network.has_value());
    EXPECT_EQ(read.convolution.has_value(), !is_alone);
    const FirstNetwork &a = *written.first_network, &b = *read.first_network;
    expect_equal(a.layers, b.layers);
    EXPECT_EQ(b.last, a.last);
    EXPECT_EQ(b.bias, a.bias);
    EXPECT_EQ(b.reject_below, a.reject_below);
    EXPECT_EQ(people_model_text(read), people_model_text(written));
  }
}

TEST(ModelFile, RefusesFirstNetworksThatDoNotFitByName) {
  const auto error_with = [](const auto& change) {
    PeopleModel model = network_model();
    change(*model.first_network);
    return complaint_about(model);
  };
  EXPECT_EQ(error_with([](FirstNetwork&) {}), "");
  EXPECT_THAT(error_with([](FirstNetwork& n) { n.layers.clear(); }), HasSubstr("first_network.layers"));
  EXPECT_THAT(error_with([](FirstNetwork& n) { n.layers[1].biases = {0.0F}; }),
              HasSubstr("first_network.layer_2.biases"));
  EXPECT_THAT(error_with([](FirstNetwork& n) { n.last.pop_back(); }), HasSubstr("first_network.last"));
  EXPECT_THAT(error_with([](FirstNetwork& n) { n.reject_below = -1.0 / 0.0; }),
              HasSubstr("first_network.reject_below"));
  EXPECT_THAT(error_with([](FirstNetwork& n) { n.layers.assign(5, n.layers[0]); }),
              HasSubstr("first_network.layer_2.weights"));
}

TEST(ModelFile, RefusesFirstNetworksThatShrinkTheirPicturesTooFar) {
  PeopleModel model = network_model();
  auto& network = *model.first_network;
  for (int i = 0; i < 2; ++i) network.layers.push_back({2, {1, 9, std::vector<float>(9)}, {}, 1.0});
  EXPECT_THAT(complaint_about(model), HasSubstr("first_network.layer_4: gets 1 x 4 px"));
  network.layers.pop_back();
  network.last.assign(4, 0.5F);
  EXPECT_THAT(complaint_about(model), HasSubstr("has a stride of 8 px over all layers"));
}

TEST(ModelFile, KeepsConvolutions) {
  const PeopleModel written = convolution_model();
  const PeopleModel read = parse_people_model(people_model_text(written), "model.json");
  ASSERT_TRUE(read.convolution.has_value());
  const ConvolutionStage &a = *written.convolution, &b = *read.convolution;
  EXPECT_EQ(read.linear.reject_below, written.linear.reject_below);
  expect_equal(b.layers, a.layers);
  EXPECT_EQ(b.last, a.last);
  EXPECT_EQ(b.bias, a.bias);
  EXPECT_EQ(b.linear_weight, a.linear_weight);
  expect_equal(b.calibration, a.calibration);
}

TEST(ModelFile, RefusesConvolutionsThatDoNotFitByName) {
  const auto error_with = [](const auto& change) {
    PeopleModel model = convolution_model();
    change(model);
    return complaint_about(model);
  };
  EXPECT_EQ(error_with([](PeopleModel&) {}), "");
  EXPECT_THAT(error_with([](PeopleModel& m) { m.convolution->layers.clear(); }), HasSubstr("convolution.layers"));
  EXPECT_THAT(error_with([](PeopleModel& m) { m.convolution->layers[1].stride = 3; }),
              HasSubstr("convolution.layer_2.stride"));
  EXPECT_THAT(error_with([](PeopleModel& m) {
                m.convolution->layers[1].weights = {1, 9, std::vector<float>(9)};
              }),
              HasSubstr("convolution.layer_2.weights"));
  EXPECT_THAT(error_with([](PeopleModel& m) { m.convolution->layers[0].biases.pop_back(); }),
              HasSubstr("convolution.layer_1.biases"));
  EXPECT_THAT(error_with([](PeopleModel& m) { m.convolution->layers[0].largest = 0.0; }),
              HasSubstr("convolution.layer_1.largest"));
  EXPECT_THAT(error_with([](PeopleModel& m) { m.convolution->last.pop_back(); }), HasSubstr("convolution.last"));
}

TEST(ModelFile, TakesConvolutionsBehindWindowsOfAnotherSize) {
  PeopleModel model = convolution_model();
  model.hog.window_width_px = 32;
  model.hog.window_height_px = 64;
  model.linear.weights.assign(feature_count(model.hog), 0.25F);
  check_people_model(model, "model.json");
  EXPECT_EQ(parse_people_model(people_model_text(model), "model.json").hog.window_height_px, 64);
}

std::string error_of(const std::string& text) {
  try {
    parse_people_model(text, "model.json");
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("model.json"), Not(HasSubstr("\n"))));
    return error.what();
  }
  ADD_FAILURE() << "accepted: " << text;
  return {};
}

TEST(PeopleModelText, ReadsBackToTheSameModelAndTheSameBytes) {
  PeopleModel without_kernel = tiny_model();
  without_kernel.kernel.reset();
  without_kernel.linear.reject_below = LinearStage{}.reject_below;
  PeopleModel without_projection = tiny_model();
  without_projection.kernel->projection = {};
  without_projection.kernel->support_vectors = {1, 6, {1, 2, 3, 4, 5, 6}};
  without_projection.kernel->coefficients = {1.0F};
  for (const PeopleModel& model : {tiny_model(), without_kernel, without_projection, opencv_48x96(), opencv_64x128()}) {
    const std::string text = people_model_text(model);
    const PeopleModel read = parse_people_model(text, "text");
    expect_equal(read, model);
    EXPECT_EQ(people_model_text(read), text);
  }
}

TEST(PeopleModelText, TakesHalfTheSpaceWhereThatLosesNothing) {
  PeopleModel model = opencv_48x96();
  const std::size_t exact_bytes = people_model_text(model).size();
  round_to_half(model.linear.weights);
  const std::string text = people_model_text(model);
  EXPECT_LT(text.size(), exact_bytes * 6 / 10);
  expect_equal(parse_people_model(text, "text"), model);
}

TEST(WritePeopleModel, IsReadByItsPath) {
  const std::string path = (std::filesystem::path(testing::TempDir()) / "flies-tiny-model.json").string();
  write_people_model(path, tiny_model());
  expect_equal(people_model(path), tiny_model());
  std::filesystem::remove(path);
}

TEST(ReadPeopleModel, RefusesFoldersAndMissingFiles) {
  EXPECT_THROW(read_people_model(testing::TempDir()), InputError);
  EXPECT_THROW(read_people_model("no/such/model.json"), InputError);
}

/// `text` with the first `from`, which must be there, turned into `to`.
std::string edited(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);  // throws when it is not there
}

TEST(ParsePeopleModel, RefusesAFileThatWasCutOrEdited) {
  const std::string good = people_model_text(tiny_model());
  EXPECT_THAT(error_of(good.substr(0, good.size() / 2)), HasSubstr("expected JSON"));
  EXPECT_THAT(error_of(edited(good, "\"threshold\": 0.625", "\"threshold\": 0.5")),
              AllOf(HasSubstr("checksum"), HasSubstr("cut or changed")));
  EXPECT_THAT(error_of(edited(good, "\n \"name\"", "\n\n \"name\"")), HasSubstr("checksum"));
}

/// Changes one place of the model by a JSON pointer; the checksum no longer matters, for errors come before it.
std::string with(const char* place, const nlohmann::ordered_json& value) {
  auto json = nlohmann::ordered_json::parse(people_model_text(tiny_model()));
  const nlohmann::ordered_json::json_pointer pointer(place);
  if (value.is_discarded())
    json.at(pointer.parent_pointer()).erase(pointer.back());
  else
    json[pointer] = value;
  return json.dump();
}

TEST(ParsePeopleModel, NamesTheFieldThatIsWrong) {
  const nlohmann::ordered_json gone(nlohmann::ordered_json::value_t::discarded);
  struct Case {
    std::string text, field, complaint;
  };
  const std::vector<Case> cases = {
      {"just text", "byte 1", "expected JSON"},
      {"[1, 2]", "", "expected an object"},
      {with("/format", "a cake"), "format", "found 'a cake', expected 'flies people model'"},
      {with("/version", 2), "version", "found 2, expected 1"},
      {with("/checksum", gone), "checksum", "missing"},
      {with("/linear/bias", gone), "linear.bias", "missing"},
      {with("/linear", gone), "linear", "missing"},
      {with("/linear", 5), "linear", "expected an object"},
      {with("/kernel/gamma", gone), "kernel.gamma", "missing"},
      {with("/colour", "red"), "colour", "unknown key"},
      {with("/hog/colour", "red"), "hog.colour", "unknown key"},
      {with("/about/colour", 5), "about.colour", "expected a text"},
      {with("/hog/bins", "three"), "hog.bins", "expected a whole number"},
      {with("/hog/bins", 2.5), "hog.bins", "expected a whole number"},
      {with("/hog/bins", 99999999999), "hog.bins", "expected a whole number"},
      {with("/hog/gamma", "maybe"), "hog.gamma", "expected true or false"},
      {with("/linear/bias", "big"), "linear.bias", "expected a number"},
      {with("/linear/weights/shape", {1, 2}), "linear.weights.shape", "expected a list of 1 whole numbers"},
      {with("/linear/weights/shape", {-6}), "linear.weights.shape", "expected whole numbers"},
      {with("/linear/weights/shape", {7}), "linear.weights.base64", "holds 24 bytes, expected 28"},
      {with("/linear/weights/type", "float8"), "linear.weights.type", "found 'float8', expected float16 or float32"},
      {with("/linear/weights/base64", "?"), "linear.weights.base64", "is not base64"}};
  for (const Case& bad : cases) EXPECT_THAT(error_of(bad.text), AllOf(HasSubstr(bad.field), HasSubstr(bad.complaint)));
}

TEST(ParsePeopleModel, RefusesNumbersThatOverflowAndEndlessKeys) {
  EXPECT_THAT(error_of("{\"a\":1e999}"), HasSubstr("not finite"));
  std::string keys = "{";
  for (int i = 0; i < 100'000; ++i) keys += "\"k" + std::to_string(i) + "\":0,";
  EXPECT_THAT(error_of(keys + "\"k\":0}"), HasSubstr("beside its numbers"));
}

TEST(PeopleModelText, RefusesModelsThatAreInconsistent) {
  const auto complaint = [](const auto& spoil) -> std::string {
    PeopleModel model = tiny_model();
    spoil(model);
    try {
      people_model_text(model);
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  };
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(complaint([](PeopleModel&) {}), "");
  EXPECT_THAT(complaint([](PeopleModel& m) { m.hog.bins = 4; }),
              HasSubstr("linear.weights: found 6 numbers, expected 8"));
  EXPECT_THAT(complaint([](PeopleModel& m) { m.linear.weights[2] = kInfinity; }),
              HasSubstr("linear.weights[2]: found inf"));
  EXPECT_THAT(complaint([](PeopleModel& m) { m.linear.bias = kInfinity; }), HasSubstr("linear.bias"));
  EXPECT_THAT(complaint([](PeopleModel& m) { m.linear.calibration.slope = 0; }), HasSubstr("linear.calibration.slope"));
  EXPECT_THAT(complaint([](PeopleModel& m) { m.linear.reject_below = -kInfinity; }), HasSubstr("linear.reject_below"));
  EXPECT_THAT(complaint([](PeopleModel& m) { m.threshold = 1.5; }), HasSubstr("threshold: found 1.5, expected 0 to 1"));
  EXPECT_THAT(complaint([](PeopleModel& m) { m.kernel->mean.pop_back(); }), HasSubstr("kernel.mean"));
  EXPECT_THAT(complaint([](PeopleModel& m) { m.kernel->projection.columns = 5; }), HasSubstr("kernel.projection"));
  EXPECT_THAT(complaint([](PeopleModel& m) { m.kernel->support_vectors.columns = 2; }),
              HasSubstr("kernel.support_vectors"));
  EXPECT_THAT(complaint([](PeopleModel& m) { m.kernel->coefficients.pop_back(); }), HasSubstr("kernel.coefficients"));
  EXPECT_THAT(complaint([](PeopleModel& m) { m.kernel->gamma = -1; }), HasSubstr("kernel.gamma"));
}

TEST(PeopleModelText, RefusesTextsThatAreNotUtf8) {
  const auto complaint = [](const std::function<void(PeopleModel&)>& spoil) {
    PeopleModel model = tiny_model();
    spoil(model);
    try {
      people_model_text(model);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(complaint([](PeopleModel& m) { m.name = "M\xFCller"; }), HasSubstr("name: is not UTF-8"));
  EXPECT_THAT(complaint([](PeopleModel& m) { m.about = {{"licence", "\xA9"}}; }), HasSubstr("about.licence: is not"));
  EXPECT_EQ(complaint([](PeopleModel& m) { m.name = "M\xC3\xBCller"; }), "no error");
}

TEST(Base64, IsThatOfRfc4648) {
  // Section 10 of the RFC.
  const std::vector<std::pair<std::string, std::string>> vectors{{"", ""},
                                                                 {"f", "Zg=="},
                                                                 {"fo", "Zm8="},
                                                                 {"foo", "Zm9v"},
                                                                 {"foob", "Zm9vYg=="},
                                                                 {"fooba", "Zm9vYmE="},
                                                                 {"foobar", "Zm9vYmFy"}};
  for (const auto& [bytes, text] : vectors) {
    EXPECT_EQ(to_base64(bytes), text);
    EXPECT_EQ(from_base64(text), bytes);
  }
  for (const char* bad : {"Zg=", "Zg", "Z===", "Zg==Zg==", "Zm9*", "Zm 9"})
    EXPECT_EQ(from_base64(bad), std::nullopt) << bad;
  const std::string all_bytes = [] {
    std::string bytes;
    for (int i = 0; i < 256; ++i) bytes += static_cast<char>(i);
    return bytes;
  }();
  EXPECT_EQ(from_base64(to_base64(all_bytes)), all_bytes);
}

}  // namespace
}  // namespace flies
