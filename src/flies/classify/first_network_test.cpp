#include "flies/classify/first_network.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "flies/classify/resample.hpp"

namespace flies {
namespace {

/// Two layers with random kernels, those of the first of sum zero.
FirstNetwork example_network() {
  std::mt19937 random(3);
  std::normal_distribution<float> weight(0.0F, 0.3F);
  const auto numbers = [&](std::size_t count) {
    std::vector<float> values(count);
    for (float& value : values) value = weight(random);
    return values;
  };
  FirstNetwork network;
  network.layers.push_back({2, {5, 9, numbers(45)}, {}, 300.0});
  for (auto kernel = network.layers[0].weights.values.begin(); kernel != network.layers[0].weights.values.end();
       kernel += 9) {
    float sum = 0.0F;
    for (auto value = kernel; value != kernel + 9; ++value) sum += *value;
    for (auto value = kernel; value != kernel + 9; ++value) *value -= sum / 9.0F;
  }
  network.layers.push_back({2, {3, 45, numbers(135)}, {}, 600.0});
  network.last = numbers(std::size_t{4} * 9 * 3);
  network.bias = 0.5;
  return network;
}

struct Picture {
  int width_px, height_px;
  std::vector<std::uint8_t> pixels;

  Picture(int width, int height, std::uint32_t seed)
      : width_px(width), height_px(height), pixels(static_cast<std::size_t>(width * height)) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> level(40, 120);
    for (auto& pixel : pixels) pixel = static_cast<std::uint8_t>(level(random));
  }
  GrayView view() const { return {pixels.data(), width_px, height_px, width_px}; }
};

double score_alone(const FirstNetworkMachine& machine, const GrayView& image, const ImageBox& window) {
  const auto sets = window_sets({&window, 1}, image, machine.raster());
  return machine.scores(image, sets.at(0)).at(0);
}

// The last layer is rounded to steps of 600 / 4095, and has the error of 45 rounded inputs: a standard deviation of
// some 0.1, which 108 weights of 0.3 and a contrast of 23 make a hundredth.
constexpr double kRounding = 0.05;

TEST(FirstNetwork, ScoresAsItIsDefined) {
  const FirstNetwork network = example_network();
  const FirstNetworkMachine machine(network);
  double lowest = 1e9, highest = -1e9;
  for (std::uint32_t seed = 0; seed < 6; ++seed) {
    const Picture picture(60, 100, seed);
    const ImageBox window{8.5, 3.25, 30.0 + seed, 60.0 + 2.0 * seed};
    const FloatImage levels = resample(picture.view(), window, kFirstNetworkWidth_px, kFirstNetworkHeight_px);
    const double score = first_network_score(network, levels.values);
    EXPECT_NEAR(score_alone(machine, picture.view(), window), score, kRounding);
    lowest = std::min(lowest, score);
    highest = std::max(highest, score);
  }
  EXPECT_GT(highest - lowest, 10.0 * kRounding) << "the example should tell windows apart";
}

TEST(FirstNetwork, SeesWindowsOfAStripAsItSeesThemAlone) {
  const FirstNetworkMachine machine(example_network());
  const Picture picture(300, 200, 1);
  std::vector<ImageBox> windows;
  for (const int down : {0, 1, 2})
    for (const int right : {0, 1, 5, 9}) windows.push_back({20.0 + 8.0 * right, 30.0 + 8.0 * down, 40.0, 80.0});
  const auto sets = window_sets(windows, picture.view(), machine.raster());
  ASSERT_EQ(sets.size(), 1U);
  const auto scores = machine.scores(picture.view(), sets[0]);
  ASSERT_EQ(scores.size(), windows.size());
  for (std::size_t i = 0; i < windows.size(); ++i)
    EXPECT_NEAR(scores[i], score_alone(machine, picture.view(), windows[i]), 1e-9) << i;
  EXPECT_GT(*std::ranges::max_element(scores) - *std::ranges::min_element(scores), 0.1);
}

TEST(FirstNetwork, DoesNotHangOnBrightnessAndContrast) {
  const FirstNetworkMachine machine(example_network());
  Picture picture(60, 100, 2);
  const ImageBox window{5.0, 4.0, 40.0, 80.0};
  const double before = score_alone(machine, picture.view(), window);
  for (auto& pixel : picture.pixels) pixel = static_cast<std::uint8_t>(2 * pixel - 30);
  EXPECT_NEAR(score_alone(machine, picture.view(), window), before, kRounding);
}

TEST(FirstNetwork, FindsNothingInAFlatWindow) {
  const FirstNetwork network = example_network();
  Picture picture(60, 100, 2);
  std::ranges::fill(picture.pixels, std::uint8_t{255});
  EXPECT_NEAR(score_alone(FirstNetworkMachine(network), picture.view(), {5.0, 4.0, 40.0, 80.0}), network.bias,
              kRounding);
}

}  // namespace
}  // namespace flies
