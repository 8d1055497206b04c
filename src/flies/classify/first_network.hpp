#pragma once

#include <span>
#include <vector>

#include "flies/classify/convolution_layer.hpp"
#include "flies/classify/people_model.hpp"
#include "flies/classify/window_sets.hpp"
#include "flies/core/gray_view.hpp"

namespace flies {

/// The network's score as it is defined, in double precision: slow.
/// @param levels grey levels of a window resized to `kFirstNetworkWidth_px` x `kFirstNetworkHeight_px`, row by row
double first_network_score(const FirstNetwork& network, std::span<const float> levels);

/// The same for all windows of a set at once, in whole numbers of 16 bits with exact sums.
class FirstNetworkMachine {
 public:
  /// @param network that `check_people_model` finds nothing wrong with
  explicit FirstNetworkMachine(const FirstNetwork& network);

  WindowRaster raster() const { return {kFirstNetworkWidth_px, kFirstNetworkHeight_px, stride_}; }

  /// As `first_network_score` but for rounding, and the same on every machine. Thread-safe.
  /// @param set by `raster()`
  /// @returns one score per window of the set
  std::vector<double> scores(const GrayView& image, const WindowSet& set) const;

 private:
  int stride_;
  std::vector<WholeLayer> layers_;
  std::size_t width_, height_;  ///< of what the last layer makes of a window
  std::vector<float> last_;
  double bias_;
};

}  // namespace flies
