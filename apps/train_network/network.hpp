#pragma once

#include <torch/torch.h>

#include <span>
#include <string>
#include <vector>

#include "flies/classify/people_model.hpp"
#include "windows.hpp"

namespace flies {

/// Windows, one after the other, as the network takes them; the tensor looks at `pixels` and does not own them.
torch::Tensor batch_of(std::vector<float>& pixels, std::size_t count);

/// Which of a model's stages a network is.
enum class NetworkStage { first, last };

/// A network while it is trained: convolutions, each followed by rectification, then one sum. In the last stage the
/// convolutions have zeros around the picture and are followed by batch normalisation; in the first they have neither,
/// nor biases, see `FirstNetwork`.
class Network {
 public:
  explicit Network(NetworkStage stage);

  torch::nn::Sequential& module() { return module_; }

  /// Makes what the network takes of a window's grey levels.
  void prepare(std::span<float> levels) const;
  /// One score a window. @param batch of windows that are prepared
  torch::Tensor forward(const torch::Tensor& batch);

  /// Sizes of all its weights, as text: tells networks of other shapes apart.
  std::string shape();

  /// One score a window, as the network is now.
  std::vector<float> scores(const std::vector<Picture>& pictures, const std::vector<Place>& places);

  /// The same network as plain values: normalisation becomes part of weights and biases; all weights rounded to 16
  /// bits.
  /// @param sample whose activations tell how large they become
  ConvolutionStage last_stage(const std::vector<Picture>& pictures, const std::vector<Place>& sample);
  FirstNetwork first_stage(const std::vector<Picture>& pictures, const std::vector<Place>& sample);

 private:
  void add_layers();
  /// Calls with a filled batch after the other.
  template <class Use>
  void for_batches(const std::vector<Picture>& pictures, const std::vector<Place>& places, const Use& use) const;
  torch::Tensor kernels_of(std::size_t layer) const;
  torch::Tensor convolved(const torch::Tensor& batch, std::size_t layer);
  /// To the pixels of the first stage.
  torch::Tensor resized(const torch::Tensor& batch) const;
  std::vector<float> last_weights() const;
  void note_largest(const std::vector<Picture>& pictures, const std::vector<Place>& sample,
                    std::vector<ConvolutionLayer>& layers);

  NetworkStage stage_;
  torch::nn::Sequential module_;  ///< all of these one after the other
  std::vector<torch::nn::Conv2d> convolutions_;
  std::vector<torch::nn::BatchNorm2d> normals_;  ///< of the last stage
  torch::nn::Dropout dropout_ = nullptr;
  torch::nn::Linear last_ = nullptr;
  torch::Tensor rows_, columns_;  ///< resize a window to that of the first stage, by `resized`
};

}  // namespace flies
