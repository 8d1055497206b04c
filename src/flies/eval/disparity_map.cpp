#include "flies/eval/disparity_map.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>

#include "flies/core/error.hpp"
#include "flies/eval/text.hpp"
#include "flies/io/image_codecs.hpp"
#include "flies/io/image_file.hpp"

namespace flies {
namespace {

constexpr double kReach_m = 60.0;  // farther points are off by metres, and would only blur the road's plane
constexpr double kLevelsPerPixel = 256.0;

}  // namespace

std::vector<LidarPoint> read_disparity_map(const std::filesystem::path& file, const StereoCamera& camera) {
  const std::string bytes = detail::read_truth(file);
  if (const std::string fault = detail::image_file_fault(bytes); !fault.empty())
    throw InputError(file.string(), "", fault);
  const cv::Mat map = decode_image(bytes);
  if (map.empty() || map.type() != CV_16UC1)
    throw InputError(file.string(), "", "is no image of 16-bit grey, expected disparities times 256");
  check_camera_fits(camera, map.cols, map.rows, file.string());

  const Projection projection(camera);
  std::vector<Point3> points;
  for (int v = 0; v < map.rows; ++v) {
    const auto* row = map.ptr<std::uint16_t>(v);
    for (int u = 0; u < map.cols; ++u) {
      const double disparity_px = row[u] / kLevelsPerPixel;
      if (row[u] == 0 || disparity_px <= projection.disparity_offset_px()) continue;
      const Point3 point = projection.triangulate({static_cast<double>(u), static_cast<double>(v), disparity_px});
      if (point.x_m < kReach_m) points.push_back(point);
    }
  }
  return measure_above_road(points);
}

}  // namespace flies
