#include "learning.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace flies {
namespace {

constexpr std::size_t kBatch = 128, kPeople = 48, kHard = 40;
constexpr double kRate = 2e-3, kWarmUp = 0.05, kDecay = 0.02;
constexpr double kSure = 0.98;  // wanted of people: labels and places are off at times
constexpr double kHiddenPeople = 0.25, kHiddenBackground = 0.1;
constexpr std::size_t kMostHard = 12'000;
constexpr float kHardScore = -2.0F;

/// Rises at first, then falls to nothing along a cosine.
double rate_at(double done) {
  return kRate * (done < kWarmUp ? done / kWarmUp
                                 : 0.5 * (1.0 + std::cos(std::numbers::pi * (done - kWarmUp) / (1.0 - kWarmUp))));
}

/// The weights that a network begins with are libtorch's random numbers.
std::uint64_t seed_torch(std::uint64_t seed) {
  torch::manual_seed(seed);
  return seed;
}

}  // namespace

PeopleInTurn::PeopleInTurn(std::vector<Place> places) : places_(std::move(places)) {
  for (std::size_t i = 0; i < places_.size(); ++i) order_.push_back(static_cast<std::int64_t>(i));
}

const Place& PeopleInTurn::next(Random& random) {
  if (next_ == 0) std::shuffle(order_.begin(), order_.end(), random);
  const Place& place = places_[static_cast<std::size_t>(order_[next_])];
  next_ = (next_ + 1) % order_.size();
  return place;
}

bool PeopleInTurn::go_on(std::vector<std::int64_t> order, std::size_t position) {
  std::vector<std::int64_t> sorted = order;
  std::sort(sorted.begin(), sorted.end());
  if (sorted.size() != places_.size() || position >= sorted.size()) return false;
  for (std::size_t i = 0; i < sorted.size(); ++i)
    if (sorted[i] != static_cast<std::int64_t>(i)) return false;
  order_ = std::move(order);
  next_ = position;
  return true;
}

Learning::Learning(const std::vector<Picture>& pictures, NetworkStage stage, const LearningOptions& options)
    : pictures_(pictures),
      options_(options),
      random_(seed_torch(options.seed)),
      network_(stage),
      optimiser_(network_.module()->parameters(), torch::optim::AdamWOptions(kRate).weight_decay(kDecay)),
      people_(places_of_people(pictures)),
      background_(pictures),
      pixels_(kBatch * kWindowPixels) {}

void Learning::learn_epoch(const std::function<void()>& progress) {
  double sum = 0.0;
  for (int step = 0; step < options_.steps; ++step) {
    const double epoch = static_cast<double>(epochs_.size());
    sum += learn_batch((epoch + step / static_cast<double>(options_.steps)) / options_.epochs);
    if (progress) progress();
  }
  look_for_hard();
  epochs_.push_back({sum / options_.steps, hard_.size()});
}

void Learning::fill_batch(torch::Tensor& wanted) {
  for (std::size_t i = kBatch; i-- > 0;) {  // background first: it hides people
    float* window = pixels_.data() + i * kWindowPixels;
    if (i < kPeople) {
      const Place& place = people_.next(random_);
      read_window(pictures_[place.picture], jittered(place.window, random_), window);
      disguise(window, pixels_.data() + (kBatch - 1 - i) * kWindowPixels, kHiddenPeople, random_);
      wanted[static_cast<long>(i)][0] = kSure;
    } else {
      const bool is_hard = i < kPeople + kHard && !hard_.empty();
      const Place place = is_hard ? hard_[random_() % hard_.size()] : background_.draw(random_);
      read_window(pictures_[place.picture], place.window, window);
      disguise(window, i + 1 < kBatch ? window + kWindowPixels : nullptr, kHiddenBackground, random_);
    }
  }
  for (std::size_t i = 0; i < kBatch; ++i) network_.prepare({pixels_.data() + i * kWindowPixels, kWindowPixels});
}

double Learning::learn_batch(double done) {
  static_cast<torch::optim::AdamWOptions&>(optimiser_.param_groups()[0].options()).lr(rate_at(done));
  auto wanted = torch::zeros({static_cast<long>(kBatch), 1});
  fill_batch(wanted);
  optimiser_.zero_grad();
  auto loss = torch::binary_cross_entropy_with_logits(network_.forward(batch_of(pixels_, kBatch)), wanted);
  loss.backward();
  optimiser_.step();
  return loss.item<double>();
}

void Learning::look_for_hard() {
  std::vector<Place> fresh;
  for (int i = 0; i < options_.fresh; ++i) fresh.push_back(background_.draw(random_));
  const auto scores = network_.scores(pictures_, fresh);
  for (std::size_t i = 0; i < fresh.size(); ++i) {
    if (scores[i] <= kHardScore) continue;
    hard_.push_back(fresh[i]);
    if (hard_.size() > kMostHard) hard_.pop_front();
  }
}

}  // namespace flies
