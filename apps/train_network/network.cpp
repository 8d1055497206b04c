#include "network.hpp"

#include <algorithm>
#include <sstream>

#include "flies/classify/convolution.hpp"
#include "flies/classify/model_file.hpp"

namespace flies {
namespace {

namespace nn = torch::nn;

struct Shape {
  int stride, channels;
};
/// 3.6 million products a window; channels in sixteens, as the kernel computes them.
constexpr Shape kLastLayers[] = {{2, 16}, {2, 32}, {2, 32}, {1, 48}, {2, 64}};
/// 170,000 products a window; a window begins at every fourth pixel.
constexpr Shape kFirstLayers[] = {{2, 16}, {2, 16}, {1, 32}};
constexpr double kLastDropout = 0.25, kFirstDropout = 0.1;

constexpr std::size_t kBatch = 128;

std::span<const Shape> layers_of(NetworkStage stage) {
  return stage == NetworkStage::first ? std::span<const Shape>(kFirstLayers) : std::span<const Shape>(kLastLayers);
}

std::vector<float> values_of(const torch::Tensor& tensor) {
  const auto flat = tensor.detach().to(torch::kFloat).contiguous();
  return {flat.data_ptr<float>(), flat.data_ptr<float>() + flat.numel()};
}

/// Resizes as `resample` shrinks: each pixel is the mean of what it covers.
/// @returns `to` x `from`
torch::Tensor area_means(int from, int to) {
  auto means = torch::zeros({to, from});
  const double scale = static_cast<double>(from) / to;
  for (int i = 0; i < to; ++i)
    for (int j = 0; j < from; ++j) {
      const double covered = std::min(j + 1.0, (i + 1) * scale) - std::max<double>(j, i * scale);
      if (covered > 0.0) means[i][j] = covered / scale;
    }
  return means;
}

/// Of every window, in grey levels.
torch::Tensor contrasts(const torch::Tensor& levels) {
  return levels.var({1, 2, 3}, false, true).sqrt().clamp_min(kLeastContrast);
}

ConvolutionLayer layer_of(const Shape& shape, const torch::Tensor& kernels) {
  ConvolutionLayer layer;
  layer.stride = shape.stride;
  layer.weights.rows = static_cast<std::size_t>(kernels.size(0));
  layer.weights.columns = static_cast<std::size_t>(kernels.numel()) / layer.weights.rows;
  layer.weights.values = values_of(kernels);
  round_to_half(layer.weights.values);
  layer.largest = 0.0;
  return layer;
}

}  // namespace

torch::Tensor batch_of(std::vector<float>& pixels, std::size_t count) {
  return torch::from_blob(pixels.data(), {static_cast<long>(count), 1, kWindowHeight_px, kWindowWidth_px});
}

Network::Network(NetworkStage stage) : stage_(stage) {
  const bool is_first = stage == NetworkStage::first;
  const int around = is_first ? 0 : 1;
  int inputs = 1, height = is_first ? kFirstNetworkHeight_px : kWindowHeight_px,
      width = is_first ? kFirstNetworkWidth_px : kWindowWidth_px;
  for (const Shape& layer : layers_of(stage)) {
    convolutions_.emplace_back(
        nn::Conv2dOptions(inputs, layer.channels, 3).stride(layer.stride).padding(around).bias(false));
    module_->push_back(convolutions_.back());
    if (!is_first) {
      normals_.emplace_back(layer.channels);
      module_->push_back(normals_.back());
    }
    inputs = layer.channels;
    height = (height + 2 * around - 3) / layer.stride + 1;
    width = (width + 2 * around - 3) / layer.stride + 1;
  }
  dropout_ = nn::Dropout(is_first ? kFirstDropout : kLastDropout);
  last_ = nn::Linear(inputs * height * width, 1);
  module_->push_back(dropout_);
  module_->push_back(last_);
  rows_ = area_means(kWindowHeight_px, kFirstNetworkHeight_px);
  columns_ = area_means(kWindowWidth_px, kFirstNetworkWidth_px).transpose(0, 1).contiguous();
}

std::string Network::shape() {
  std::ostringstream text;
  for (const auto& parameter : module_->parameters()) text << parameter.sizes();
  return text.str();
}

void Network::prepare(std::span<float> levels) const {
  if (stage_ == NetworkStage::last) normalise_levels(levels);
}

template <class Use>
void Network::for_batches(const std::vector<Picture>& pictures, const std::vector<Place>& places,
                          const Use& use) const {
  std::vector<float> pixels(kBatch * kWindowPixels);
  for (std::size_t first = 0; first < places.size(); first += kBatch) {
    const std::size_t count = std::min(kBatch, places.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      const Place& place = places[first + i];
      float* window = pixels.data() + i * kWindowPixels;
      read_window(pictures[place.picture], place.window, window);
      prepare({window, kWindowPixels});
    }
    use(batch_of(pixels, count));
  }
}

/// Those of the first layer of the first stage sum to zero.
torch::Tensor Network::kernels_of(std::size_t layer) const {
  const torch::Tensor& kernels = convolutions_[layer]->weight;
  return stage_ == NetworkStage::first && layer == 0 ? kernels - kernels.mean({2, 3}, true) : kernels;
}

torch::Tensor Network::convolved(const torch::Tensor& batch, std::size_t layer) {
  if (stage_ == NetworkStage::last) return torch::relu(normals_[layer]->forward(convolutions_[layer]->forward(batch)));
  return torch::relu(torch::conv2d(batch, kernels_of(layer), {}, convolutions_[layer]->options.stride()));
}

torch::Tensor Network::resized(const torch::Tensor& batch) const {
  return torch::matmul(torch::matmul(rows_, batch), columns_);
}

torch::Tensor Network::forward(const torch::Tensor& batch) {
  torch::Tensor pixels = batch;
  if (stage_ == NetworkStage::first) {
    const auto levels = resized(batch);
    pixels = (levels - levels.mean({1, 2, 3}, true)) / contrasts(levels);
  }
  for (std::size_t i = 0; i < convolutions_.size(); ++i) pixels = convolved(pixels, i);
  return last_->forward(dropout_->forward(pixels.flatten(1)));
}

std::vector<float> Network::scores(const std::vector<Picture>& pictures, const std::vector<Place>& places) {
  const torch::NoGradGuard guard;
  module_->eval();
  std::vector<float> result;
  for_batches(pictures, places, [&](const torch::Tensor& batch) {
    std::ranges::copy(values_of(forward(batch)), std::back_inserter(result));
  });
  module_->train();
  return result;
}

/// Channels come first there, here pixels.
std::vector<float> Network::last_weights() const {
  const long channels = layers_of(stage_).back().channels;
  std::vector<float> weights = values_of(last_->weight.view({channels, -1}).transpose(0, 1));
  round_to_half(weights);
  return weights;
}

/// In use, the contrast of the first stage is divided out last: its activations are of levels as they are.
void Network::note_largest(const std::vector<Picture>& pictures, const std::vector<Place>& sample,
                           std::vector<ConvolutionLayer>& layers) {
  for_batches(pictures, sample, [&](torch::Tensor batch) {
    if (stage_ == NetworkStage::first) batch = resized(batch);
    for (std::size_t i = 0; i < layers.size(); ++i) {
      batch = convolved(batch, i);
      layers[i].largest = std::max(layers[i].largest, batch.max().item<double>());
    }
  });
}

ConvolutionStage Network::last_stage(const std::vector<Picture>& pictures, const std::vector<Place>& sample) {
  const torch::NoGradGuard guard;
  module_->eval();
  ConvolutionStage stage;
  for (std::size_t i = 0; i < convolutions_.size(); ++i) {
    const nn::BatchNorm2d& normal = normals_[i];
    const auto scale = normal->weight / torch::sqrt(normal->running_var + normal->options.eps());
    ConvolutionLayer layer = layer_of(kLastLayers[i], convolutions_[i]->weight * scale.view({-1, 1, 1, 1}));
    layer.biases = values_of(normal->bias - normal->running_mean * scale);
    round_to_half(layer.biases);
    stage.layers.push_back(std::move(layer));
  }
  note_largest(pictures, sample, stage.layers);
  stage.last = last_weights();
  stage.bias = last_->bias.item<double>();
  module_->train();
  return stage;
}

FirstNetwork Network::first_stage(const std::vector<Picture>& pictures, const std::vector<Place>& sample) {
  const torch::NoGradGuard guard;
  module_->eval();
  FirstNetwork network;
  for (std::size_t i = 0; i < convolutions_.size(); ++i)
    network.layers.push_back(layer_of(kFirstLayers[i], kernels_of(i)));
  note_largest(pictures, sample, network.layers);
  network.last = last_weights();
  network.bias = last_->bias.item<double>();
  module_->train();
  return network;
}

}  // namespace flies
