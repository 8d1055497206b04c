#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "flies/core/options.hpp"
#include "network.hpp"
#include "windows.hpp"

namespace flies {

/// What decides, with the pictures, how a network learns.
struct LearningOptions {
  std::uint64_t seed = 1;
  int epochs = 24;
  int steps = 400;
  int fresh = 30'000;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("seed", self.seed, "seed of all random numbers; same pictures, seed and options give the same model");
    field("epochs", self.epochs, Range{1, 1000}, "number of epochs; after each, new hard windows are looked for");
    field("steps", self.steps, Range{1, 100000}, "batches of 128 windows an epoch");
    field("fresh", self.fresh, Range{1, 10000000},
          "new windows without people that are looked at for hard ones after an epoch");
  }
};

/// An epoch of the past.
struct EpochSummary {
  double loss = 0.0;     ///< mean over its batches
  std::size_t hard = 0;  ///< hard windows without people known at its end
};

/// Every person once before any comes again.
class PeopleInTurn {
 public:
  explicit PeopleInTurn(std::vector<Place> places);
  const Place& next(Random& random);

  const std::vector<std::int64_t>& order() const { return order_; }
  std::size_t position() const { return next_; }
  /// Goes on where another one was. @returns false, and changes nothing, when that was of other people
  bool go_on(std::vector<std::int64_t> order, std::size_t position);

 private:
  std::vector<Place> places_;
  std::vector<std::int64_t> order_;
  std::size_t next_ = 0;
};

/// A network that learns from half people and half background, of which half is what it took for people before. An
/// epoch is the smallest step; between two of them the whole can be put into bytes and be taken from there.
class Learning {
 public:
  /// Seeds the random numbers of libtorch as well. @param pictures must outlive it
  Learning(const std::vector<Picture>& pictures, NetworkStage stage, const LearningOptions& options);

  Network& network() { return network_; }
  bool is_done() const { return static_cast<int>(epochs_.size()) >= options_.epochs; }
  const std::vector<EpochSummary>& epochs() const { return epochs_; }

  /// @param progress called after each batch
  void learn_epoch(const std::function<void()>& progress);

  /// Weights, optimiser, random numbers, hard windows, epochs: what comes after is the same as without a break.
  std::string state();
  /// Goes on from there.
  /// @returns false when that is no state of such a training; this one is then of no use any more
  bool restore(const std::string& state);

 private:
  double learn_batch(double done);
  void fill_batch(torch::Tensor& wanted);
  void look_for_hard();

  const std::vector<Picture>& pictures_;
  LearningOptions options_;
  Random random_;
  Network network_;
  torch::optim::AdamW optimiser_;
  PeopleInTurn people_;
  BackgroundPlaces background_;
  std::deque<Place> hard_;
  std::vector<EpochSummary> epochs_;
  std::vector<float> pixels_;  ///< of a batch
};

}  // namespace flies
