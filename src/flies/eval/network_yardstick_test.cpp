#include "flies/eval/network_yardstick.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "flies/io/temporary_folder.hpp"
#include "flies/io/test_data.hpp"

namespace flies {
namespace {

using ::testing::HasSubstr;

constexpr int kWidth_px = 320, kHeight_px = 240;
constexpr float kObjectness = 8.0F, kDarkness = -4.0F, kClass = 3.0F;

/// A network that calls each of 4 x 4 cells of the image a person 160 x 180 px large when the cell is white.
constexpr const char* kConfiguration = R"([net]
width=32
height=32
channels=3
[convolutional]
filters=6
size=8
stride=8
pad=0
activation=linear
[yolo]
mask=0
anchors=16,24
classes=1
num=1
)";

void write_network(const testing::TemporaryFolder& folder, float first_bias = 0.0F) {
  folder.write("cells.cfg", kConfiguration);
  std::ofstream file(folder.file("cells.weights"), std::ios::binary);
  const auto put = [&](const auto& value) { file.write(reinterpret_cast<const char*>(&value), sizeof(value)); };
  for (const std::int32_t version : {0, 2, 5}) put(version);
  put(std::uint64_t{0});  // images seen in training
  for (const float bias : {first_bias, 0.0F, 0.0F, 0.0F, kDarkness, kClass}) put(bias);
  constexpr int kWeights = 3 * 8 * 8;  // of one filter
  for (int filter = 0; filter < 6; ++filter)
    for (int i = 0; i < kWeights; ++i) put(filter == 4 ? (kObjectness - kDarkness) / kWeights : 0.0F);
}

StereoCamera camera() {
  return {.fx_px = 500,
          .fy_px = 500,
          .cx_px = kWidth_px / 2.0,
          .cx_right_px = kWidth_px / 2.0,
          .cy_px = kHeight_px / 2.0,
          .baseline_m = 0.5,
          .width_px = kWidth_px,
          .height_px = kHeight_px,
          .mount = {.height_m = 1.2}};
}

double logistic(double x) { return 1.0 / (1.0 + std::exp(-x)); }

TEST(NetworkYardstick, PutsAPersonWhereTheNetworkSaysWithItsProbability) {
  const testing::TemporaryFolder folder;
  write_network(folder);
  NetworkSearch search(folder.file("cells.weights"));
  std::vector<std::uint8_t> pixels(std::size_t{kWidth_px} * kHeight_px, 0);
  for (int v = 120; v < 180; ++v)  // the second cell of the third row
    for (int u = 80; u < 160; ++u) pixels[static_cast<std::size_t>(v * kWidth_px + u)] = 255;
  const auto found = search.detect({pixels.data(), kWidth_px, kHeight_px, kWidth_px}, camera(), 0.3);
  ASSERT_EQ(found.people.size(), 1U);
  const Pedestrian& person = found.people[0];
  EXPECT_NEAR(person.box.u_px, 120 - 80, 1);
  EXPECT_NEAR(person.box.v_px, 150 - 90, 1);
  EXPECT_NEAR(person.box.width_px, 160, 1);
  EXPECT_NEAR(person.box.height_px, 180, 1);
  EXPECT_NEAR(person.probability, logistic(kObjectness) * logistic(kClass), 0.01);
  EXPECT_NEAR(person.range_m, 500 * 1.7 / 180, 0.1);
  EXPECT_GT(found.time_ms, 0.0);
}

TEST(NetworkYardstick, FindsNobodyInTheDarkAndTheSurestOfThoseWhoOverlap) {
  const testing::TemporaryFolder folder;
  write_network(folder);
  const std::vector<std::uint8_t> black(std::size_t{kWidth_px} * kHeight_px, 0), white(black.size(), 255);
  const auto count = [&](const std::vector<std::uint8_t>& pixels, double max_overlap) {
    NetworkSearch search(folder.file("cells.weights"), {.max_overlap = max_overlap});
    return search.detect({pixels.data(), kWidth_px, kHeight_px, kWidth_px}, camera(), 0.3).people.size();
  };
  EXPECT_EQ(count(black, 0.5), 0U);
  EXPECT_EQ(count(white, 1.0), 16U);
  EXPECT_LT(count(white, 0.1), 16U);
  EXPECT_GT(count(white, 0.1), 0U);
}

TEST(NetworkYardstick, RefusesAClassThatTheNetworkDoesNotHave) {
  const testing::TemporaryFolder folder;
  write_network(folder);
  EXPECT_THAT(testing::error_of([&] { NetworkSearch(folder.file("cells.weights"), {.person_class = 14}); }),
              HasSubstr("cells.cfg: network.person_class: found 14, and the network has 1 classes"));
}

TEST(NetworkYardstick, RefusesWeightsThatAreNoNumbers) {
  const testing::TemporaryFolder folder;
  write_network(folder, std::nanf(""));
  EXPECT_THAT(testing::error_of([&] { NetworkSearch(folder.file("cells.weights")); }),
              HasSubstr("cells.weights: holds weights that are no finite numbers"));
}

TEST(NetworkYardstick, NamesTheFileThatIsMissingOrNoNetwork) {
  const testing::TemporaryFolder folder;
  write_network(folder);
  const auto error = [&](const std::string& name) {
    return testing::error_of([&] { NetworkSearch(folder.file(name)); });
  };
  EXPECT_THAT(error("cells.cfg"), HasSubstr("cells.cfg: is no file of weights"));
  EXPECT_THAT(error("absent.weights"), HasSubstr("absent.weights: is missing"));
  folder.write("alone.weights", "x");
  EXPECT_THAT(error("alone.weights"), HasSubstr("alone.cfg: is missing"));
  folder.write("alone.cfg", kConfiguration);
  EXPECT_THAT(error("alone.weights"), HasSubstr("alone.weights: is too short"));
  std::filesystem::copy_file(folder.file("cells.weights"), folder.file("alone.weights"),
                             std::filesystem::copy_options::overwrite_existing);
  std::filesystem::resize_file(folder.file("alone.weights"), 2000);
  EXPECT_THAT(error("alone.weights"), HasSubstr("alone.weights: has 2000 bytes, and the network in"));
  folder.write("alone.cfg", "[net]\nchannels=3\n");
  EXPECT_THAT(error("alone.weights"), HasSubstr("alone.cfg: width, height: are missing"));
  folder.write("alone.cfg", "[net]\nwidth=99999999999\nheight=32\n");
  EXPECT_THAT(error("alone.weights"), HasSubstr("alone.cfg: width: found 99999999999"));
  folder.write("alone.cfg", "[net]\nwidth=32\nheight=32\n[nonsense]\n");
  EXPECT_THAT(error("alone.weights"), HasSubstr("alone.weights: OpenCV cannot read this network"));
}

}  // namespace
}  // namespace flies
