#include "synth/pasted_pairs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <limits>
#include <opencv2/core.hpp>

#include "flies/core/box_overlap.hpp"
#include "flies/core/error.hpp"
#include "flies/core/mat_view.hpp"
#include "flies/eval/footprint.hpp"
#include "flies/eval/yardstick.hpp"
#include "flies/io/calibration.hpp"
#include "flies/io/folder.hpp"
#include "flies/io/image_folder.hpp"
#include "flies/io/output_file.hpp"
#include "shared/notes.hpp"
#include "synth/synth_output.hpp"

namespace fs = std::filesystem;

namespace {

constexpr double kNearest_m = 2.0;               // of what is matched, to know what hides a person
constexpr double kPartly = 0.3, kLargely = 0.8;  // hidden, of what labels call so
constexpr const char* kPeople[] = {"Pedestrian", "Person", "Person_sitting", "Cyclist"};

bool is_person(const flies::LabelledObject& object) {
  return std::ranges::any_of(kPeople, [&](const char* type) { return object.type == type; });
}

/// The disparities of points that are known, by the left pixel that sees them; the nearest where several do.
std::vector<float> disparity_of(const std::vector<flies::LidarPoint>& points, const flies::StereoCamera& camera) {
  const flies::Projection projection(camera);
  std::vector<float> disparity_px(static_cast<std::size_t>(camera.width_px * camera.height_px),
                                  std::numeric_limits<float>::quiet_NaN());
  for (const auto& [point, above_road_m] : points) {
    if (projection.depth_m(point) <= 0.0) continue;
    const flies::StereoPoint at = projection.project(point);
    const long u = std::lround(at.u_px), v = std::lround(at.v_px);
    if (u < 0 || v < 0 || u >= camera.width_px || v >= camera.height_px) continue;
    float& known_px = disparity_px[static_cast<std::size_t>(v * camera.width_px + u)];
    if (!(known_px >= at.disparity_px)) known_px = static_cast<float>(at.disparity_px);
  }
  return disparity_px;
}

flies::ObjectClass kind_of(const flies::LabelledObject& object) {
  if (object.type == "Cyclist") return flies::ObjectClass::cyclist;
  if (is_person(object)) return flies::ObjectClass::pedestrian;
  for (std::size_t i = 0; i < flies::kObjectClassNames.size(); ++i) {
    std::string name(flies::kObjectClassNames[i]);
    name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
    if (object.type == name) return static_cast<flies::ObjectClass>(i);
  }
  return object.type == "Misc" ? flies::ObjectClass::box : flies::ObjectClass::car;  // vans, trucks, trams
}

/// How much of a labelled object is hidden, with those who were pasted before it.
double hidden_share(const flies::LabelledObject& object, const std::vector<flies::TruthObject>& pasted) {
  double share = object.occlusion == 0 ? 0.0 : object.occlusion == 1 ? kPartly : kLargely;
  if (object.visible) share = std::min(share, kPartly);
  const double area_px2 = std::max(1.0, flies::area_px2(object.box));
  for (const auto& person : pasted)
    if (person.near_range_m < flies::near_range_m(object.footprint))
      share += flies::intersection_px2(person.box, object.box) / area_px2;
  return std::min(share, 1.0);
}

/// What was labelled before, after the people.
void append_labelled(const flies::FrameTruth& truth, std::vector<flies::TruthObject>& objects) {
  const std::vector<flies::TruthObject> pasted = objects;
  for (const auto& labelled : truth.objects) {
    flies::TruthObject object;
    object.kind = kind_of(labelled);
    object.scene_index = objects.size();
    object.x_m = labelled.footprint.x_m;
    object.y_m = labelled.footprint.y_m;
    object.z_m = labelled.bottom_z_m;
    object.yaw_rad = labelled.footprint.yaw_rad;
    object.length_m = labelled.footprint.length_m;
    object.width_m = labelled.footprint.width_m;
    object.height_m = labelled.height_m;
    object.near_range_m = flies::near_range_m(labelled.footprint);
    object.whole_box = object.box = labelled.box;
    object.truncation = std::max(labelled.truncation, 1.0 - labelled.in_view_fraction);
    object.occlusion = labelled.visible ? hidden_share(labelled, pasted) : kLargely;
    object.visible_px =
        static_cast<std::size_t>((1.0 - object.occlusion) * std::max(0.0, flies::area_px2(labelled.box)));
    objects.push_back(object);
  }
}

void write_gray_png(const std::string& path, const flies::GrayImage& image) {
  flies::write_png(path, flies::mat_of(image.view()));
}

bool is_same(const flies::StereoCamera& a, const flies::StereoCamera& b) {
  return flies::calibration_yaml(a) == flies::calibration_yaml(b);
}

flies::Dataset open_pairs(const std::string& folder) {
  flies::DatasetRequest request;
  request.find_mount = true;
  return flies::open_dataset(folder, request);
}

/// The entry of a folder that a file lies in; empty when it lies elsewhere.
std::string entry_of(const std::string& folder, const std::string& file) {
  std::error_code ignored;
  const fs::path place = fs::weakly_canonical(file, ignored).lexically_relative(fs::weakly_canonical(folder, ignored));
  return place.empty() ? "" : place.begin()->string();
}

std::string name_of(std::size_t frame) { return fmt::format("{:06}", frame); }

}  // namespace

PastedPairs::PastedPairs(const std::string& people, const std::string& pairs, const flies::PasteOptions& options)
    : people_folder_(people), dataset_(open_pairs(pairs)), options_(options) {}

std::vector<std::string> PastedPairs::inputs() const {
  std::vector<std::string> files = dataset_.files;
  for (const auto& [left, right] : dataset_.pairs) files.insert(files.end(), {left, right});
  for (const auto& file : flies::detail::files_below(people_folder_, flies::detail::is_image_name))
    files.push_back(file.string());
  return files;
}

void PastedPairs::check_apart(const std::string& folder, const std::vector<std::string>& entries) const {
  for (const auto& input : inputs())
    if (std::ranges::find(entries, entry_of(folder, input)) != entries.end())
      throw flies::InputError(folder, "", fmt::format("{} in it is an input: choose another folder", input));
}

std::vector<std::size_t> PastedPairs::choose(int start, int step, std::optional<int> frames) const {
  std::vector<std::size_t> chosen, once;
  for (auto i = static_cast<std::size_t>(start); i < dataset_.pairs.size(); i += static_cast<std::size_t>(step))
    once.push_back(i);
  if (once.empty())
    throw flies::InputError("command line", "--start",
                            fmt::format("found {}, but there are {} pairs", start, dataset_.pairs.size()));
  const std::size_t count = frames ? static_cast<std::size_t>(*frames) : once.size();
  for (std::size_t i = 0; i < count; ++i) chosen.push_back(once[i % once.size()]);
  return chosen;
}

void PastedPairs::cut_out_people() {
  cut_outs_ = flies::load_cut_outs(people_folder_);
  say_notes(dataset_.notes);
}

void PastedPairs::write(const StagedFolder& folder, std::size_t frame, std::size_t pair) {
  const flies::TruthFrame real = dataset_.load(pair);
  const auto known_px = disparity_of(real.truth.map.empty() ? real.truth.lidar : real.truth.map, real.camera);
  const auto matched_px =
      flies::dense_disparity(real.images.view(), real.camera, flies::DenseMatcher::sgbm, kNearest_m);
  flies::RealPair into{real.images.view(), real.camera, known_px, matched_px, real.truth.ignored_regions};
  for (const auto& object : real.truth.objects)
    if (is_person(object)) into.keep_clear.push_back(object.box);
  flies::PastedPair pasted = flies::paste_people(into, cut_outs_.people, options_, static_cast<std::uint32_t>(frame));
  people_ += pasted.people.size();
  append_labelled(real.truth, pasted.people);

  const std::string name = name_of(frame);
  write_gray_png(folder.path("left/" + name + ".png"), pasted.left);
  write_gray_png(folder.path("right/" + name + ".png"), pasted.right);
  // Lidar of one turn is too thin to count as a map.
  if (!real.truth.map.empty()) write_disparity_png(folder.path("disparity/" + name + ".png"), pasted.pixels);
  flies::write_file(folder.path("label_2/" + name + ".txt"), flies::kitti_labels(pasted.people, real.camera));
  flies::write_file(folder.path("truth/" + name + ".json"),
                    flies::truth_json(pasted.people, real.camera, options_.seed));
  cameras_.push_back(real.camera);
}

void PastedPairs::write_cameras(const StagedFolder& folder) const {
  if (std::ranges::all_of(cameras_, [&](const auto& camera) { return is_same(camera, cameras_.front()); })) {
    flies::write_file(folder.path("calib.yaml"), flies::calibration_yaml(cameras_.front()));
    return;
  }
  for (std::size_t i = 0; i < cameras_.size(); ++i)
    flies::write_file(folder.path("calib/" + name_of(i) + ".yaml"), flies::calibration_yaml(cameras_[i]));
}

std::string PastedPairs::summary(const std::string& folder) const {
  return fmt::format(
      "{}: {} {}, {} people pasted, of {} who could be cut out of {} pictures\nnext: flies evaluate {} --missed\n",
      folder, cameras_.size(), cameras_.size() == 1 ? "pair" : "pairs", people_, cut_outs_.people.size(),
      cut_outs_.photographs, folder);
}
