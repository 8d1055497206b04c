#include "flies/draw/scan_paint.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "flies/core/free_space.hpp"
#include "flies/draw/paint.hpp"

namespace flies::paint {
namespace {

const cv::Vec3d kFreeTint{40, 220, 30};
const cv::Vec3d kUnknownTint{165, 165, 165};
constexpr double kFreeShare = 0.25;
constexpr double kUnknownShare = 0.6;

/// How far out an unknown sector is hatched: it is unknown all the way, but its foot says so.
constexpr double kUnknownFoot_m = 10.0;

constexpr int kHatchPeriod_px = 8, kHatchWidth_px = 3;

bool is_hatched(int u, int v) { return (u + v) % kHatchPeriod_px < kHatchWidth_px; }

void blend(cv::Vec3b& pixel, const cv::Vec3d& tint, double share) {
  for (int channel = 0; channel < 3; ++channel)
    pixel[channel] = cv::saturate_cast<uchar>((1.0 - share) * pixel[channel] + share * tint[channel]);
}

/// What is drawn of the ground at a place.
enum class Ground { plain, free, unknown };

Ground ground_at(const Scan& scan, double x_m, double y_m) {
  const auto sector = sector_at(scan, std::atan2(y_m, x_m));
  if (!sector) return Ground::plain;
  const double range_m = std::hypot(x_m, y_m);
  if (scan.states[*sector] == SectorState::unknown) return range_m < kUnknownFoot_m ? Ground::unknown : Ground::plain;
  return range_m < drivable_m(scan, *sector) ? Ground::free : Ground::plain;
}

void tint(cv::Vec3b& pixel, Ground ground, int u, int v) {
  if (ground == Ground::free) blend(pixel, kFreeTint, kFreeShare);
  if (ground == Ground::unknown && is_hatched(u, v)) blend(pixel, kUnknownTint, kUnknownShare);
}

void put_sample(cv::Mat& canvas, const cv::Rect& place, Ground ground) {
  const cv::Rect visible = place & cv::Rect({}, canvas.size());
  for (int v = visible.y; v < visible.br().y; ++v)
    for (int u = visible.x; u < visible.br().x; ++u) tint(canvas.at<cv::Vec3b>(v, u), ground, u, v);
  cv::rectangle(canvas, place, kGray);
}

}  // namespace

void put_scan_on_road(cv::Mat& image, const Scan& scan, const StereoCamera& camera, const RoadPlane& road) {
  if (scan.empty()) return;
  const Projection projection(camera);
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u) {
      const Point3 point = projection.meet_road(u, v, road);
      if (point.x_m > 0.0) tint(image.at<cv::Vec3b>(v, u), ground_at(scan, point.x_m, point.y_m), u, v);
    }
}

void put_scan_on_ground(cv::Mat& canvas, const GroundPlot& plot, const Scan& scan) {
  if (scan.empty()) return;
  cv::Mat ground = canvas(plot.area);
  const cv::Point origin = plot.at(0.0, 0.0);
  for (int v = 0; v < ground.rows; ++v)
    for (int u = 0; u < ground.cols; ++u) {
      const double x_m = (origin.y - v) / plot.view.pixels_per_m, y_m = (origin.x - u) / plot.view.pixels_per_m;
      if (x_m > 0.0) tint(ground.at<cv::Vec3b>(v, u), ground_at(scan, x_m, y_m), u, v);
    }
  for (std::size_t sector = 0; sector < scan.size(); ++sector) {
    const double range_m = scan.ranges_m[sector];
    if (scan.states[sector] != SectorState::obstacle || !std::isfinite(range_m)) continue;
    const double right_rad = scan.angle_rad(sector) - scan.angle_increment_rad / 2.0;
    const double left_rad = right_rad + scan.angle_increment_rad;
    cv::line(ground, plot.at(range_m * std::cos(right_rad), range_m * std::sin(right_rad)),
             plot.at(range_m * std::cos(left_rad), range_m * std::sin(left_rad)), kInk, 3, cv::LINE_AA);
  }
}

void put_free_sample(cv::Mat& canvas, const cv::Rect& place) { put_sample(canvas, place, Ground::free); }
void put_unknown_sample(cv::Mat& canvas, const cv::Rect& place) { put_sample(canvas, place, Ground::unknown); }

}  // namespace flies::paint
