#include "flies/classify/network_classifier.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>

#include "flies/core/error.hpp"

namespace flies {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

/// A Caffe network without weights: its numbers for a window are the means of its left and of its right half.
constexpr const char* kMeansOfHalves = R"(
input: "data"
input_dim: 1 input_dim: 1 input_dim: 8 input_dim: 4
layer { name: "mean" type: "Pooling" bottom: "data" top: "mean"
        pooling_param { pool: AVE kernel_h: 8 kernel_w: 2 stride_h: 8 stride_w: 2 } }
)";

/// The network's files, gone when the test is over.
class NetworkFiles {
 public:
  explicit NetworkFiles(const std::string& side, const std::string& layers = kMeansOfHalves)
      : folder_(fs::path(testing::TempDir()) /
                (std::string("flies-network-") + testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::create_directories(folder_);
    std::ofstream(folder_ / "net.prototxt") << layers;
    std::ofstream(folder_ / "net.yaml") << "# for the test\n" << side;
  }
  ~NetworkFiles() { fs::remove_all(folder_); }
  NetworkFiles(const NetworkFiles&) = delete;
  NetworkFiles& operator=(const NetworkFiles&) = delete;
  std::string path(const char* name = "net.prototxt") const { return (folder_ / name).string(); }

 private:
  fs::path folder_;
};

const std::string kSize = "input_width_px: 4\ninput_height_px: 8\n";

/// 20 x 30 px: black on the left of column 10, 200 from there on.
struct HalfLit {
  std::vector<std::uint8_t> pixels = std::vector<std::uint8_t>(20 * 30, 0);
  HalfLit() {
    for (std::size_t i = 0; i < pixels.size(); ++i)
      if (i % 20 >= 10) pixels[i] = 200;
  }
  GrayView view() const { return {pixels.data(), 20, 30, 20}; }
};

std::vector<double> classify(const std::string& side, const std::vector<ImageBox>& windows) {
  const NetworkFiles files(kSize + side);
  return people_classifier(files.path())->classify(HalfLit().view(), windows);
}

constexpr double kSinglePrecision = 1e-6;
constexpr ImageBox kAcrossTheEdge{6, 4, 8, 16}, kLit{11, 4, 8, 16};

TEST(NetworkClassifier, ReadsTheNumberThatSaysPerson) {
  const auto left = classify("person_index: 0", {kAcrossTheEdge, kLit});
  EXPECT_NEAR(left[0], 0.0, kSinglePrecision);
  EXPECT_NEAR(left[1], 200.0 / 255.0, kSinglePrecision);
  const auto right = classify("person_index: 1", {kAcrossTheEdge, kLit});
  EXPECT_NEAR(right[0], 200.0 / 255.0, kSinglePrecision);
}

TEST(NetworkClassifier, SubtractsTheMeanBeforeItScales) {
  EXPECT_NEAR(classify("mean: 100\nscale: 0.005", {kLit})[0], 0.5, kSinglePrecision);
}

TEST(NetworkClassifier, UnderstandsLogitsAndSoftmax) {
  EXPECT_NEAR(classify("output: logit\nscale: 0.01", {kLit})[0], 1.0 / (1.0 + std::exp(-2.0)), kSinglePrecision);
  EXPECT_NEAR(classify("output: softmax\nscale: 0.01\nperson_index: 1", {kAcrossTheEdge})[0],
              std::exp(2.0) / (1.0 + std::exp(2.0)), kSinglePrecision);
}

TEST(NetworkClassifier, GivesEveryWindowOfManyBatchesItsOwn) {
  std::vector<ImageBox> windows(150, kAcrossTheEdge);
  windows[0] = windows[70] = windows[149] = kLit;
  windows[71] = {100, 100, 8, 16};  // outside the image
  const auto probabilities = classify("person_index: 0", windows);
  for (std::size_t i = 0; i < windows.size(); ++i)
    EXPECT_NEAR(probabilities[i], i == 0 || i == 70 || i == 149 ? 200.0 / 255.0 : 0.0, kSinglePrecision) << i;
}

TEST(NetworkClassifier, HasTheThresholdOfItsSideFile) {
  const NetworkFiles files(kSize + "threshold: 0.25");
  const auto classifier = people_classifier(files.path());
  EXPECT_DOUBLE_EQ(classifier->threshold(), 0.25);
  EXPECT_DOUBLE_EQ(classifier->screen_threshold(), 0.25);
}

std::string error_of(const std::string& path) {
  try {
    people_classifier(path);
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::Not(HasSubstr("\n")));
    return error.what();
  }
  return {};
}

TEST(NetworkClassifier, SaysWhatIsWrong) {
  const NetworkFiles good(kSize);
  EXPECT_EQ(error_of(good.path()), "");
  EXPECT_THAT(error_of(good.path("gone.onnx")), HasSubstr("no such network file"));
  std::ofstream(good.path("damaged.onnx")) << "this is no network";
  std::ofstream(good.path("damaged.yaml")) << kSize;
  EXPECT_THAT(error_of(good.path("damaged.onnx")), HasSubstr("damaged.onnx: OpenCV cannot read this network"));
  std::ofstream(good.path("lone.cfg")) << "[net]\n";
  std::ofstream(good.path("lone.yaml")) << kSize;
  EXPECT_THAT(error_of(good.path("lone.cfg")), HasSubstr("expected lone.weights beside it"));
  fs::remove(good.path("net.yaml"));
  EXPECT_THAT(error_of(good.path()),
              AllOf(HasSubstr("net.prototxt: expected net.yaml beside it, which describes the input and output"),
                    HasSubstr("may be empty")));
}

TEST(NetworkClassifier, TakesTheDefaultsOfAnEmptySideFile) {
  const NetworkFiles files("", R"(
input: "data"
input_dim: 1 input_dim: 1 input_dim: 96 input_dim: 48
layer { name: "lightest" type: "Pooling" bottom: "data" top: "lightest"
        pooling_param { pool: MAX kernel_h: 96 kernel_w: 48 } }
)");
  std::ofstream(files.path("net.yaml")).close();
  EXPECT_NEAR(people_classifier(files.path())->classify(HalfLit().view(), std::vector{kLit})[0], 200.0 / 255.0,
              kSinglePrecision);
}

/// A network of Darknet that sums up what it sees, with this weight for every pixel.
void write_darknet(const NetworkFiles& files, float weight) {
  std::ofstream(files.path("sum.cfg")) << "[net]\nwidth=4\nheight=8\nchannels=1\n[convolutional]\nfilters=1\nsize=4\n"
                                          "stride=4\npad=0\nactivation=linear\n[avgpool]\n";
  std::ofstream(files.path("sum.yaml")) << kSize;
  std::ofstream file(files.path("sum.weights"), std::ios::binary);
  const auto put = [&](const auto& value) { file.write(reinterpret_cast<const char*>(&value), sizeof(value)); };
  for (const std::int32_t version : {0, 2, 5}) put(version);
  put(std::uint64_t{0});  // images seen in training
  put(0.0F);              // bias
  for (int i = 0; i < 16; ++i) put(weight);
}

TEST(NetworkClassifier, RefusesWeightsThatAreCutShortOrNoNumbers) {
  const NetworkFiles files(kSize);
  write_darknet(files, 1.0F / 16.0F);
  EXPECT_NEAR(people_classifier(files.path("sum.cfg"))->classify(HalfLit().view(), std::vector{kLit})[0], 200.0 / 255.0,
              kSinglePrecision);
  fs::resize_file(files.path("sum.weights"), 48);
  EXPECT_THAT(error_of(files.path("sum.cfg")), HasSubstr("sum.weights: has 48 bytes, and the network in"));
  write_darknet(files, std::nanf(""));
  EXPECT_THAT(error_of(files.path("sum.cfg")), HasSubstr("sum.weights: holds weights that are no finite numbers"));
}

TEST(NetworkClassifier, RefusesNumbersThatAreNotFinite) {
  // 200 grey levels times this are beyond what single precision holds; nothing of a black picture is.
  const NetworkFiles files(kSize + "scale: 1e6", R"(
input: "data"
input_dim: 1 input_dim: 1 input_dim: 8 input_dim: 4
layer { name: "far" type: "Power" bottom: "data" top: "far" power_param { power: 9 scale: 1 shift: 0 } }
layer { name: "mean" type: "Pooling" bottom: "far" top: "mean"
        pooling_param { pool: AVE kernel_h: 8 kernel_w: 4 } }
)");
  const auto classifier = people_classifier(files.path());
  EXPECT_THROW(
      {
        try {
          classifier->classify(HalfLit().view(), std::vector{kLit});
        } catch (const InputError& error) {
          EXPECT_THAT(error.what(), HasSubstr("net.prototxt: gives numbers for a window that are not finite"));
          throw;
        }
      },
      InputError);
}

TEST(NetworkClassifier, KeepsTheLogOfOpenCvToItself) {
  const NetworkFiles files(kSize);
  write_darknet(files, 1.0F);
  std::ofstream(files.path("sum.yaml")) << kSize << "channels: 3\n";
  testing::internal::CaptureStderr();
  EXPECT_THAT(error_of(files.path("sum.cfg")), HasSubstr("with 3 channels"));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(NetworkClassifier, ChecksItsSideFile) {
  EXPECT_THAT(error_of(NetworkFiles(kSize + "person_index: 2").path()), HasSubstr("person_index: found 2"));
  EXPECT_THAT(error_of(NetworkFiles(kSize + "person_indx: 1").path()), HasSubstr("person_index"));
  EXPECT_THAT(error_of(NetworkFiles(kSize + "threshold: 2").path()), HasSubstr("threshold"));
}

}  // namespace
}  // namespace flies
