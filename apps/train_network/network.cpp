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
constexpr Shape kLayers[] = {{2, 16}, {2, 32}, {2, 32}, {1, 48}, {2, 64}};

constexpr std::size_t kBatch = 128;

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
    use(batch_of(pixels, count));
  }
}

std::vector<float> values_of(const torch::Tensor& tensor) {
  const auto flat = tensor.detach().to(torch::kFloat).contiguous();
  return {flat.data_ptr<float>(), flat.data_ptr<float>() + flat.numel()};
}

}  // namespace

torch::Tensor batch_of(std::vector<float>& pixels, std::size_t count) {
  return torch::from_blob(pixels.data(), {static_cast<long>(count), 1, kWindowHeight_px, kWindowWidth_px});
}

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

std::string Network::shape() {
  std::ostringstream text;
  for (const auto& parameter : module_->parameters()) text << parameter.sizes();
  return text.str();
}

std::vector<float> Network::scores(const std::vector<Picture>& pictures, const std::vector<Place>& places) {
  const torch::NoGradGuard guard;
  module_->eval();
  std::vector<float> result;
  for_batches(pictures, places, [&](const torch::Tensor& batch) {
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
  for_batches(pictures, sample, [&](torch::Tensor batch) {
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

}  // namespace flies
