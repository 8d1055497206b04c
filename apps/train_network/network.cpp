#include "network.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>

#include "flies/classify/convolution.hpp"
#include "flies/classify/model_file.hpp"

namespace flies {
namespace {

namespace nn = torch::nn;

struct Shape {
  int stride, channels;
};
/// 3.6 million products a window; channels in sixteens, as the kernel computes them.
constexpr Shape kLayers[] = {{2, 16}, {2, 32}, {2, 32}, {1, 48}, {2, 64}};

constexpr std::size_t kBatch = 128, kPeople = 48, kHard = 40;
constexpr double kRate = 2e-3, kWarmUp = 0.05, kDecay = 0.02;
constexpr double kSure = 0.98;  // wanted of people: labels and places are off at times
constexpr double kHiddenPeople = 0.25, kHiddenBackground = 0.1;
constexpr std::size_t kFreshPlaces = 30'000, kMostHard = 12'000;
constexpr float kHardScore = -2.0F;

torch::Tensor batch_of(std::vector<float>& pixels, std::size_t count) {
  return torch::from_blob(pixels.data(), {static_cast<long>(count), 1, kWindowHeight_px, kWindowWidth_px});
}

/// Rises at first, then falls to nothing along a cosine.
double rate_at(double done) {
  return kRate * (done < kWarmUp ? done / kWarmUp
                                 : 0.5 * (1.0 + std::cos(std::numbers::pi * (done - kWarmUp) / (1.0 - kWarmUp))));
}

/// Calls with a filled batch after the other.
template <class Use>
void for_batches(const std::vector<Picture>& pictures, const std::vector<Place>& places, const Use& use) {
  std::vector<float> pixels(kBatch * kWindowPixels);
  for (std::size_t first = 0; first < places.size(); first += kBatch) {
    const std::size_t count = std::min(kBatch, places.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      const Place& place = places[first + i];
      float* window = pixels.data() + i * kWindowPixels;
      read_window(pictures[place.picture], place.window, window);
      normalise_levels({window, kWindowPixels});
    }
    use(batch_of(pixels, count), count);
  }
}

std::vector<float> values_of(const torch::Tensor& tensor) {
  const auto flat = tensor.detach().to(torch::kFloat).contiguous();
  return {flat.data_ptr<float>(), flat.data_ptr<float>() + flat.numel()};
}

/// Every person once before any comes again.
class InTurn {
 public:
  explicit InTurn(const std::vector<Place>& places) : places_(places) {
    for (std::size_t i = 0; i < places.size(); ++i) order_.push_back(i);
  }
  const Place& next(Random& random) {
    if (next_ == 0) std::shuffle(order_.begin(), order_.end(), random);
    const Place& place = places_[order_[next_]];
    next_ = (next_ + 1) % order_.size();
    return place;
  }

 private:
  const std::vector<Place>& places_;
  std::vector<std::size_t> order_;
  std::size_t next_ = 0;
};

}  // namespace

Network::Network() {
  int inputs = 1, height = kWindowHeight_px, width = kWindowWidth_px;
  for (const Shape& layer : kLayers) {
    convolutions_.emplace_back(
        nn::Conv2dOptions(inputs, layer.channels, 3).stride(layer.stride).padding(1).bias(false));
    normals_.emplace_back(layer.channels);
    module_->push_back(convolutions_.back());
    module_->push_back(normals_.back());
    module_->push_back(nn::ReLU(true));
    inputs = layer.channels;
    height = (height + layer.stride - 1) / layer.stride;
    width = (width + layer.stride - 1) / layer.stride;
  }
  last_ = nn::Linear(inputs * height * width, 1);
  module_->push_back(nn::Flatten());
  module_->push_back(nn::Dropout(0.25));
  module_->push_back(last_);
}

std::vector<float> Network::scores(const std::vector<Picture>& pictures, const std::vector<Place>& places) {
  const torch::NoGradGuard guard;
  module_->eval();
  std::vector<float> result;
  for_batches(pictures, places, [&](const torch::Tensor& batch, std::size_t) {
    std::ranges::copy(values_of(module_->forward(batch)), std::back_inserter(result));
  });
  module_->train();
  return result;
}

ConvolutionStage Network::stage(const std::vector<Picture>& pictures, const std::vector<Place>& sample) {
  const torch::NoGradGuard guard;
  module_->eval();
  ConvolutionStage stage;
  for (std::size_t i = 0; i < convolutions_.size(); ++i) {
    const nn::Conv2d& convolution = convolutions_[i];
    const nn::BatchNorm2d& normal = normals_[i];
    const auto scale = normal->weight / torch::sqrt(normal->running_var + normal->options.eps());
    ConvolutionLayer layer;
    layer.stride = kLayers[i].stride;
    layer.weights.rows = static_cast<std::size_t>(convolution->weight.size(0));
    layer.weights.columns = static_cast<std::size_t>(convolution->weight.numel()) / layer.weights.rows;
    layer.weights.values = values_of(convolution->weight * scale.view({-1, 1, 1, 1}));
    layer.biases = values_of(normal->bias - normal->running_mean * scale);
    round_to_half(layer.weights.values);
    round_to_half(layer.biases);
    layer.largest = 0.0;
    stage.layers.push_back(std::move(layer));
  }
  for_batches(pictures, sample, [&](torch::Tensor batch, std::size_t) {
    for (std::size_t i = 0; i < convolutions_.size(); ++i) {
      batch = torch::relu(normals_[i]->forward(convolutions_[i]->forward(batch)));
      stage.layers[i].largest = std::max(stage.layers[i].largest, batch.max().item<double>());
    }
  });
  // Channels come first there, here pixels.
  const long channels = kLayers[std::size(kLayers) - 1].channels;
  stage.last = values_of(last_->weight.view({channels, -1}).transpose(0, 1));
  round_to_half(stage.last);
  stage.bias = last_->bias.item<double>();
  module_->train();
  return stage;
}

void learn(Network& network, const std::vector<Picture>& pictures, const LearningOptions& options,
           const LearningProgress& progress) {
  const std::vector<Place> people = places_of_people(pictures);
  const BackgroundPlaces background(pictures);
  Random random(options.seed);
  torch::optim::AdamW optimiser(network.module()->parameters(), torch::optim::AdamWOptions(kRate).weight_decay(kDecay));
  InTurn in_turn(people);
  std::deque<Place> hard;
  std::vector<float> pixels(kBatch * kWindowPixels);
  for (int epoch = 0; epoch < options.epochs; ++epoch) {
    double sum = 0.0;
    for (int step = 0; step < options.steps; ++step) {
      const double done = (epoch + step / static_cast<double>(options.steps)) / options.epochs;
      static_cast<torch::optim::AdamWOptions&>(optimiser.param_groups()[0].options()).lr(rate_at(done));
      auto wanted = torch::zeros({static_cast<long>(kBatch), 1});
      for (std::size_t i = kBatch; i-- > 0;) {  // background first: it hides people
        float* window = pixels.data() + i * kWindowPixels;
        if (i < kPeople) {
          const Place& place = in_turn.next(random);
          read_window(pictures[place.picture], jittered(place.window, random), window);
          disguise(window, pixels.data() + (kBatch - 1 - i) * kWindowPixels, kHiddenPeople, random);
          wanted[static_cast<long>(i)][0] = kSure;
        } else {
          const bool is_hard = i < kPeople + kHard && !hard.empty();
          const Place place = is_hard ? hard[random() % hard.size()] : background.draw(random);
          read_window(pictures[place.picture], place.window, window);
          disguise(window, i + 1 < kBatch ? window + kWindowPixels : nullptr, kHiddenBackground, random);
        }
      }
      for (std::size_t i = 0; i < kBatch; ++i) normalise_levels({pixels.data() + i * kWindowPixels, kWindowPixels});
      optimiser.zero_grad();
      auto loss = torch::binary_cross_entropy_with_logits(network.module()->forward(batch_of(pixels, kBatch)), wanted);
      loss.backward();
      optimiser.step();
      sum += loss.item<double>();
    }
    std::vector<Place> fresh;
    for (std::size_t i = 0; i < kFreshPlaces; ++i) fresh.push_back(background.draw(random));
    const auto scores = network.scores(pictures, fresh);
    for (std::size_t i = 0; i < fresh.size(); ++i) {
      if (scores[i] <= kHardScore) continue;
      hard.push_back(fresh[i]);
      if (hard.size() > kMostHard) hard.pop_front();
    }
    if (progress) progress(epoch + 1, sum / options.steps, hard.size());
  }
}

}  // namespace flies
