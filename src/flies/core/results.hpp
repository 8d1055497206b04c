#pragma once

#include <array>
#include <string_view>
#include <vector>

namespace flies {

/// An axis-aligned box in the left image; (u, v) is its top-left corner. It may reach beyond the image.
struct ImageBox {
  double u_px = 0.0;
  double v_px = 0.0;
  double width_px = 0.0;
  double height_px = 0.0;
};

/// An object of interest: something that stands on the ground ahead. Its position is on its near face, where flies saw
/// it nearest; of something wide that need not be the middle.
struct Obstacle {
  double x_m = 0.0;      ///< position in the vehicle frame: forward
  double y_m = 0.0;      ///< position in the vehicle frame: left
  double range_m = 0.0;  ///< horizontal distance from the point below the left camera, hypot(x, y)
  double width_m = 0.0;  ///< seen across the line of sight
  double middle_offset_m =
      0.0;                  ///< of the middle of its width from its position, across the line of sight, to the left
  double depth_m = 0.0;     ///< seen along it, behind the near face; 0 when only a face across it is seen
  double height_m = 0.0;    ///< of its top above the road
  double ground_z_m = 0.0;  ///< height of the road under it in the vehicle frame; 0 on the nominal ground
  double score = 0.0;       ///< summed fitness of its flies over the population; comparable for equal options
  ImageBox box;             ///< in the left image
  double range_sd_m = 0.0;  ///< standard deviation of the range (`range_deviation_m`); 0 when not worked out
};

/// A person: one verdict of the classifier after non-maximum suppression on the ground.
struct Pedestrian {
  double x_m = 0.0;
  double y_m = 0.0;
  double range_m = 0.0;
  double height_m = 0.0;     ///< head above feet
  double probability = 0.0;  ///< that this is a person, by the classifier
  ImageBox box;              ///< tight around the person, head to feet
  double range_sd_m = 0.0;   ///< standard deviation of the range; 0 when not worked out
};

/// The stages of the pipeline in order. Their names key the timings in JSON, the benchmark rows and the docs.
enum class Stage { road, evolve, scan, concentrate, propose, classify };
inline constexpr std::array<std::string_view, 6> kStageNames = {"road",        "evolve",  "scan",
                                                                "concentrate", "propose", "classify"};
inline constexpr std::size_t kStageCount = kStageNames.size();

/// Wall-clock time of each stage in milliseconds, indexed by `Stage`.
using StageTimes_ms = std::array<double, kStageCount>;

}  // namespace flies
