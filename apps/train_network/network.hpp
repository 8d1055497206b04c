#pragma once

#include <torch/torch.h>

#include <string>
#include <vector>

#include "flies/classify/people_model.hpp"
#include "windows.hpp"

namespace flies {

/// Windows, one after the other, as the network takes them; the tensor looks at `pixels` and does not own them.
torch::Tensor batch_of(std::vector<float>& pixels, std::size_t count);

/// The network while it is trained: convolutions, each followed by batch normalisation and rectification, then one sum.
class Network {
 public:
  Network();

  torch::nn::Sequential& module() { return module_; }

  /// Sizes of all its weights, as text: tells networks of other shapes apart.
  std::string shape();

  /// One score a window, as the network is now.
  std::vector<float> scores(const std::vector<Picture>& pictures, const std::vector<Place>& places);

  /// The same network as plain values: normalisation becomes part of weights and biases; all weights rounded to 16
  /// bits.
  /// @param sample whose activations tell how large they become
  ConvolutionStage stage(const std::vector<Picture>& pictures, const std::vector<Place>& sample);

 private:
  torch::nn::Sequential module_;  ///< all of these one after the other
  std::vector<torch::nn::Conv2d> convolutions_;
  std::vector<torch::nn::BatchNorm2d> normals_;
  torch::nn::Linear last_ = nullptr;
};

}  // namespace flies
