#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "flies/eval/kitti_truth.hpp"
#include "flies/io/calibration.hpp"
#include "flies/io/images.hpp"
#include "tests/blackbox/blackbox.hpp"

namespace flies::blackbox {
namespace {

constexpr const char* kFolder = "kitti_object/training";
constexpr double kMinFound = 0.9;  // of the road users near enough to brake for
constexpr double kNear_m = 25.0;

TEST(BlackBoxKittiObject, FindsTheNearObjects) {
  const auto folder = find_data(kFolder);
  if (!folder) GTEST_SKIP() << absence(kFolder);
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(*folder / "label_2")) {
    names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  ASSERT_FALSE(names.empty());

  std::vector<ScoredFrame> frames;
  Rate near;
  for (const auto& name : names) {
    const auto left = *folder / "image_2" / (name + ".png"), right = *folder / "image_3" / (name + ".png");
    const GrayImage size = load_gray_image(left.string());
    CalibrationRequest request;
    request.width_px = size.width_px;
    request.height_px = size.height_px;
    const auto camera = load_calibration((*folder / "calib" / (name + ".txt")).string(), request).camera;
    Detector detector(camera);
    frames.push_back(detect_and_score(detector, left, right, read_kitti_object(*folder, name, camera)));
    print_table("KITTI object " + name, tabulate({frames.back()}));
    for (std::size_t i = 0; i < frames.back().truth.objects.size(); ++i) {
      const auto& verdict = frames.back().score.objects[i];
      if (!verdict.counted || near_range_m(frames.back().truth.objects[i].footprint) > kNear_m) continue;
      near.hits += verdict.found;
      ++near.total;
    }
  }
  print_summary(frames);
  ASSERT_GT(near.total, 0);
  EXPECT_GE(*near.value(), kMinFound) << near.hits << " of " << near.total << " objects nearer than " << kNear_m
                                      << " m";
}

}  // namespace
}  // namespace flies::blackbox
