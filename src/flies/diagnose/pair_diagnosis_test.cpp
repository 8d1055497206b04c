#include "flies/diagnose/pair_diagnosis.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "flies/diagnose/textured_pair.hpp"

namespace flies {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

StereoCamera camera(double cx_right_px = 320) {
  return {.fx_px = 400,
          .fy_px = 400,
          .cx_px = 320,
          .cx_right_px = cx_right_px,
          .cy_px = 80,
          .baseline_m = 0.5,
          .width_px = 640,
          .height_px = 240,
          .mount = {.height_m = 1.5}};
}

std::vector<std::string> complaints_of(const GrayPair& pair, const StereoCamera& camera) {
  return complaints(diagnose_pair(pair.view(), camera));
}

TEST(DiagnosePair, AGoodPairIsMatchedAndInRow) {
  const auto diagnosis = diagnose_pair(textured_pair(8.0, 0.0, 0.0).view(), camera());
  EXPECT_GT(diagnosis.textured_share, 0.9);
  EXPECT_GT(diagnosis.matched_share(), 0.5);
  EXPECT_EQ(diagnosis.evidence.beyond, 0);
  ASSERT_TRUE(diagnosis.rows);
  EXPECT_LT(diagnosis.rows->largest_px(), 0.3);
}

TEST(DiagnosePair, ToldIsARowErrorWithItsSize) {
  EXPECT_THAT(complaints_of(textured_pair(8.0, 2.0, 0.0), camera()), Contains(HasSubstr("lie +2.0 px lower")));
  EXPECT_THAT(complaints_of(textured_pair(8.0, 0.0, 0.0), camera()), Not(Contains(HasSubstr("lower"))));
}

TEST(Complaints, RowsFarApartAreNoBentRig) {
  PairDiagnosis diagnosis;
  diagnosis.textured_share = 0.8;
  diagnosis.road_found = true;
  diagnosis.rows = RowError{3.0, 0.0, 0.1, 100, 300.0};
  EXPECT_TRUE(can_be_made_up_for(*diagnosis.rows));
  EXPECT_THAT(complaints(diagnosis), ElementsAre(HasSubstr("--self-rectify")));
  diagnosis.rows->offset_px = 12.0;
  EXPECT_FALSE(can_be_made_up_for(*diagnosis.rows));
  EXPECT_THAT(complaints(diagnosis), ElementsAre(HasSubstr("raw or rectified")));
}

TEST(DiagnosePair, ToldIsACameraThatSeesPlacesBeyondInfinity) {
  // Infinity is at 20 px by this calibration, what is seen lies at 8.
  EXPECT_THAT(complaints_of(textured_pair(8.0, 0.0, 0.0), camera(300)), Contains(HasSubstr("beyond infinity")));
}

TEST(DiagnosePair, ToldIsThatThereIsNothingToSee) {
  const auto filled = [](std::uint8_t level) {
    const GrayImage image{640, 240, std::vector<std::uint8_t>(640 * 240, level)};
    return GrayPair{image, image};
  };
  EXPECT_THAT(complaints_of(filled(2), camera()), ElementsAre(HasSubstr("nearly black")));
  EXPECT_THAT(complaints_of(filled(254), camera()), ElementsAre(HasSubstr("nearly white")));
  EXPECT_THAT(complaints_of(filled(120), camera()), ElementsAre(HasSubstr("nearly uniform")));
}

TEST(DiagnosePair, ToldIsOnePictureTwice) {
  GrayPair pair = textured_pair(8.0, 0.0, 0.0);
  pair.right = pair.left;
  for (std::size_t i = 0; i < pair.right.pixels.size(); i += 7) pair.right.pixels[i] ^= 1;  // as compression leaves it
  EXPECT_FALSE(diagnose_pair(pair.view(), camera()).can_be_trusted());
  EXPECT_THAT(complaints_of(pair, camera()), ElementsAre(HasSubstr("the same picture twice")));
}

TEST(Complaints, AFewPlacesBeyondInfinityAreTold) {
  PairDiagnosis diagnosis;
  diagnosis.textured_share = 0.8;
  diagnosis.evidence = {.patches = 100, .nearer = 60, .beyond = 2, .distant = 8};
  diagnosis.road_found = true;
  EXPECT_TRUE(complaints(diagnosis).empty());  // two places say nothing
  diagnosis.evidence.beyond = 4;
  EXPECT_THAT(complaints(diagnosis), ElementsAre(HasSubstr("beyond infinity")));
  EXPECT_TRUE(diagnosis.can_be_trusted());
}

TEST(Complaints, SwappedImagesAreSaidToBeSwappedAndNothingThatFollows) {
  PairDiagnosis diagnosis;
  diagnosis.textured_share = 0.8;
  diagnosis.evidence = {.patches = 100, .nearer = 1, .beyond = 80};
  diagnosis.rows = RowError{.offset_px = 3.0, .corners = 100, .middle_u_px = 300.0};
  EXPECT_THAT(complaints(diagnosis), ElementsAre(HasSubstr("are left and right swapped")));
  diagnosis.evidence = {.patches = 100, .nearer = 40, .beyond = 30};
  EXPECT_THAT(complaints(diagnosis), Contains(HasSubstr("check cx of both cameras")));
}

TEST(Complaints, BeginWithWhatTheRestFollowsFrom) {
  PairDiagnosis diagnosis;
  diagnosis.textured_share = 0.8;
  diagnosis.evidence = {.patches = 100, .nearer = 7, .beyond = 5};
  diagnosis.rows = RowError{.corners = 60, .middle_u_px = 620, .growth = -0.03, .middle_v_px = 187};
  EXPECT_THAT(complaints(diagnosis),
              ElementsAre(HasSubstr("only 7 % of the places"),
                          HasSubstr("3.0 % smaller than the left one: possible causes are a late")));
  diagnosis.rows_spread_px = 6.7;
  EXPECT_THAT(complaints(diagnosis),
              ElementsAre(HasSubstr("only 7 %"), HasSubstr("images taken at different moments")));
  diagnosis.evidence = {.patches = 100, .nearer = 70, .beyond = 5};
  EXPECT_THAT(complaints(diagnosis), ElementsAre(HasSubstr("one late or hanging"), HasSubstr("beyond infinity"),
                                                 HasSubstr("no road was found")));
  diagnosis.evidence = {.patches = 100, .nearer = 70};
  diagnosis.road_found = true;
  EXPECT_THAT(complaints(diagnosis), ElementsAre(HasSubstr("or is one late or hanging in some pairs?")));
}

TEST(Complaints, AnImageThatIsLargerIsOnlyAZoomForSureWhereMostIsFoundAndTheRoadIsSeen) {
  PairDiagnosis diagnosis;
  diagnosis.textured_share = 0.8;
  diagnosis.rows = RowError{.corners = 280, .middle_u_px = 620, .growth = 0.009, .middle_v_px = 187};
  diagnosis.evidence = {.patches = 100, .nearer = 60};
  diagnosis.road_found = true;
  EXPECT_THAT(complaints(diagnosis), ElementsAre(HasSubstr("a zoom, or one image was resized differently")));
  diagnosis.evidence.nearer = 30;  // as where one image is a tenth of a second late
  EXPECT_THAT(
      complaints(diagnosis),
      ElementsAre(HasSubstr("0.9 % larger than the left one: possible causes are a late image, raw images with the")));
  diagnosis.evidence.nearer = 60;
  diagnosis.road_found = false;
  EXPECT_THAT(complaints(diagnosis), Contains(HasSubstr("possible causes are a late image")));
}

TEST(Complaints, ImagesOfTwoMomentsAndBlurOfBothAreTold) {
  PairDiagnosis diagnosis;
  diagnosis.textured_share = 0.8;
  diagnosis.road_found = true;
  diagnosis.right_steps.sharpness = 0.26;
  EXPECT_TRUE(complaints(diagnosis).empty());  // the sharper image says which
  diagnosis.left_steps.sharpness = 0.27;
  EXPECT_THAT(complaints(diagnosis), ElementsAre(HasSubstr("both images are blurred")));
  diagnosis.left_steps = {.combed_share = 0.9};
  EXPECT_THAT(complaints(diagnosis), ElementsAre(HasSubstr("every other row of the left image")));
}

TEST(Complaints, HiddenPartsAndScatteredRowsAreTold) {
  PairDiagnosis diagnosis;
  diagnosis.textured_share = 0.4;
  diagnosis.road_found = true;
  diagnosis.bright_share = 0.6;
  EXPECT_THAT(complaints(diagnosis), ElementsAre(HasSubstr("nearly white")));
  diagnosis.bright_share = 0.3;
  diagnosis.rows = RowError{0.1, 0.0, 1.2, 100, 300.0};
  EXPECT_THAT(complaints(diagnosis), ElementsAre(HasSubstr("1.2 px apart in parts of the image")));
}

TEST(DiagnosePair, ToldIsNoise) {
  GrayPair pair = textured_pair(8.0, 0.0, 0.0);
  EXPECT_THAT(complaints_of(pair, camera()), Not(Contains(HasSubstr("noisy"))));
  FlyRandom random(3, 0, 0, 0);
  GrayPair plain = pair;
  for (auto& level : plain.right.pixels) level = static_cast<std::uint8_t>(level / 40 + random.below(4));
  EXPECT_THAT(complaints_of(plain, camera()), Not(Contains(HasSubstr("noisy"))));
  for (auto& level : pair.right.pixels) level = static_cast<std::uint8_t>(level / 4 + random.below(32));
  EXPECT_THAT(complaints_of(pair, camera()), Contains(HasSubstr("the right image is noisy: its pixels vary by 9")));
}

TEST(DiagnosePair, ToldIsAnImageThatIsLarger) {
  EXPECT_THAT(complaints_of(textured_pair(8.0, 0.0, 0.0, 0.01), camera()),
              Contains(HasSubstr("the right image is 1.0 % larger than the left one")));
  EXPECT_THAT(complaints_of(textured_pair(8.0, 0.0, 0.0, -0.02), camera()),
              Contains(HasSubstr("the right image is 2.0 % smaller than the left one")));
  EXPECT_THAT(complaints_of(textured_pair(8.0, 0.0, 0.0, 0.003), camera()), Not(Contains(HasSubstr("larger"))));
}

TEST(DiagnosePair, ACameraHighAboveTheGroundHasNearThingsAbove) {
  // Near above, far below: what tree tops before the ground look like, and images that stand on their heads.
  const GrayPair near = textured_pair(20.0, 0.0, 0.0);
  GrayPair pair = textured_pair(8.0, 0.0, 0.0);
  const auto upper = static_cast<std::ptrdiff_t>(pair.right.pixels.size() / 2);
  std::copy_n(near.right.pixels.begin(), upper, pair.right.pixels.begin());
  StereoCamera high = camera();
  high.mount.height_m = 7.0;
  EXPECT_GT(diagnose_pair(pair.view(), camera()).nearer_above.value_or(0.0), 2.0);
  EXPECT_FALSE(diagnose_pair(pair.view(), high).nearer_above);
}

TEST(DiagnosePair, ToldIsThatFewPlacesAreFound) {
  GrayPair pair = textured_pair(8.0, 0.0, 0.0);
  const GrayPair other = textured_pair(8.0, 60.0, 0.0);
  pair.right = other.right;
  EXPECT_THAT(complaints_of(pair, camera()), Contains(HasSubstr("are found on the same row")));
}

TEST(DiagnoseRun, AddsUpWhatItsPairsSay) {
  const auto good = diagnose_pair(textured_pair(8.0, 1.0, 0.0).view(), camera());
  PairDiagnosis blank;
  const auto run = diagnose_run({good, blank, good});
  EXPECT_EQ(run.evidence.patches, 2 * good.evidence.patches);
  EXPECT_EQ(run.textured_share, good.textured_share);
  ASSERT_TRUE(run.rows);
  EXPECT_NEAR(run.rows->offset_px, 1.0, 0.1);
}

TEST(DiagnoseRun, PairsThatAreSwappedDoNotSayThatAPrincipalPointIsWrong) {
  PairDiagnosis good, swapped;
  good.textured_share = swapped.textured_share = 0.8;
  good.evidence = {.patches = 100, .nearer = 60, .distant = 5};
  good.road_found = true;
  good.rows = RowError{.offset_px = 1.0, .corners = 200, .middle_u_px = 320};
  swapped.evidence = {.patches = 100, .beyond = 60, .distant = 5};
  swapped.rows = RowError{.offset_px = -1.0, .corners = 200, .middle_u_px = 320};
  const auto run = diagnose_run({good, good, swapped, swapped, swapped});
  EXPECT_EQ(run.evidence.patches, 200);
  EXPECT_EQ(run.evidence.beyond, 0);
  EXPECT_TRUE(run.rows_agree());
  EXPECT_THAT(complaints(diagnose_run({swapped, swapped})), ElementsAre(HasSubstr("are left and right swapped")));
}

TEST(DiagnoseRun, ARigThatWasKnockedOnTheWayHasNoOneCorrection) {
  const auto run_of = [](const std::vector<double>& offsets_px) {
    std::vector<PairDiagnosis> pairs(offsets_px.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      pairs[i] = diagnose_pair(textured_pair(8.0, 0.0, 0.0).view(), camera());
      pairs[i].rows = RowError{.offset_px = offsets_px[i], .corners = 200, .middle_u_px = 320};
    }
    return diagnose_run(pairs);
  };
  const auto knocked = run_of({0.1, -0.1, 0.0, 4.0, 4.2}), bent = run_of({3.8, 4.0, 4.1, 4.0, 4.2});
  EXPECT_FALSE(knocked.rows_agree());
  EXPECT_THAT(complaints(knocked), Contains(HasSubstr("changes from pair to pair, by up to 4.3 px")));
  EXPECT_TRUE(bent.rows_agree());
  EXPECT_THAT(complaints(bent), Contains(HasSubstr("lie +4.0 px lower")));
}

TEST(DiagnoseRun, ARollThatBeginsOnTheWayHasNoOneCorrection) {
  const auto run_of = [](const std::vector<double>& slopes) {
    std::vector<PairDiagnosis> pairs(slopes.size());
    for (std::size_t i = 0; i < pairs.size(); ++i)
      pairs[i].rows = RowError{.slope = slopes[i], .corners = 200, .middle_u_px = 620, .middle_v_px = 187};
    return diagnose_run(pairs);
  };
  EXPECT_FALSE(run_of({0.0, 0.0, 0.0, 0.017, 0.017}).rows_agree());
  EXPECT_TRUE(run_of({0.017, 0.016, 0.017, 0.018, 0.017}).rows_agree());
  EXPECT_TRUE(run_of({-0.0006, 0.0006, 0.0, 0.0005, -0.0005}).rows_agree());  // as on a good drive
}

TEST(Complaints, ImagesOfTwoSizesAreNotSaidToBeMendedByMovingRows) {
  PairDiagnosis diagnosis;
  diagnosis.textured_share = 0.8;
  diagnosis.road_found = true;
  diagnosis.rows = RowError{.offset_px = 3.0, .corners = 200, .middle_u_px = 620, .growth = -0.02, .middle_v_px = 187};
  EXPECT_THAT(complaints(diagnosis),
              ElementsAre(HasSubstr("2.0 % smaller than the left one, and its rows lie +3.0 px")));
}

TEST(Complaints, AZoomIsNoKnock) {
  PairDiagnosis pair;
  pair.textured_share = 0.8;
  pair.road_found = true;
  pair.rows = RowError{.corners = 200, .middle_u_px = 620, .growth = 0.02, .middle_v_px = 187};
  PairDiagnosis other = pair;
  other.rows->growth = 0.017;
  EXPECT_THAT(complaints(diagnose_run({pair, other, pair})), ElementsAre(HasSubstr("2.0 % larger than the left one")));
}

TEST(Complaints, ImagesThatStandOnTheirHeadsHaveNearThingsAboveAndNoRoadBelow) {
  PairDiagnosis diagnosis;
  diagnosis.textured_share = 0.8;
  diagnosis.evidence = {.patches = 100, .nearer = 30};
  diagnosis.nearer_above = 1.1;
  EXPECT_THAT(complaints(diagnosis), Not(Contains(HasSubstr("upside down"))));
  diagnosis.nearer_above = 1.8;
  EXPECT_THAT(complaints(diagnosis), Contains(AllOf(HasSubstr("upside down"), HasSubstr("tree tops"))));
  diagnosis.road_found = true;
  EXPECT_TRUE(complaints(diagnosis).empty());
}

TEST(Complaints, ThereAreNoneWhereAllIsWell) {
  PairDiagnosis diagnosis;
  diagnosis.textured_share = 0.8;
  diagnosis.evidence = {.patches = 100, .nearer = 30, .beyond = 1, .distant = 8};
  diagnosis.road_found = true;
  EXPECT_TRUE(complaints(diagnosis).empty());
  diagnosis.road_found = false;
  EXPECT_THAT(complaints(diagnosis), ElementsAre(HasSubstr("--camera-height")));
}

}  // namespace
}  // namespace flies
