/// Prints numbers that must be the same on every CPU, all their bits: fitness, road correlations, features and scores
/// of windows. `scripts/test-neon` compares what this prints here and on 64-bit Arm.
#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "flies/classify/hog.hpp"
#include "flies/classify/kernel_machine.hpp"
#include "flies/core/random.hpp"
#include "flies/fitness/fitness.hpp"
#include "flies/road/kernels/correlate_shifts.hpp"

namespace {

using namespace flies;

constexpr int kWidth_px = 160, kHeight_px = 200;

/// Blocks of noise, which have edges as well as flat parts.
std::vector<std::uint8_t> noise(std::uint32_t image) {
  std::vector<std::uint8_t> pixels;
  for (int v = 0; v < kHeight_px; ++v)
    for (int u = 0; u < kWidth_px; ++u) {
      FlyRandom block(7, image, static_cast<std::uint32_t>(v / 7), static_cast<std::uint32_t>(u / 5));
      FlyRandom pixel(8, image, static_cast<std::uint32_t>(v), static_cast<std::uint32_t>(u));
      pixels.push_back(static_cast<std::uint8_t>(block.below(200) + pixel.below(50)));
    }
  return pixels;
}

void print(const char* name, std::span<const float> values) {
  for (const float value : values) fmt::print("{} {:08x}\n", name, std::bit_cast<std::uint32_t>(value));
}

void print_fitness(const RectifiedPair& pair) {
  std::vector<float> u_px, v_px, disparity_px, fitness(2000);
  for (std::uint32_t i = 0; i < fitness.size(); ++i) {
    FlyRandom random(9, 0, 0, i);
    u_px.push_back(static_cast<float>(kWidth_px * random.uniform()));
    v_px.push_back(static_cast<float>(kHeight_px * random.uniform()));
    disparity_px.push_back(static_cast<float>(40.0 * random.uniform()));
  }
  for (const FitnessFunction function :
       {FitnessFunction::correlation, FitnessFunction::covariance, FitnessFunction::louchet}) {
    FitnessOptions options;
    options.function = function;
    score_points(pair, options, u_px, v_px, disparity_px, fitness);
    print("fitness", fitness);
  }
}

void print_road(const RectifiedPair& pair) {
  std::vector<float> coefficients(kernels::kMaxShifts);
  for (int fraction16 = 0; fraction16 < 16; ++fraction16) {
    kernels::correlate_shifts({.left = pair.left.row(20) + 60,
                               .right = pair.right.row(20) + 10,
                               .left_stride = pair.left.stride,
                               .right_stride = pair.right.stride,
                               .fraction16 = fraction16,
                               .shifts = kernels::kMaxShifts,
                               .noise_gray2 = 1.0},
                              coefficients.data());
    print("road", coefficients);
  }
}

void print_classification(const GrayView& image) {
  const std::size_t length = feature_count({});
  std::vector<float> features, of_window(length);
  for (const ImageBox& window : {ImageBox{3.3, 2.1, 40, 80}, {20, 30, 60, 120}, {-10, -5, 100, 200}}) {
    window_features(image, window, {}, of_window);
    features.insert(features.end(), of_window.begin(), of_window.end());
  }
  print("feature", features);
  const auto random_values = [](std::size_t count, std::uint32_t stream) {
    FlyRandom random(3, stream, 0, 0);
    std::vector<float> values(count);
    for (float& value : values) value = static_cast<float>(random.uniform() - 0.5);
    return values;
  };
  KernelStage stage;
  stage.mean = random_values(length, 0);
  stage.projection = {20, length, random_values(20 * length, 1)};
  stage.support_vectors = {37, 20, random_values(37 * 20, 2)};
  stage.coefficients = random_values(37, 3);
  stage.gamma = 0.02;
  for (const double score : KernelMachine(stage).scores(features))
    fmt::print("score {:016x}\n", std::bit_cast<std::uint64_t>(score));
}

}  // namespace

int main() {
  const auto left = noise(0), right = noise(1);
  const RectifiedPair pair{{left.data(), kWidth_px, kHeight_px, kWidth_px},
                           {right.data(), kWidth_px, kHeight_px, kWidth_px}};
  print_fitness(pair);
  print_road(pair);
  print_classification(pair.left);
}
