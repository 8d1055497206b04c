#include <algorithm>
#include <array>
#include <string_view>

#include "flies/eval/dataset.hpp"
#include "flies/train/training_picture.hpp"

namespace flies {
namespace {

constexpr std::array<std::string_view, 4> kPeople = {"Pedestrian", "Person_sitting", "Person (sitting)", "Cyclist"};
constexpr double kMinDepth_m = 0.5;  // what is nearer is not in the picture

/// Head to feet at the object's middle; nothing when it is not before the camera.
void mark(const LabelledObject& object, const Projection& projection, std::vector<ImageBox>& people) {
  if (std::find(kPeople.begin(), kPeople.end(), object.type) == kPeople.end()) return;
  const Point3 feet{object.footprint.x_m, object.footprint.y_m, object.bottom_z_m};
  const Point3 head{feet.x_m, feet.y_m, feet.z_m + object.height_m};
  if (projection.depth_m(feet) < kMinDepth_m || projection.depth_m(head) < kMinDepth_m) return;
  const StereoPoint low = projection.project(feet), high = projection.project(head);
  const double width_px = projection.fx_px() * seen_width_m(object.footprint) / projection.depth_m(feet);
  people.push_back({(low.u_px + high.u_px - width_px) / 2.0, high.v_px, width_px, low.v_px - high.v_px});
}

}  // namespace

std::vector<TrainingPicture> find_proposals(std::span<const std::string> folders, const DetectorOptions& options) {
  std::vector<TrainingPicture> result;
  for (const auto& folder : folders) {
    const Dataset dataset = open_dataset(folder);
    for (std::size_t i = 0; i < dataset.pairs.size(); ++i) {
      const TruthFrame frame = dataset.load(i);
      // A detector of its own for each pair: what is proposed then does not depend on which pairs came before.
      const Detection detection = Detector(frame.camera, options).process(frame.images.view());
      TrainingPicture picture;
      picture.path = dataset.pairs[i].left;
      picture.has_proposals = true;
      for (const auto& roi : detection.rois) picture.proposals.push_back(roi.window);
      for (const auto& object : frame.truth.objects) mark(object, Projection(frame.camera), picture.unclear);
      result.push_back(std::move(picture));
    }
  }
  return result;
}

}  // namespace flies
