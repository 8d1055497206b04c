#include "live/view_state.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <opencv2/core.hpp>
#include <system_error>
#include <utility>

#include "flies/classify/named_models.hpp"
#include "flies/core/free_space.hpp"
#include "flies/core/mat_view.hpp"
#include "flies/io/calibration.hpp"
#include "flies/io/image_codecs.hpp"
#include "flies/io/zip_archive.hpp"
#include "live/live_outputs.hpp"
#include "shared/method_arguments.hpp"

namespace {

using Json = nlohmann::ordered_json;

constexpr double kNearestGround_m = 2.0;  // nearer ground is below every picture

Json number(double value, double scale = 1e3) { return Json(std::round(value * scale) / scale + 0.0); }

/// A place on the road in the left image.
Json on_road_px(const LiveFrame& frame, const flies::Projection& projection, double angle_rad, double range_m) {
  const double x_m = range_m * std::cos(angle_rad), y_m = range_m * std::sin(angle_rad);
  const auto& road = frame.snapshot->tracking.detection.road.plane;
  const flies::StereoPoint point = projection.project({x_m, y_m, road.z_m(x_m, y_m)});
  return {number(point.u_px, 10), number(point.v_px, 10)};
}

/// Neighbouring sectors with free ground make one polygon: along its far edge and back along the near one.
Json free_polygons_px(const LiveFrame& frame) {
  const flies::Scan& scan = frame.snapshot->tracking.detection.scan;
  const flies::Projection projection(frame.camera);
  Json polygons = Json::array();
  for (std::size_t i = 0; i < scan.size();) {
    Json far = Json::array(), near = Json::array();
    for (; i < scan.size() && flies::drivable_m(scan, i) > kNearestGround_m; ++i)
      for (const double side : {-0.5, 0.5}) {
        const double angle_rad = scan.angle_rad(i) + side * scan.angle_increment_rad;
        far.push_back(on_road_px(frame, projection, angle_rad, flies::drivable_m(scan, i)));
        near.push_back(on_road_px(frame, projection, angle_rad, kNearestGround_m));
      }
    std::reverse(near.begin(), near.end());
    far.insert(far.end(), near.begin(), near.end());
    if (!far.empty()) polygons.push_back(std::move(far));
    while (i < scan.size() && flies::drivable_m(scan, i) <= kNearestGround_m) ++i;
  }
  return polygons;
}

std::string png(const flies::GrayImage& image) {
  const auto bytes = flies::encode_png(flies::mat_of(image.view()));
  return {bytes.begin(), bytes.end()};
}

/// With its whole path, for an archive is opened elsewhere; empty for a model that flies has by its name.
std::string file_of_model(const std::string& name_or_file) {
  if (name_or_file.empty() || std::ranges::count(flies::people_model_names(), name_or_file) > 0) return {};
  std::error_code error;
  const auto path = std::filesystem::absolute(name_or_file, error);
  return error ? name_or_file : path.string();
}

}  // namespace

Json view_frame(const LiveFrame& frame) {
  const auto& scan = frame.snapshot->tracking.detection.scan;
  Json state;
  state["number"] = frame.pair->number;
  state["width_px"] = frame.camera.width_px;
  state["height_px"] = frame.camera.height_px;
  state["half_view_rad"] = number(std::atan(0.5 * frame.camera.width_px / frame.camera.fx_px), 1e4);
  state["pose"] = {{"x_m", number(frame.pose.x_m)},
                   {"y_m", number(frame.pose.y_m)},
                   {"yaw_rad", number(frame.pose.yaw_rad, 1e5)},
                   {"segment", frame.pose.segment}};
  Json free_m = Json::array();
  for (const auto& point : flies::free_space(scan)) free_m.push_back({number(point.x_m), number(point.y_m)});
  state["free_m"] = std::move(free_m);
  state["free_px"] = free_polygons_px(frame);
  return state;
}

Json view_flies(const LiveFrame& frame) {
  const auto& evolved = frame.snapshot->tracking.detection.evolved;
  const auto& fitness = evolved.flies.fitness;
  const float most = fitness.empty() ? 0.0F : *std::ranges::max_element(fitness);
  Json flies = Json::array();
  for (std::size_t i = 0; i < fitness.size(); ++i)
    flies.push_back({number(evolved.in_image.u_px[i], 10), number(evolved.in_image.v_px[i], 10),
                     number(evolved.flies.x_m[i], 100), number(evolved.flies.y_m[i], 100),
                     number(most > 0.0F ? fitness[i] / most : 0.0, 1000)});
  return {{"number", frame.pair->number}, {"flies", std::move(flies)}};
}

Json view_options(const std::vector<flies::OptionListing>& listings) {
  Json options = Json::object();
  for (const char* path : {"evolve.flies", "field.x_max_m", "classify.threshold_offset", "track.min_probability"}) {
    const auto found = std::ranges::find(listings, path, &flies::OptionListing::path);
    if (found != listings.end()) options[path] = {{"value", std::stod(found->value)}, {"meaning", found->meaning}};
  }
  return options;
}

std::string view_report(const LiveFrame& frame, const std::vector<std::string>& notes) {
  const std::string model_file = file_of_model(frame.run->people_model);
  const std::string options_yaml =
      options_file_text(*frame.options, *frame.following, model_file.empty() ? frame.run->people_model : model_file);
  std::string told =
      "One pair and what flies found in it. To process it again:\n\n"
      "  flies detect left.png right.png --calib calib.yaml --options options.yaml --mount given --self-rectify off\n\n"
      "What flies had learnt from earlier pairs is not in it, so that the results may differ a little.\n";
  if (!model_file.empty())
    told += "The people model is not in this archive, either, but a file: " + model_file +
            "\nOn another machine, give its place there by --model.\n";
  told += "\nMessages of this run:\n";
  for (const auto& note : notes) told += "- " + note + "\n";
  const std::vector<flies::ZipEntry> entries = {
      {"README.txt", told},
      {"left.png", png(frame.pair->images.left)},
      {"right.png", png(frame.pair->images.right)},
      {"calib.yaml", flies::calibration_yaml(frame.camera)},
      {"options.yaml", options_yaml},
      {"result.json", json_line(frame)},
  };
  return flies::zip_archive(entries);
}
