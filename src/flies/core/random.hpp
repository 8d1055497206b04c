#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace flies {

/// Philox4x32-10 (Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", SC 2011): four random words from a
/// 128-bit counter and a 64-bit key. A counter-based generator makes the draw of fly i in generation g a pure
/// function of (seed, g, i), so results do not depend on the number of threads or on the order of evaluation.
constexpr std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::uint64_t key) {
  auto key0 = static_cast<std::uint32_t>(key);
  auto key1 = static_cast<std::uint32_t>(key >> 32);
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t product0 = 0xD2511F53ull * counter[0];
    const std::uint64_t product1 = 0xCD9E8D57ull * counter[2];
    counter = {static_cast<std::uint32_t>(product1 >> 32) ^ counter[1] ^ key0, static_cast<std::uint32_t>(product1),
               static_cast<std::uint32_t>(product0 >> 32) ^ counter[3] ^ key1, static_cast<std::uint32_t>(product0)};
    key0 += 0x9E3779B9u;
    key1 += 0xBB67AE85u;
  }
  return counter;
}

/// Four random words, all that most draws need.
using RandomWords = std::array<std::uint32_t, 4>;

/// Philox2x64-7 of the same paper: the same quality (6 rounds pass all of its statistical tests) for less than half of
/// the instructions where 64-bit products are cheap. For draws by the ten thousand.
constexpr RandomWords quick_philox(std::array<std::uint64_t, 2> counter, std::uint64_t key) {
  __extension__ using Product = unsigned __int128;
  for (int round = 0; round < 7; ++round) {
    const Product product = Product{0xD2B74407B1CE6E93u} * counter[0];
    counter = {static_cast<std::uint64_t>(product >> 64) ^ key ^ counter[1], static_cast<std::uint64_t>(product)};
    key += 0x9E3779B97F4A7C15u;
  }
  return {static_cast<std::uint32_t>(counter[0]), static_cast<std::uint32_t>(counter[0] >> 32),
          static_cast<std::uint32_t>(counter[1]), static_cast<std::uint32_t>(counter[1] >> 32)};
}

/// The words of one fly in one generation for one purpose, draw by draw.
constexpr RandomWords fly_words(std::uint64_t seed, std::uint32_t purpose, std::uint32_t generation, std::uint32_t fly,
                                std::uint32_t draw) {
  return quick_philox({std::uint64_t{purpose} << 32 | generation, std::uint64_t{fly} << 32 | draw}, seed);
}

/// Hands them out in order: like FlyRandom, but faster.
class FlyDraws {
 public:
  FlyDraws(std::uint64_t seed, std::uint32_t purpose, std::uint32_t generation, std::uint32_t fly)
      : seed_(seed), purpose_(purpose), generation_(generation), fly_(fly) {}

  RandomWords next() { return fly_words(seed_, purpose_, generation_, fly_, draw_++); }

 private:
  std::uint64_t seed_;
  std::uint32_t purpose_, generation_, fly_, draw_ = 0;
};

/// Uniform in [low, high) from one word.
inline double uniform(std::uint32_t word, double low = 0.0, double high = 1.0) {
  return low + (high - low) * (word * 0x1p-32);
}

/// Uniform in [0, count) from one word, count > 0.
inline std::uint32_t below(std::uint32_t word, std::uint32_t count) {
  return static_cast<std::uint32_t>((static_cast<std::uint64_t>(word) * count) >> 32);
}

/// Standard normal from one word: the quantile function of the normal distribution, linear between 1023 exact ones.
/// Its variance is 1, its distribution function is off by at most 1.4e-4; nothing falls beyond 3.63, where one of 3,500
/// normal deviates does.
double standard_normal(std::uint32_t word);

/// The random numbers of one fly in one generation for one purpose: a short private stream.
class FlyRandom {
 public:
  /// `purpose` keeps the streams of different operators and of different pairs apart (see evolve).
  FlyRandom(std::uint64_t seed, std::uint32_t purpose, std::uint32_t generation, std::uint32_t fly)
      : seed_(seed), counter_{fly, generation, purpose, 0} {}

  std::uint32_t bits() {
    if (next_ == 4) {
      block_ = philox(counter_, seed_);
      ++counter_[3];
      next_ = 0;
    }
    return block_[next_++];
  }

  /// Uniform in [0, 1).
  double uniform() { return bits() * 0x1p-32; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Uniform in [0, count), count > 0.
  std::uint32_t below(std::uint32_t count) {
    return static_cast<std::uint32_t>((static_cast<std::uint64_t>(bits()) * count) >> 32);
  }

  /// Standard normal (Box-Muller).
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log((bits() + 1.0) * 0x1p-32));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }

 private:
  std::uint64_t seed_;
  std::array<std::uint32_t, 4> counter_;
  std::array<std::uint32_t, 4> block_{};
  unsigned next_ = 4;
};

}  // namespace flies
