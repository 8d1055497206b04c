#pragma once

#include <torch/torch.h>

#include <functional>
#include <string>
#include <vector>

#include "flies/classify/people_model.hpp"
#include "windows.hpp"

namespace flies {

/// The network while it is trained: convolutions, each followed by batch normalisation and rectification, then one sum.
class Network {
 public:
  Network();

  torch::nn::Sequential& module() { return module_; }

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

struct LearningOptions {
  std::uint64_t seed = 1;
  int epochs = 24;
  int steps = 400;  ///< batches an epoch
};

/// Called after every epoch: its number from 1, the mean loss, hard windows without people known so far.
using LearningProgress = std::function<void(int epoch, double loss, std::size_t hard)>;

/// Trains on half people and half background, of which half is what the network took for people before.
void learn(Network& network, const std::vector<Picture>& pictures, const LearningOptions& options,
           const LearningProgress& progress);

}  // namespace flies
