#include "flies/draw/track_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "flies/draw/paint.hpp"
#include "flies/draw/scan_paint.hpp"
#include "flies/draw/top_view.hpp"

namespace flies {
namespace {

using namespace paint;

constexpr int kMinHeight_px = 560;  ///< of the whole picture: the bird's-eye view needs it
constexpr int kPanelHeight_px = 58;
constexpr int kMargin_px = 14;
constexpr double kShown_m = 40.0, kHalfWidth_m = 14.0;
constexpr double kMoves_mps = 0.3;  ///< slower ones are drawn as standing
constexpr double kArrow_s = 1.0;    ///< arrows show the way of the next second
const cv::Scalar kMovingColor{0, 140, 255};

double speed_mps(const Track& track) { return std::hypot(track.velocity.vx_mps, track.velocity.vy_mps); }
double range_m(const Track& track) { return std::hypot(track.state.x_m, track.state.y_m); }

cv::Scalar color_of(const Track& track) {
  if (track.kind == TrackClass::person) return kPedestrianColor;
  return speed_mps(track) > kMoves_mps ? kMovingColor : range_color(range_m(track));
}

bool matters(const Track& track) { return track.kind == TrackClass::person || speed_mps(track) > kMoves_mps; }

std::string label_of(const Track& track) {
  const std::string name = fmt::format("{} {:.0f} m", track.id, range_m(track));
  return speed_mps(track) > kMoves_mps ? name + fmt::format(", {:.1f} m/s", speed_mps(track)) : name;
}

void put_tracks_on_image(cv::Mat& image, const TrackedPicture& picture) {
  put_scan_on_road(image, picture.scanned.scan, picture.scanned.camera, picture.scanned.road);
  const auto box_of = [](const Track& track) { return pixel_rect(track.box); };
  for (auto track = picture.tracks.rbegin(); track != picture.tracks.rend(); ++track)
    if (track->unseen_s == 0.0) cv::rectangle(image, box_of(*track), color_of(*track), matters(*track) ? 2 : 1);
  LabelPlacer labels({{}, image.size()});
  for (const bool first : {true, false})
    for (const auto& track : picture.tracks)
      if (track.unseen_s == 0.0 && matters(track) == first)
        labels.put(image, label_of(track), box_of(track), color_of(track));
}

void put_tracks_on_ground(cv::Mat& canvas, const GroundPlot& plot, const TrackedPicture& picture,
                          const std::map<std::uint64_t, std::vector<TrackView::Step>>& trails) {
  cv::Mat ground = canvas(plot.area);
  for (const auto& track : picture.tracks) {
    std::vector<cv::Point> way;
    for (const auto& step : trails.at(track.id)) way.push_back(plot.at(step.x_m, step.y_m));
    if (matters(track)) cv::polylines(ground, way, false, color_of(track), 2, cv::LINE_AA);
  }
  LabelPlacer labels({{}, ground.size()}, kPaper);
  for (const auto& track : picture.tracks) {
    const cv::Point at = plot.at(track.state.x_m, track.state.y_m);
    const int radius_px = std::max(3, pixel(0.5 * std::min(track.width_m, 1.8) * plot.view.pixels_per_m));
    const bool is_seen = track.unseen_s == 0.0;
    cv::circle(ground, at, radius_px, color_of(track), is_seen ? cv::FILLED : 1, cv::LINE_AA);
    if (is_seen) cv::circle(ground, at, radius_px, kInk, 1, cv::LINE_AA);
    if (speed_mps(track) > kMoves_mps)
      cv::arrowedLine(ground, at,
                      plot.at(track.state.x_m + kArrow_s * track.velocity.vx_mps,
                              track.state.y_m + kArrow_s * track.velocity.vy_mps),
                      kInk, 2, cv::LINE_AA, 0, 0.25);
    if (matters(track))
      labels.put(ground, fmt::format("{}", track.id),
                 {at.x - radius_px, at.y - radius_px, 2 * radius_px, 2 * radius_px}, kInk);
  }
}

void put_panel(cv::Mat& canvas, int top, const TrackedPicture& picture) {
  const auto moving = std::count_if(picture.tracks.begin(), picture.tracks.end(),
                                    [](const Track& track) { return speed_mps(track) > kMoves_mps; });
  const auto people = std::count_if(picture.tracks.begin(), picture.tracks.end(),
                                    [](const Track& track) { return track.kind == TrackClass::person; });
  const std::string ego =
      picture.ego.is_known ? fmt::format("own speed {:4.1f} m/s, turning {:+.2f} rad/s",
                                         std::hypot(picture.ego.vx_mps, picture.ego.vy_mps), picture.ego.yaw_rate_rps)
                           : std::string("own motion not known");
  put_text(canvas,
           fmt::format("{:6.2f} s   {}   {} tracks, {} move, {} {}", picture.time_s, ego, picture.tracks.size(), moving,
                       people, people == 1 ? "person" : "people"),
           {8, top + 22}, kWhite, kTitleText);
  int left = 8;
  const auto entry = [&](const cv::Scalar& color, const std::string& name) {
    cv::rectangle(canvas, cv::Rect(left, top + 36, 10, 14), color, 2);
    put_text(canvas, name, {left + 18, top + 48}, kWhite);
    left += 18 + text_size(name).width + 22;
  };
  entry(kPedestrianColor, "person");
  entry(kMovingColor, "moves");
  entry(range_color(0.0), "stands, near");
  entry(range_color(kShown_m), "stands, far");
  put_text(canvas, "number, range, speed over ground; arrow: the next second", {left, top + 48}, kGray);
}

}  // namespace

void TrackView::follow(const TrackedPicture& picture) {
  if (!picture.ego.is_known) trails_.clear();
  std::map<std::uint64_t, std::vector<Step>> kept;
  for (const auto& track : picture.tracks) {
    auto trail = std::move(trails_[track.id]);
    std::erase_if(trail, [&](const Step& step) { return step.time_s < picture.time_s - trail_s_; });
    for (auto& step : trail) {
      const Point3 now = picture.ego.current_from_previous({step.x_m, step.y_m, 0.0});
      step.x_m = now.x_m;
      step.y_m = now.y_m;
    }
    trail.push_back({picture.time_s, track.state.x_m, track.state.y_m});
    kept.emplace(track.id, std::move(trail));
  }
  trails_ = std::move(kept);
}

cv::Mat TrackView::draw(const TrackedPicture& picture) {
  follow(picture);
  const int height_px = std::max(picture.left.rows + kPanelHeight_px, kMinHeight_px);
  const double pixels_per_m = (height_px - kTopMargin_px - kBottomMargin_px) / (kShown_m + 2.5);
  const GroundPlot plot = ground_plot({kShown_m, kHalfWidth_m, pixels_per_m}, {picture.left.cols, 0});
  cv::Mat canvas(height_px, plot.area.br().x + kMargin_px, CV_8UC3, kWhite);
  canvas(cv::Rect(0, 0, picture.left.cols, height_px)).setTo(kPanel);

  cv::Mat image = canvas(cv::Rect({}, picture.left.size()));
  as_bgr(picture.left).copyTo(image);
  if (!image.empty()) put_tracks_on_image(image, picture);
  put_panel(canvas, picture.left.rows, picture);

  put_grid(canvas, plot, "from above");
  put_scan_on_ground(canvas, plot, picture.scanned.scan);
  put_field_of_view(canvas, plot, picture.scanned.camera);
  put_tracks_on_ground(canvas, plot, picture, trails_);
  return canvas;
}

}  // namespace flies
