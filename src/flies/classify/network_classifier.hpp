#pragma once

#include <array>
#include <memory>
#include <string>
#include <string_view>

#include "flies/classify/people_classifier.hpp"
#include "flies/core/options.hpp"

namespace flies {

/// What a network's output means.
enum class NetworkOutput { probability, logit, softmax };
template <>
struct EnumNames<NetworkOutput> {
  static constexpr std::array<std::string_view, 3> names = {"probability", "logit", "softmax"};
};

/// How windows are shown to a network, and what is read from it: the side file `<network>.yaml`.
struct NetworkOptions {
  int input_width_px = 48;
  int input_height_px = 96;
  int channels = 1;
  double mean = 0.0;
  double scale = 1.0 / 255.0;
  int person_index = 0;
  NetworkOutput output = NetworkOutput::probability;
  double threshold = 0.5;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("input_width_px", self.input_width_px, Range{1, 1024}, "size that windows are resized to");
    field("input_height_px", self.input_height_px, Range{1, 1024}, "size that windows are resized to");
    field("channels", self.channels, Range{1, 3}, "grey levels are repeated in each; layout N x C x H x W");
    field("mean", self.mean, Range{-1e6, 1e6}, "subtracted from the grey levels, 0 to 255");
    field("scale", self.scale, Range{-1e6, 1e6}, "that the difference is multiplied with");
    field("person_index", self.person_index, Range{0, 1000000},
          "which of the numbers for a window says person, from 0");
    field("output", self.output,
          "what that number is: a probability, its log-odds, or one of all of which softmax is taken");
    field("threshold", self.threshold, Range{0.0, 1.0}, "a window is a person when its probability exceeds this");
  }
};

/// Whether the file's name ends as that of a network: .onnx, .cfg, .weights, .prototxt or .caffemodel.
bool is_network_file(const std::string& path);

/// A network that OpenCV's dnn module reads: ONNX, Darknet (.cfg and .weights beside each other) or Caffe (.prototxt
/// and .caffemodel; without the latter for networks that have no weights). Beside it lies `<network>.yaml`, which may
/// be empty.
/// @param path any of the network's files
/// @throws InputError naming the file: missing, not read by OpenCV, cut short, other outputs than the side file says.
///         Its `classify` throws, too, when the network gives numbers that are not finite
std::shared_ptr<const PeopleClassifier> network_classifier(const std::string& path);

}  // namespace flies
