#include "flies/core/pair_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "flies/core/random.hpp"
#include "flies/io/calibration.hpp"
#include "flies/io/images.hpp"
#include "flies/io/pair_source.hpp"
#include "flies/io/temporary_folder.hpp"
#include "flies/io/test_data.hpp"

namespace flies {
namespace {

using flies::testing::error_of;
using ::testing::HasSubstr;

constexpr int kWidth_px = 600;
constexpr int kHeight_px = 200;
const StereoCamera kCamera{700, 700, 300, 300, 100, 0.5, kWidth_px, kHeight_px, {}};

/// Random square blocks, moved to the left by `disparity_px`.
GrayImage blocks(std::uint64_t seed, int disparity_px, int side_px = 6) {
  GrayImage image{kWidth_px, kHeight_px, {}};
  for (int v = 0; v < kHeight_px; ++v)
    for (int u = 0; u < kWidth_px; ++u) {
      const auto column = static_cast<std::uint32_t>((u + disparity_px + 6000) / side_px);
      image.pixels.push_back(
          static_cast<std::uint8_t>(FlyRandom(seed, 0, column, static_cast<std::uint32_t>(v / side_px)).below(256)));
    }
  return image;
}

TEST(GatherPairEvidence, SaysNothingOfImagesLowerThanAPatch) {
  const std::vector<std::uint8_t> levels(64 * 5, 100);
  const GrayView image{levels.data(), 64, 5, 64};
  EXPECT_EQ(gather_pair_evidence({image, image}, kCamera).patches, 0);
  const GrayView narrow{levels.data(), 5, 64, 5};
  EXPECT_EQ(gather_pair_evidence({narrow, narrow}, kCamera).patches, 0);
}

TEST(GatherPairEvidence, TellsNearFromBeyondAndDistant) {
  const auto left = blocks(1, 0);
  const auto evidence_at = [&](int disparity_px, double cx_right_px) {
    auto camera = kCamera;
    camera.cx_right_px = cx_right_px;
    const auto right = blocks(1, disparity_px);
    return gather_pair_evidence({left.view(), right.view()}, camera);
  };
  const auto near = evidence_at(20, 300), beyond = evidence_at(-20, 300), distant = evidence_at(0, 300);
  EXPECT_GT(near.nearer, 0.9 * near.patches);
  EXPECT_EQ(near.beyond, 0);
  EXPECT_GT(beyond.beyond, 0.9 * beyond.patches);
  EXPECT_EQ(beyond.nearer, 0);
  EXPECT_GT(distant.distant, 0.9 * distant.patches);
  // The right principal point 40 px to the right puts infinity at a disparity of -40 px.
  EXPECT_GT(evidence_at(-20, 340).nearer, 0.9 * near.patches);
}

TEST(CheckTruePair, PassesAPairAndNamesASwappedOne) {
  const auto left = blocks(1, 0), right = blocks(1, 20);
  EXPECT_NO_THROW(check_true_pair({left.view(), right.view()}, kCamera, "l.png", "r.png"));
  EXPECT_THAT(error_of([&] {
                check_true_pair({right.view(), left.view()}, kCamera, "l.png", "r.png");
              }),
              HasSubstr("l.png: left and right seem to be swapped"));
  EXPECT_THAT(error_of([&] {
                check_not_swapped({right.view(), left.view()}, kCamera, "l.png", "r.png");
              }),
              HasSubstr("swapped"));
}

TEST(CheckTruePair, NamesUnrelatedImages) {
  const auto left = blocks(1, 0), other = blocks(2, 0);
  EXPECT_THAT(error_of([&] {
                check_true_pair({left.view(), other.view()}, kCamera, "l.png", "r.png");
              }),
              HasSubstr("r.png: not a pair with l.png"));
}

TEST(CheckTruePair, NamesImagesOfWhichNothingIsFoundButAFewPlacesBeyondInfinity) {
  constexpr int kFine_px = 2;  // of which nothing is found by chance
  const auto left = blocks(1, 0, kFine_px), moved = blocks(1, -20, kFine_px);
  auto other = blocks(2, 0, kFine_px);
  // Two cells of the grid in four rows of patches.
  for (int v = 0; v < kHeight_px / 2; ++v)
    std::copy_n(moved.pixels.begin() + v * kWidth_px + 224, 74, other.pixels.begin() + v * kWidth_px + 224);
  const RectifiedPair pair{left.view(), other.view()};
  const auto evidence = gather_pair_evidence(pair, kCamera);
  EXPECT_GT(evidence.beyond, 0.045 * evidence.patches) << "more than by chance";
  EXPECT_LT(evidence.beyond, 12) << "too few to say that they are swapped";
  EXPECT_EQ(evidence.nearer + evidence.distant, 0);
  EXPECT_THAT(error_of([&] { check_true_pair(pair, kCamera, "l.png", "r.png"); }),
              HasSubstr("r.png: not a pair with l.png"));
  EXPECT_EQ(order_of_pair(pair, kCamera), PairOrder::unrelated);
}

TEST(CheckTruePair, DoesNotJudgeScenesWithoutTexture) {
  const GrayImage gray{kWidth_px, kHeight_px, std::vector<std::uint8_t>(kWidth_px * kHeight_px, 90)};
  EXPECT_NO_THROW(check_true_pair({gray.view(), gray.view()}, kCamera, "l", "r"));
}

TEST(CheckTruePair, TakesTheSmallestAndTheOddestSizes) {
  for (const auto& [width_px, height_px] : {std::pair{64, 48}, std::pair{20000, 48}, std::pair{64, 5000}}) {
    GrayImage image{width_px, height_px, std::vector<std::uint8_t>(static_cast<std::size_t>(width_px * height_px))};
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
      image.pixels[i] = static_cast<std::uint8_t>(i * 2654435761U >> 24);
    EXPECT_NO_THROW(check_true_pair({image.view(), image.view()}, kCamera, "l", "r")) << width_px;
  }
}

struct RealPair {
  std::string scene;
  GrayPair images;
  StereoCamera camera;
};

std::vector<RealPair> real_pairs(const std::filesystem::path& data) {
  std::vector<RealPair> pairs;
  const auto add = [&](const std::string& scene, const std::filesystem::path& left, const std::filesystem::path& right,
                       const Calibration& calibration) {
    pairs.push_back({scene, load_pair(left.string(), right.string()), calibration.camera});
  };
  CalibrationRequest gray;
  gray.cameras = {0, 1};
  const auto raw = data / "kitti_raw/2011_09_26";
  const auto calibration = load_calibration((raw / "calib_cam_to_cam.txt").string(), gray);
  const auto drive = raw / "2011_09_26_drive_0005_sync";
  const auto frames = find_pairs((drive / "image_00/data").string(), (drive / "image_01/data").string());
  for (std::size_t i = 0; i < frames.size(); i += 10) add("drive 5", frames[i].left, frames[i].right, calibration);
  const auto object = data / "kitti_object/training";
  for (const auto& [left, right] : find_pairs((object / "image_2").string(), (object / "image_3").string())) {
    const auto name = std::filesystem::path(left).stem().string();
    add(name, left, right, load_calibration((object / "calib" / (name + ".txt")).string()));
  }
  const auto eth = data / "eth_bahnhof/rectified";
  for (int i = 0; i < 5; ++i) {
    const std::string name = "image_0000000" + std::to_string(i);
    add("eth", eth / (name + "_0.png"), eth / (name + "_1.png"), load_calibration((eth / "extrinsics.yml").string()));
  }
  return pairs;
}

TEST(CheckTruePair, JudgesRealPairs) {
  const auto kitti = testing::find_data("kitti_raw");
  if (!kitti) GTEST_SKIP() << testing::absence("kitti_raw");
  const auto data = kitti->parent_path();
  const auto pairs = real_pairs(data);
  int mismatches = 0, noticed = 0;
  for (const auto& pair : pairs) {
    const auto view = pair.images.view();
    EXPECT_NO_THROW(check_true_pair(view, pair.camera, "l", "r")) << pair.scene;
    EXPECT_THAT(error_of([&] {
                  check_true_pair({view.right, view.left}, pair.camera, "l", "r");
                }),
                HasSubstr("swapped"))
        << pair.scene;
    for (const auto& other : pairs) {
      const auto right = other.images.view().right;
      if (other.scene == pair.scene || right.width_px != view.left.width_px || right.height_px != view.left.height_px)
        continue;
      ++mismatches;
      noticed += error_of([&] { check_true_pair({view.left, right}, pair.camera, "l", "r"); }) != "no error";
    }
  }
  constexpr double kNoticedShare = 0.9;  // some streets look alike row by row: the rest is a miss we accept
  EXPECT_GT(noticed, kNoticedShare * mismatches) << noticed << " of " << mismatches;
}

}  // namespace
}  // namespace flies
