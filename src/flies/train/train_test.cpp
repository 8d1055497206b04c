#include "flies/train/train.hpp"

#include <gmock/gmock.h>

#include "flies/classify/model_file.hpp"
#include "flies/train/toy_pictures.hpp"
#include "flies/train/training_report.hpp"

namespace flies {
namespace {

using ::testing::Gt;
using ::testing::HasSubstr;
using ::testing::SizeIs;

TrainOptions small_options() {
  TrainOptions options;
  options.false_positive_rate = 0.01;
  options.positives.jitters = 1;
  options.negatives.first = 120;
  options.negatives.rounds = 2;
  options.negatives.windows_per_picture = 60;
  options.negatives.validation_per_picture = 100;
  options.rbf.projection = 20;
  return options;
}

/// A set of toy pictures on disk.
class TrainPeople : public ::testing::Test {
 protected:
  TrainPeople() {
    testing::write_toy_data(folder_.file(""), 30, 12);
    data_.people = find_pictures_of_people(std::vector<std::string>{folder_.file("people")}, 0.75);
    data_.background = find_background(std::vector<std::string>{folder_.file("street")});
  }
  TrainingResult train(const TrainOptions& options, const TrainingProgress& progress = {}) const {
    Checkpoint checkpoint(folder_.file("work"), fingerprint_of(data_.people, data_.background, options));
    TrainingResult result = train_people(data_, options, checkpoint, progress);
    checkpoint.remove();
    return result;
  }
  std::string bytes(const TrainingResult& result) const { return people_model_text(result.model); }

  testing::TemporaryFolder folder_;
  TrainingData data_;
};

/// Share of new people and of new background that the model takes for people.
std::pair<double, double> shares_taken(const PeopleModel& model) {
  constexpr int kPictures = 40;
  int people = 0, background = 0;
  std::vector<float> features(feature_count(model.hog));
  for (int i = 0; i < kPictures; ++i) {
    for (const bool person : {true, false}) {
      cv::Mat picture = testing::toy_background(200, 160, 5000 + i);
      if (person) testing::draw_toy_person(picture, {100, 80}, 96);
      window_features({picture.data, 200, 160, 200}, {68, 16, 64, 128}, model.hog, features);
      (person ? people : background) += person_probability(model, features) > model.threshold;
    }
  }
  return {static_cast<double>(people) / kPictures, static_cast<double>(background) / kPictures};
}

TEST_F(TrainPeople, TellsToyPeopleFromToyBackground) {
  for (const SvmKernel kernel : {SvmKernel::linear, SvmKernel::rbf}) {
    TrainOptions options = small_options();
    options.kernel = kernel;
    const TrainingResult result = train(options);
    EXPECT_EQ(result.model.kernel.has_value(), kernel == SvmKernel::rbf);
    const auto [people, background] = shares_taken(result.model);
    EXPECT_GE(people, 0.9) << enum_name(kernel);
    EXPECT_LE(background, 0.1) << enum_name(kernel);
    EXPECT_GE(result.validation_rate, 0.8) << enum_name(kernel);
  }
}

TEST_F(TrainPeople, ShowsTheKernelMachineWhatBothMachinesLetThrough) {
  TrainOptions options = small_options();
  options.kernel = SvmKernel::rbf;
  options.refit = false;
  options.rbf.rounds = 0;
  const TrainingResult without = train(options);
  EXPECT_EQ(without.rounds.back().name, "round 2");
  options.rbf.rounds = 1;
  const TrainingResult with = train(options);
  EXPECT_EQ(with.rounds.back().name, "kernel machine, round 1");
  EXPECT_GT(with.background, without.background);
  EXPECT_EQ(with.model.linear.weights, without.model.linear.weights) << "what the first stage rejects stays rejected";
  EXPECT_NE(with.model.kernel->coefficients, without.model.kernel->coefficients);
}

TEST_F(TrainPeople, LearnsFromAllPairsWithProposals) {
  TrainOptions options = small_options();
  options.refit = false;
  const TrainingResult without = train(options);
  const std::size_t pictures = data_.background.size();
  for (std::size_t i = 0; i < pictures; ++i) {
    TrainingPicture pair = data_.background[i];
    pair.has_proposals = true;
    pair.proposals = {{10, 10, 60, 120}, {120, 30, 60, 120}};
    data_.background.push_back(pair);
  }
  const TrainingResult with = train(options);
  EXPECT_EQ(with.validation.negatives.size(), without.validation.negatives.size());
  EXPECT_NE(with.model.linear.weights, without.model.linear.weights);
}

TEST_F(TrainPeople, GivesTheSameBytesTwiceOnAnyNumberOfThreads) {
  TrainOptions options = small_options();
  options.kernel = SvmKernel::rbf;
  const std::string once = bytes(train(options));
  options.threads = 3;
  EXPECT_EQ(bytes(train(options)), once);
  options.seed = 2;
  EXPECT_NE(bytes(train(options)), once);
}

TEST_F(TrainPeople, GoesOnToTheSameBytesAfterAnInterruption) {
  struct Interruption {};
  const TrainOptions options = small_options();
  const std::string uninterrupted = bytes(train(options));
  for (const char* where : {"hard windows, round 2", "linear machine, round 2", "validation"}) {
    const auto interrupt = [&](std::string_view chapter, std::size_t, std::size_t) {
      if (chapter == where) throw Interruption{};
    };
    EXPECT_THROW(train(options, interrupt), Interruption) << where;
    EXPECT_TRUE(std::filesystem::exists(folder_.file("work/state.json"))) << where;
    bool has_mined_again = false;
    const TrainingResult result = train(options, [&](std::string_view chapter, std::size_t, std::size_t) {
      has_mined_again = has_mined_again || chapter == "hard windows, round 1";
    });
    EXPECT_FALSE(has_mined_again) << where;
    EXPECT_EQ(bytes(result), uninterrupted) << where;
  }
}

TEST_F(TrainPeople, LearnsMoreWindowsWhenItRefits) {
  TrainOptions options = small_options();
  const TrainingResult with = train(options);
  options.refit = false;
  const TrainingResult without = train(options);
  EXPECT_EQ(with.people, 90U) << "30 people, 3 windows each";
  EXPECT_LT(without.people, with.people);
  EXPECT_EQ(with.model.threshold, without.model.threshold);
  EXPECT_EQ(with.model.linear.calibration.slope, without.model.linear.calibration.slope);
  EXPECT_NE(with.model.linear.weights, without.model.linear.weights);
}

TEST_F(TrainPeople, LetsTheWantedShareThrough) {
  const TrainOptions options = small_options();
  const TrainingResult result = train(options);
  std::size_t passed = 0, all = 0;
  for (const auto& picture : result.validation.negatives)
    for (const double probability : picture) ++all, passed += probability > result.model.threshold;
  EXPECT_EQ(all, 200U) << "two pictures of twelve, 100 windows each";
  EXPECT_LE(passed, 2U);
}

TEST_F(TrainPeople, NeedsPicturesOfBothKinds) {
  data_.background.resize(3);
  EXPECT_THAT(testing::error_of([&] { train(small_options()); }),
              HasSubstr("--negatives: found 3 pictures, expected at least 4"));
}

TEST_F(TrainPeople, ReportsInOneFile) {
  const TrainOptions options = small_options();
  TrainingResult result = train(options);
  result.model.name = "toys <1>";
  const std::string html = training_report_html(data_, options, result, {"flies train", "0"});
  EXPECT_THAT(html, HasSubstr("Training of toys &lt;1&gt;"));
  EXPECT_THAT(html, HasSubstr("negatives.rounds: 2"));
  std::size_t pictures = 0;
  for (auto at = html.find("src=\"data:image"); at != std::string::npos; at = html.find("src=\"data:image", at + 1))
    ++pictures;
  EXPECT_EQ(pictures, 5U) << "curve, histogram, two contact sheets, weights";
  EXPECT_THAT(html.find("src=\"http"), std::string::npos);
}

}  // namespace
}  // namespace flies
