#include "flies/classify/classify.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

#include "flies/classify/hog.hpp"
#include "flies/core/error.hpp"

namespace flies {
namespace {

/// A person of 1.75 m as a camera of 720 px at 1.65 m sees them.
Roi person(double x_m, double y_m, double height_m = 1.75) {
  Roi roi;
  const double tall_px = 720.0 * height_m / x_m;
  roi.person = {610.0 - 720.0 * y_m / x_m - tall_px / 4.0, 173.0 + 720.0 * 1.65 / x_m - tall_px, tall_px / 2.0,
                tall_px};
  roi.x_m = x_m;
  roi.y_m = y_m;
  roi.height_m = height_m;
  return roi;
}

/// Whatever the picture shows, the windows get the probabilities that the test wants them to have, in their order.
class FixedClassifier final : public PeopleClassifier {
 public:
  explicit FixedClassifier(std::vector<double> probabilities) : probabilities_(std::move(probabilities)) {}
  const std::string& name() const override { return name_; }
  double threshold() const override { return 0.5; }
  std::vector<double> classify(const GrayView&, std::span<const ImageBox> windows) const override {
    std::vector<double> result;
    for (const ImageBox& window : windows) result.push_back(probabilities_[static_cast<std::size_t>(window.u_px)]);
    return result;
  }

 private:
  std::string name_ = "fixed";
  std::vector<double> probabilities_;
};

/// The model's threshold, all of the few boxes of every place, and none between them.
ClassifyOptions plain_looks() {
  ClassifyOptions options;
  options.threshold_offset = options.one_stage_threshold_offset = 0.0;
  options.min_second_probability = 0.0;
  options.min_refined_probability = 1.0;
  return options;
}

std::vector<Pedestrian> find(std::vector<Roi> rois, const std::vector<double>& probabilities,
                             const ClassifyOptions& options = plain_looks()) {
  for (std::size_t i = 0; i < rois.size(); ++i) {
    rois[i].window.u_px = static_cast<double>(i);
    rois[i].obstacle = i;
  }
  return find_people({}, rois, FixedClassifier(probabilities), options).pedestrians;
}

TEST(FindPeople, IsEmptyWithoutRois) { EXPECT_TRUE(find({}, {}).empty()); }

TEST(FindPeople, MakesOnePersonOfManyBoxes) {
  const auto people = find({person(10, 0), person(10, 0.2), person(10.4, -0.2), person(9.5, 0.1), person(10, 0, 1.2)},
                           {0.8, 0.95, 0.7, 0.9, 0.6});
  ASSERT_EQ(people.size(), 1U);
  EXPECT_DOUBLE_EQ(people[0].x_m, 10.0);
  EXPECT_DOUBLE_EQ(people[0].y_m, 0.2);
  EXPECT_DOUBLE_EQ(people[0].range_m, std::hypot(10.0, 0.2));
  EXPECT_DOUBLE_EQ(people[0].height_m, 1.75);
  EXPECT_DOUBLE_EQ(people[0].probability, 0.95);
  EXPECT_DOUBLE_EQ(people[0].box.height_px, 126.0);
}

TEST(FindPeople, KeepsTwoPeopleSideBySide) {
  EXPECT_EQ(find({person(10, 0), person(10, 1.0)}, {0.8, 0.9}).size(), 2U);
  EXPECT_EQ(find({person(10, 0), person(10, 0.5)}, {0.8, 0.9}).size(), 2U);
}

TEST(FindPeople, KeepsPeopleAtTwoRangesWhoSeeEachOthersEdge) {
  EXPECT_EQ(find({person(6, 0), person(12, 1.0)}, {0.8, 0.9}).size(), 2U);
}

TEST(FindPeople, SeesNobodyThroughAnother) {
  const auto people = find({person(6, 0), person(12, 0.2)}, {0.9, 0.8});
  ASSERT_EQ(people.size(), 1U);
  EXPECT_DOUBLE_EQ(people[0].x_m, 6.0);
}

TEST(FindPeople, MakesOnePersonOfLikeBoxesAtTwoRanges) {
  const auto people = find({person(9, 0, 1.5), person(11, 0, 1.85)}, {0.8, 0.9});
  ASSERT_EQ(people.size(), 1U);
  EXPECT_DOUBLE_EQ(people[0].x_m, 11.0);
}

TEST(FindPeople, ReportsNearestFirst) {
  const auto people = find({person(20, 0), person(5, -2), person(10, 3)}, {0.9, 0.7, 0.8});
  ASSERT_EQ(people.size(), 3U);
  EXPECT_LT(people[0].range_m, people[1].range_m);
  EXPECT_LT(people[1].range_m, people[2].range_m);
}

TEST(FindPeople, ComparesWithTheThresholdAndItsOffset) {
  EXPECT_EQ(find({person(10, 0)}, {0.5}).size(), 0U) << "the probability must exceed the threshold";
  EXPECT_EQ(find({person(10, 0)}, {0.6}).size(), 1U);
  ClassifyOptions options;
  options.threshold_offset = options.one_stage_threshold_offset = std::log(2.0);  // 1 : 1 becomes 2 : 1;
  EXPECT_EQ(find({person(10, 0)}, {0.6}, options).size(), 0U);
}

TEST(FindPeople, IgnoresRefusedWindows) { EXPECT_TRUE(find({person(10, 0), person(10, 0)}, {0.0, 0.0}).empty()); }

TEST(FindPeople, RefusesAnswersThatAreNoProbabilities) {
  for (const double wrong : {std::nan(""), -0.1, 1.1})
    EXPECT_THROW(find({person(10, 0), person(10, 0)}, {0.0, wrong}), InputError) << wrong;
}

/// Sure of all windows at first, of some only at the second look.
class SecondThoughts final : public PeopleClassifier {
 public:
  const std::string& name() const override { return name_; }
  double threshold() const override { return 0.5; }
  bool looks_twice() const override { return true; }
  double screen_threshold() const override { return 0.1; }
  std::vector<double> screen(const GrayView&, std::span<const ImageBox> windows) const override {
    return std::vector<double>(windows.size(), 0.2);
  }
  std::vector<double> classify(const GrayView&, std::span<const ImageBox> windows) const override {
    std::vector<double> result;
    for (const ImageBox& window : windows) result.push_back(window.u_px > 0.0 ? 0.9 : 0.1);
    return result;
  }

 private:
  std::string name_ = "second thoughts";
};

TEST(FindPeople, LetsTheLastWordDecide) {
  std::vector<Roi> rois{person(10, 0), person(10, 4)};
  rois[1].obstacle = 1;
  rois[0].window.u_px = -1.0;
  rois[1].window.u_px = 1.0;
  ClassifyOptions options = plain_looks();
  options.votes = 1;
  const ClassifyResult result = find_people({}, rois, SecondThoughts(), options);
  EXPECT_EQ(result.screened, (std::vector<double>{0.2, 0.2}));
  ASSERT_EQ(result.pedestrians.size(), 1U);
  EXPECT_DOUBLE_EQ(result.pedestrians[0].y_m, 4.0);
  EXPECT_DOUBLE_EQ(result.pedestrians[0].probability, 0.9);
}

/// Finds a window as probable as its left edge says.
class PlaceTells final : public PeopleClassifier {
 public:
  const std::string& name() const override { return name_; }
  double threshold() const override { return 0.5; }
  bool looks_twice() const override { return true; }
  std::vector<double> classify(const GrayView&, std::span<const ImageBox> windows) const override {
    std::vector<double> result;
    for (const ImageBox& window : windows) result.push_back(window.u_px);
    return result;
  }

 private:
  std::string name_ = "place tells";
};

TEST(FindPeople, LooksAtOtherHeightsOnlyWhereTheMiddleOneMayBeAPerson) {
  struct Box {
    std::size_t obstacle;
    double height_m, probability;
    bool is_looked_at;
  };
  const std::vector<Box> boxes{{0, 1.3, 0.9, false},  {0, 1.6, 0.004, true}, {0, 1.6, 0.003, true},
                               {0, 1.9, 0.8, false},  {1, 1.3, 0.7, true},   {1, 1.6, 0.002, true},
                               {1, 1.6, 0.006, true}, {1, 1.9, 0.6, true},   {2, 1.9, 0.3, true}};
  std::vector<Roi> rois;
  std::vector<double> all, looked_at;
  for (const Box& box : boxes) {
    rois.push_back(person(10, 4.0 * static_cast<double>(box.obstacle), box.height_m));
    rois.back().obstacle = box.obstacle;
    rois.back().window.u_px = box.probability;
    all.push_back(box.probability);
    looked_at.push_back(box.is_looked_at ? box.probability : 0.0);
  }
  ClassifyOptions options = plain_looks();
  options.min_middle_probability = 0.005;
  EXPECT_EQ(find_people({}, rois, PlaceTells(), options).screened, looked_at);
  options.min_middle_probability = 0.0;
  EXPECT_EQ(find_people({}, rois, PlaceTells(), options).screened, all);
}

TEST(FindPeople, PlacesThePersonBetweenTheBoxesOfItsObstacleByTheirOdds) {
  const std::vector<Roi> rois = [] {
    std::vector<Roi> two{person(10, 0, 1.6), person(10, 0, 1.9)};
    for (std::size_t i = 0; i < two.size(); ++i) two[i].window.u_px = static_cast<double>(i);
    return two;
  }();
  const auto found = find_people({}, rois, FixedClassifier({0.9, 0.75}), plain_looks()).pedestrians;  // odds 9 and 3
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].height_m, 0.75 * 1.6 + 0.25 * 1.9, 1e-9);
  EXPECT_NEAR(found[0].box.height_px, 0.75 * rois[0].person.height_px + 0.25 * rois[1].person.height_px, 1e-9);
  EXPECT_DOUBLE_EQ(found[0].probability, 0.9);
}

/// Its first look falls from window to window, its second is as the test wants it, in the order of the windows.
class TwoLooks final : public PeopleClassifier {
 public:
  explicit TwoLooks(std::vector<double> second) : second_(std::move(second)) {}
  const std::string& name() const override { return name_; }
  double threshold() const override { return 0.5; }
  bool looks_twice() const override { return true; }
  double screen_threshold() const override { return 0.1; }
  std::vector<double> screen(const GrayView&, std::span<const ImageBox> windows) const override {
    std::vector<double> result;
    for (const ImageBox& window : windows) result.push_back(0.9 - 0.01 * window.u_px);
    return result;
  }
  std::vector<double> classify(const GrayView&, std::span<const ImageBox> windows) const override {
    windows_seen += windows.size();
    std::vector<double> result;
    for (const ImageBox& window : windows) result.push_back(second_[static_cast<std::size_t>(window.u_px)]);
    return result;
  }
  mutable std::size_t windows_seen = 0;

 private:
  std::string name_ = "two looks";
  std::vector<double> second_;
};

/// As many boxes over each other at two places.
std::vector<Roi> boxes_at_two_places(std::size_t at_each) {
  std::vector<Roi> rois;
  for (std::size_t i = 0; i < 2 * at_each; ++i) {
    const std::size_t place = i / at_each;
    rois.push_back(person(10, 4.0 * static_cast<double>(place), 1.6 + 0.01 * static_cast<double>(i % at_each)));
    rois.back().window.u_px = static_cast<double>(i);
    rois.back().obstacle = place;
  }
  return rois;
}

TEST(FindPeople, BelievesBoxesThatAgree) {
  ClassifyOptions options = plain_looks();
  options.second_looks = 4;
  options.votes = 3;
  const TwoLooks classifier({0.1, 0.8, 0.8, 0.8, 0.95, 0.1, 0.1, 0.1});
  const auto rois = boxes_at_two_places(4);
  const auto agreed = find_people({}, rois, classifier, options).pedestrians;
  ASSERT_EQ(agreed.size(), 1U);
  EXPECT_NEAR(agreed[0].y_m, 0.0, 1e-9);
  EXPECT_NEAR(agreed[0].probability, 0.8, 1e-9);
  options.votes = 1;
  EXPECT_EQ(find_people({}, rois, classifier, options).pedestrians.size(), 2U);
  options.votes = 2;  // the mean log-odds of 0.95 and 0.1, 2.94 and -2.20
  const auto two = find_people({}, rois, classifier, options).pedestrians;
  ASSERT_EQ(two.size(), 2U);
  EXPECT_NEAR(two[1].probability, 1.0 / (1.0 + std::exp(-(std::log(19.0) - std::log(9.0)) / 2.0)), 1e-9);
}

TEST(FindPeople, CountsBoxesThatTheFirstLookRefusedAgainstAPlace) {
  ClassifyOptions options = plain_looks();
  options.second_looks = 2;
  options.votes = 2;
  EXPECT_EQ(find_people({}, boxes_at_two_places(1), TwoLooks({0.8, 0.95}), options).pedestrians.size(), 1U)
      << "0.1, which the first look asks for, outweighs 0.8, not 0.95";
}

TEST(FindPeople, LooksTwiceAtAFewBoxesOfAPlace) {
  ClassifyOptions options = plain_looks();
  options.second_looks = 3;
  const TwoLooks classifier({0.6, 0.6, 0.6, 0.99, 0.6, 0.6, 0.6, 0.99});
  const auto people = find_people({}, boxes_at_two_places(4), classifier, options).pedestrians;
  EXPECT_EQ(classifier.windows_seen, 6U);
  ASSERT_EQ(people.size(), 2U);
  EXPECT_NEAR(people[0].probability, 0.6, 1e-9);
  EXPECT_NEAR(people[0].height_m, 1.61, 1e-9) << "the mean of what was looked at";
}

TEST(FindPeople, SeesOneBoxOfHopelessPlaces) {
  ClassifyOptions options = plain_looks();
  options.second_looks = 4;
  options.min_second_probability = 0.3;
  const TwoLooks classifier({0.2, 0.9, 0.9, 0.9, 0.9, 0.9, 0.9, 0.9});
  const auto people = find_people({}, boxes_at_two_places(4), classifier, options).pedestrians;
  EXPECT_EQ(classifier.windows_seen, 1U + 4U);
  ASSERT_EQ(people.size(), 1U);
  EXPECT_NEAR(people[0].y_m, 4.0, 1e-9);
}

/// At second look surer of windows the nearer their left edge is to one that no proposed box has.
class KnowsWhere final : public PeopleClassifier {
 public:
  const std::string& name() const override { return name_; }
  double threshold() const override { return 0.5; }
  bool looks_twice() const override { return true; }
  double screen_threshold() const override { return 0.1; }
  std::vector<double> screen(const GrayView&, std::span<const ImageBox> windows) const override {
    return std::vector<double>(windows.size(), 0.9);
  }
  std::vector<double> classify(const GrayView&, std::span<const ImageBox> windows) const override {
    std::vector<double> result;
    for (const ImageBox& window : windows)
      result.push_back(std::abs(window.u_px - 4.0) < 0.5 && window.height_px == 100.0 ? 0.9 : 0.4);
    return result;
  }

 private:
  std::string name_ = "knows where";
};

TEST(FindPeople, LooksBetweenTheBoxesWhereAPersonSeemsToBe) {
  Roi roi = person(10, 0);
  roi.window = {0.0, 0.0, 50.0, 100.0};
  ClassifyOptions options = plain_looks();
  options.votes = 1;
  EXPECT_TRUE(find_people({}, std::vector{roi}, KnowsWhere(), options).pedestrians.empty());
  options.min_refined_probability = 0.3;
  const auto people = find_people({}, std::vector{roi}, KnowsWhere(), options).pedestrians;
  ASSERT_EQ(people.size(), 1U) << "a box 0.04 of the window's height to the right";
  EXPECT_NEAR(people[0].probability, 0.9, 1e-9);
  EXPECT_LT(people[0].y_m, 0.0) << "right is negative";
  options.min_refined_probability = 0.5;
  EXPECT_TRUE(find_people({}, std::vector{roi}, KnowsWhere(), options).pedestrians.empty());
}

TEST(ForClassifier, PutsBoxesWhereTheFirstLookSharesItsFeatures) {
  PeopleModel model;
  model.hog.window_width_px = 40;
  model.hog.window_height_px = 80;
  model.linear.weights.assign(feature_count(model.hog), 0.0F);
  const auto classifier = model_classifier(model);
  EXPECT_DOUBLE_EQ(for_classifier({}, *classifier).step, 0.1) << "8 of 80 px";
  EXPECT_DOUBLE_EQ(for_classifier({.step = 0.3}, *classifier).step, 0.3) << "set by hand";
  EXPECT_DOUBLE_EQ(for_classifier({}, FixedClassifier({})).step, step_between_boxes({})) << "it does not say";
}

TEST(ReportThreshold, StaysAProbability) {
  const FixedClassifier classifier({});
  const auto with_offset = [&](double offset) {
    ClassifyOptions options;
    options.threshold_offset = options.one_stage_threshold_offset = offset;
    return report_threshold(classifier, options);
  };
  EXPECT_DOUBLE_EQ(with_offset(0.0), 0.5);
  EXPECT_DOUBLE_EQ(with_offset(std::log(3.0)), 0.75);
  EXPECT_LE(with_offset(100.0), 1.0);
  EXPECT_GE(with_offset(-100.0), 0.0);
}

TEST(ReportThreshold, HasAnOffsetOfItsOwnForModelsOfOneStage) {
  ClassifyOptions options;
  options.threshold_offset = 0.0;
  options.one_stage_threshold_offset = std::log(3.0);
  EXPECT_DOUBLE_EQ(report_threshold(FixedClassifier({}), options), 0.75);
  EXPECT_DOUBLE_EQ(report_threshold(TwoLooks({}), options), 0.5);
}

}  // namespace
}  // namespace flies
