#include "flies/reproduce/reproduce.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "flies/core/error.hpp"
#include "flies/reproduce/report.hpp"

namespace flies {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kExact = 1e-6;  // sums of a few floats
constexpr double kAhead_m = 9.0;

/// A person alone on a road, small enough to render and search in a moment.
const LabelledFrame& person_ahead() {
  static const LabelledFrame frame = [] {
    SceneOptions options;
    options.kind = SceneKind::pedestrian;
    options.people_min_range_m = kAhead_m;
    options.width_px = 480;
    options.height_px = 240;
    options.focal_px = 400.0;
    options.samples_per_side = 1;
    return render_labelled_frame(options, "person");
  }();
  return frame;
}

PersonOptions few_seeds(int seeds = 3) {
  PersonOptions options;
  options.seeds = seeds;
  return options;
}

Population flies_at(const std::vector<Fly>& list) {
  Population flies;
  for (const auto& fly : list) flies.push_back(fly.point, fly.fitness);
  return flies;
}

TEST(WeightedRmsDistance, WeighsSquaresByFitness) {
  // (1 * 3^2 + 3 * 1^2) / 4 = 3; height does not count.
  const auto flies = flies_at({{{13.0, 0.0, 1.0}, 1.0F}, {{10.0, 1.0, 2.0}, 3.0F}});
  ASSERT_TRUE(weighted_rms_distance_m(flies, {10.0, 0.0}));
  EXPECT_NEAR(*weighted_rms_distance_m(flies, {10.0, 0.0}), std::sqrt(3.0), kExact);
}

TEST(WeightedRmsDistance, IsNothingWithoutFitness) {
  EXPECT_FALSE(weighted_rms_distance_m({}, {10.0, 0.0}));
  EXPECT_FALSE(weighted_rms_distance_m(flies_at({{{13.0, 0.0, 1.0}, 0.0F}}), {10.0, 0.0}));
}

TEST(FliesInView, KeepsThoseBetweenTheEdges) {
  ViewAngle view;
  view.min_azimuth_rad = 0.1;
  view.max_azimuth_rad = 0.2;
  const auto at = [](double azimuth) { return Fly{{10.0, 10.0 * std::tan(azimuth), 1.0}, 2.0F}; };
  const auto inside = flies_in_view(flies_at({at(0.09), at(0.15), at(0.21), at(0.11)}), view);
  ASSERT_EQ(inside.size(), 2u);
  EXPECT_NEAR(inside.y_m[0], 10.0 * std::tan(0.15), 1e-5);  // float
  EXPECT_EQ(inside.fitness[1], 2.0F);
}

TEST(SpreadOf, TakesTheMiddleAndTheEndsOfWhatIsThere) {
  const std::vector<std::optional<double>> odd = {3.0, std::nullopt, 1.0, 10.0}, even = {4.0, 1.0};
  EXPECT_EQ(spread_of(odd)->median, 3.0);
  EXPECT_EQ(spread_of(odd)->min, 1.0);
  EXPECT_EQ(spread_of(odd)->max, 10.0);
  EXPECT_EQ(spread_of(odd)->count, 3u);
  EXPECT_EQ(spread_of(even)->median, 2.5);
  EXPECT_FALSE(spread_of({}));
  EXPECT_FALSE(spread_of(std::vector<std::optional<double>>(2)));
}

TEST(RenderLabelledFrame, KnowsWhereThePersonIs) {
  const auto people = people_in(person_ahead().truth);
  ASSERT_EQ(people.size(), 1u);
  // The nearest tenth of its surface lies between the edge and the middle of its footprint.
  EXPECT_GT(people[0].range_m(), kAhead_m - 1.0);
  EXPECT_LT(people[0].range_m(), std::hypot(people[0].middle.x_m, people[0].middle.y_m));
  EXPECT_GT(people[0].width_m, 0.2);
  EXPECT_TRUE(people[0].others.empty()) << "nothing else stands clear of the road";
}

TEST(PeopleIn, LeavesOutTheFarTheHiddenAndThings) {
  FrameTruth truth;
  const auto add = [&](const char* type, double x_m, bool visible) {
    LabelledObject object;
    object.type = type;
    object.footprint = {x_m, 0.0, 0.0, 0.6, 0.6};
    object.visible = visible;
    truth.objects.push_back(object);
  };
  add("Pedestrian", 15.0, true);
  add("Cyclist", 20.0, true);
  add("Pedestrian", 45.0, true);
  add("Pedestrian", 15.0, false);
  add("Car", 15.0, true);
  const auto people = people_in(truth);
  ASSERT_EQ(people.size(), 2u);
  EXPECT_NEAR(people[0].near.x_m, 14.7, kExact) << "without returns the near face of the label";
  EXPECT_FALSE(people[0].others.empty()) << "without returns the outlines of the other labels";
}

TEST(MeasurePerson, FindsFitnessCloserToThePersonByEquation2) {
  const auto& frame = person_ahead();
  const auto person = people_in(frame.truth).at(0);
  const auto experiment = measure_person(frame.images.view(), frame.camera, person, few_seeds(5));
  ASSERT_EQ(experiment.runs.size(), 5u);
  std::vector<std::optional<double>> louchet, covariance, shift;
  for (const auto& run : experiment.runs) {
    louchet.push_back(run.rms_louchet_m);
    covariance.push_back(run.rms_covariance_m);
    if (run.evolved) shift.emplace_back(std::abs(run.evolved->shifted_x_m));
    EXPECT_EQ(run.rms_covariance_alone_m, run.rms_covariance_m) << "there is nothing else to leave out";
  }
  ASSERT_TRUE(spread_of(louchet) && spread_of(covariance) && spread_of(shift));
  EXPECT_LT(spread_of(covariance)->median, spread_of(louchet)->median);
  constexpr double kClose_m = 0.6;  // mean shift of 3000 flies; a tenth of the field would be 4 m
  EXPECT_LT(spread_of(shift)->median, kClose_m);
}

TEST(MeasurePerson, CentresTheViewAngleOnThePersonAndKeepsItsFlies) {
  const auto& frame = person_ahead();
  auto person = people_in(frame.truth).at(0);
  person.near.y_m += 0.1;
  const auto e = measure_person(frame.images.view(), frame.camera, person, few_seeds(1));
  const double azimuth = std::atan2(person.near.y_m, person.near.x_m);
  EXPECT_NEAR(0.5 * (e.louchet_view.min_azimuth_rad + e.louchet_view.max_azimuth_rad), azimuth, kExact);
  ASSERT_EQ(e.louchet.size(), e.covariance.size());
  EXPECT_EQ(e.louchet.x_m, e.covariance.x_m) << "both equations score the same flies";
  EXPECT_NE(e.louchet.fitness, e.covariance.fitness);
  double votes = 0.0, fitness = 0.0;
  for (const double vote : e.covariance_view.votes) votes += vote;
  for (const float f : flies_in_view(e.covariance, e.covariance_view).fitness) fitness += f;
  EXPECT_NEAR(votes, fitness, 1e-3 * fitness);
}

TEST(MeasurePerson, LeavesOutFliesAtOtherThings) {
  const auto& frame = person_ahead();
  auto person = people_in(frame.truth).at(0);
  // Things all along the line of sight: only the flies at the person are left.
  for (double x_m = 3.0; x_m < 46.0; x_m += 0.2)
    for (int k = 0; k < MatchOptions{}.min_lidar_points; ++k)
      person.others.push_back({x_m, x_m * person.near.y_m / person.near.x_m});
  const auto experiment = measure_person(frame.images.view(), frame.camera, person, few_seeds());
  ASSERT_EQ(experiment.runs.size(), 3u);
  for (const auto& run : experiment.runs) {
    ASSERT_TRUE(run.rms_louchet_alone_m && run.rms_louchet_m);
    // A fly at the person is within the radius at its own range, which the radius itself may add to.
    const double radius_m = MatchOptions{}.radius_at_m(1.2 * person.range_m());
    EXPECT_LE(*run.rms_louchet_alone_m, radius_m);
    EXPECT_GT(*run.rms_louchet_m, radius_m);
  }
}

TEST(MeasurePerson, RejectsSomeoneOutsideAllViewAngles) {
  auto person = people_in(person_ahead().truth).at(0);
  person.near = {1.0, 10.0};
  EXPECT_THROW(measure_person(person_ahead().images.view(), person_ahead().camera, person, few_seeds(1)), InputError);
}

TEST(Reproduce, RejectsASetWithoutPeople) { EXPECT_THROW(reproduce({"empty", "", {}}, few_seeds()), InputError); }

class Report : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    const FrameSet set{"<one> & only", "A person.", {person_ahead(), person_ahead()}};
    ReportSet part{set.title, set.description, {"first", "second"}, reproduce(set, options()), {}};
    part.figures = paper_figures(set, part.result, options());
    sets_ = new std::vector<ReportSet>{std::move(part)};
  }
  static void TearDownTestSuite() { delete sets_; }
  static PersonOptions options() { return few_seeds(2); }
  static const std::vector<ReportSet>& sets() { return *sets_; }
  inline static const ReportContext kContext{"flies reproduce", "flies 1", "a CPU"};

 private:
  inline static std::vector<ReportSet>* sets_ = nullptr;
};

TEST_F(Report, HasARowForEveryMeasureAndAPictureForEveryFigure) {
  ASSERT_FALSE(experiment_rows().empty());
  EXPECT_EQ(sets()[0].result.rows.size(), experiment_rows().size());
  std::vector<std::string> numbers;
  for (const auto& figure : sets()[0].figures) {
    numbers.push_back(figure.number);
    EXPECT_FALSE(figure.picture.empty()) << figure.number;
    EXPECT_EQ(figure.picture.type(), CV_8UC3) << figure.number;
  }
  EXPECT_THAT(numbers, ::testing::ElementsAre("2a", "2b", "3a", "3b", "3c", "4, top left", "4, top right",
                                              "4, bottom left", "4, bottom right", "5"));
}

TEST_F(Report, HoldsItsPicturesAndLoadsNothing) {
  const std::string html = html_report(sets(), options(), kContext);
  std::size_t pictures = 0;
  for (auto at = html.find("<img "); at != std::string::npos; at = html.find("<img ", at + 1)) {
    EXPECT_THAT(html.substr(html.find(" src=\"", at), 16), HasSubstr("src=\"data:image"));
    ++pictures;
  }
  EXPECT_EQ(pictures, sets()[0].figures.size());
  for (const char* loader : {"http:", "https:", "<script", "<link", "url(", "@import"})
    EXPECT_THAT(html, Not(HasSubstr(loader)));
  EXPECT_THAT(html, HasSubstr("&lt;one&gt; &amp; only"));
  EXPECT_THAT(html, HasSubstr("a CPU"));
  EXPECT_THAT(html, HasSubstr("evolve.flies: 3000"));
}

TEST_F(Report, GivesTheSameNumbersAsJson) {
  const auto json = nlohmann::json::parse(json_report(sets(), options(), kContext));
  EXPECT_EQ(json.at("paper").at("rms_ratio"), 0.43);
  EXPECT_TRUE(json.at("paper").at("rms_ratio_without_others").is_null());
  const auto& set = json.at("sets").at(0);
  EXPECT_EQ(set.at("people").size(), 2u);
  EXPECT_EQ(set.at("people")[0].at("runs").size(), 2u);
  for (const auto& row : experiment_rows()) EXPECT_TRUE(set.at("table").contains(std::string(row.key))) << row.key;
  EXPECT_NEAR(set.at("table").at("rms_eq1_m").at("median").get<double>(), sets()[0].result.rows[1]->median, kExact);
  EXPECT_GT(set.at("timing").at("median_ms").at("evolve").get<double>(), 0.0);
}

TEST_F(Report, RepeatsItselfWithTheSameSeeds) {
  const FrameSet set{"again", "", {person_ahead()}};
  const auto first = reproduce(set, options()), second = reproduce(set, options());
  ASSERT_EQ(first.rows.size(), experiment_rows().size());
  ASSERT_EQ(second.rows.size(), experiment_rows().size());
  for (std::size_t i = 0; i < first.rows.size(); ++i) {
    const auto &a = first.rows[i], &b = second.rows[i];
    ASSERT_EQ(a.has_value(), b.has_value());
    EXPECT_EQ(a ? a->median : 0.0, b ? b->median : 0.0) << experiment_rows()[i].key;
  }
}

}  // namespace
}  // namespace flies
