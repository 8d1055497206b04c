#include "flies/classify/opencv_network.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <system_error>

#include "flies/core/error.hpp"

namespace flies {
namespace {

std::uintmax_t size_of(const std::string& file) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  if (error) throw InputError(file, "", "cannot be read: " + error.message());
  return bytes;
}

void check_weights(cv::dnn::Net& network, const std::string& weights_file, const std::string& cfg_file) {
  std::size_t numbers = 0;
  bool are_finite = true;
  for (const auto& name : network.getLayerNames()) {
    const auto layer = network.getLayer(network.getLayerId(name));
    if (layer->type == "Region") continue;  // has anchors, which stand in the .cfg
    for (const auto& blob : layer->blobs) {
      numbers += blob.total();
      are_finite = are_finite && cv::checkRange(blob);
    }
  }
  const auto bytes = size_of(weights_file), needed = numbers * sizeof(float);
  if (bytes < needed)
    throw InputError(weights_file, "",
                     fmt::format("has {} bytes, and the network in {} needs at least {}: it is another network's, or "
                                 "was cut short",
                                 bytes, cfg_file, needed));
  if (!are_finite) throw InputError(weights_file, "", "holds weights that are no finite numbers: it is damaged");
}

}  // namespace

cv::dnn::Net read_darknet(const std::string& cfg_file, const std::string& weights_file) {
  // OpenCV does not ask whether there is a header.
  if (constexpr std::size_t kHeader = 20; size_of(weights_file) < kHeader)
    throw InputError(weights_file, "", "is too short to be a file of weights");
  cv::dnn::Net network = cv::dnn::readNetFromDarknet(cfg_file, weights_file);
  check_weights(network, weights_file, cfg_file);
  return network;
}

}  // namespace flies
