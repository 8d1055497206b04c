#include "flies/synth/sensor.hpp"

#include <tbb/parallel_for.h>

#include <cmath>

#include "flies/core/random.hpp"

namespace flies {
namespace synth {
namespace {

constexpr std::uint32_t kNoisePurpose = 120;

std::vector<float> gaussian_weights(double sigma_px) {
  const int reach = static_cast<int>(std::ceil(3.0 * sigma_px));
  std::vector<float> weights;
  float sum = 0.0F;
  for (int i = -reach; i <= reach; ++i) {
    weights.push_back(static_cast<float>(std::exp(-0.5 * i * i / (sigma_px * sigma_px))));
    sum += weights.back();
  }
  for (auto& weight : weights) weight /= sum;
  return weights;
}

LinearImage blurred(const LinearImage& image, double sigma_px) {
  if (sigma_px <= 0.0) return image;
  const auto weights = gaussian_weights(sigma_px);
  const int reach = static_cast<int>(weights.size() / 2);
  LinearImage across = image, result = image;
  // Beyond the border the outermost pixel goes on.
  tbb::parallel_for(0, image.height_px, [&](int v) {
    for (int u = 0; u < image.width_px; ++u) {
      Vec3 sum;
      for (int i = -reach; i <= reach; ++i)
        sum =
            sum + image.at(std::clamp(u + i, 0, image.width_px - 1), v) * weights[static_cast<std::size_t>(i + reach)];
      across.at(u, v) = sum;
    }
  });
  tbb::parallel_for(0, image.height_px, [&](int v) {
    for (int u = 0; u < image.width_px; ++u) {
      Vec3 sum;
      for (int i = -reach; i <= reach; ++i)
        sum = sum +
              across.at(u, std::clamp(v + i, 0, image.height_px - 1)) * weights[static_cast<std::size_t>(i + reach)];
      result.at(u, v) = sum;
    }
  });
  return result;
}

/// Film-like curve: linear in the dark, a soft shoulder instead of clipping, then the usual display gamma.
float gray_level(float light, float exposure) {
  return 255.0F * std::pow(1.0F - std::exp(-exposure * light), 1.0F / 2.2F);
}

std::uint8_t to_byte(float gray) { return static_cast<std::uint8_t>(std::clamp(std::lround(gray), 0L, 255L)); }

}  // namespace

ColorImage expose(const LinearImage& light, const Lighting& lighting, const SceneOptions& options, bool is_right) {
  const LinearImage image = blurred(light, options.blur_px);
  // A meter that reads the light on a wall-and-road mixture, so that low sun and overcast skies come out usable.
  const float exposure = 1.7F / (lighting.ambient + lighting.sun * std::max(0.4F, lighting.to_sun.z));
  const float gain = is_right ? static_cast<float>(1.0 + options.gain_difference) : 1.0F;
  ColorImage result{image.width_px, image.height_px, {}};
  result.pixels.resize(3 * image.pixels.size());
  tbb::parallel_for(0, image.height_px, [&](int v) {
    FlyRandom random(options.seed, kNoisePurpose, is_right ? 1 : 0, static_cast<std::uint32_t>(v));
    std::uint8_t* out =
        result.pixels.data() + 3 * static_cast<std::size_t>(v) * static_cast<std::size_t>(image.width_px);
    for (int u = 0; u < image.width_px; ++u) {
      const float noise = options.noise_gray > 0.0 ? static_cast<float>(options.noise_gray * random.normal()) : 0.0F;
      const Vec3& pixel = image.at(u, v);
      for (const float channel : {pixel.x, pixel.y, pixel.z})
        *out++ = to_byte(gain * gray_level(channel, exposure) + noise);
    }
  });
  return result;
}

}  // namespace synth

GrayImage to_gray(const ColorImage& image) {
  GrayImage gray{image.width_px, image.height_px, {}};
  gray.pixels.resize(image.pixels.size() / 3);
  for (std::size_t i = 0; i < gray.pixels.size(); ++i) {
    const unsigned red = image.pixels[3 * i], green = image.pixels[3 * i + 1], blue = image.pixels[3 * i + 2];
    gray.pixels[i] = static_cast<std::uint8_t>((red * 9798U + green * 19235U + blue * 3735U + 16384U) >> 15);
  }
  return gray;
}

}  // namespace flies
