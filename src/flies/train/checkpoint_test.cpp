#include "flies/train/checkpoint.hpp"

#include <gmock/gmock.h>

#include "flies/io/temporary_folder.hpp"

namespace flies {
namespace {

using ::testing::HasSubstr;

TEST(Checkpoint, GivesBackWhatItWasGiven) {
  const testing::TemporaryFolder folder;
  const std::string work = folder.file("work");
  const TrainingState state{
      2, {{3, true, {0.1, 1.0 / 3.0, 40.7, 81.4}}, {4, false, {1, 2, 3, 6}}}, {{"round 1", 9, 8}}};
  Checkpoint(work, "abc").save(state);
  Checkpoint again(work, "abc");
  EXPECT_EQ(again.state().rounds_done, 2);
  EXPECT_EQ(again.state().background, state.background);
  ASSERT_EQ(again.state().rounds.size(), 1U);
  EXPECT_EQ(again.state().rounds[0].name, "round 1");
  EXPECT_EQ(again.state().rounds[0].hard, 9U);
  EXPECT_EQ(again.state().rounds[0].learnt_from, 8U);
  again.remove();
  EXPECT_FALSE(std::filesystem::exists(work));
}

TEST(Checkpoint, RefusesTheStateOfAnotherTraining) {
  const testing::TemporaryFolder folder;
  Checkpoint(folder.file("work"), "abc").save({});
  EXPECT_THAT(testing::error_of([&] { Checkpoint(folder.file("work"), "abd"); }),
              HasSubstr("work: holds the state of a training with other pictures"));
}

TEST(Checkpoint, RefusesADamagedState) {
  const testing::TemporaryFolder folder;
  std::filesystem::create_directories(folder.file("work"));
  for (const char* text : {"", "{", "{\"fingerprint\": \"abc\"}"}) {
    folder.write("work/state.json", text);
    EXPECT_THAT(testing::error_of([&] { Checkpoint(folder.file("work"), "abc"); }),
                HasSubstr("state.json: is damaged"));
  }
}

TEST(Checkpoint, RefusesAStateThatCannotBe) {
  const testing::TemporaryFolder folder;
  std::filesystem::create_directories(folder.file("work"));
  const auto error_with = [&](const std::string& window, const std::string& rounds_done = "1") {
    folder.write("work/state.json", R"({"fingerprint": "abc", "rounds": [], "background": [)" + window +
                                        R"(], "rounds_done": )" + rounds_done + "}");
    return testing::error_of([&] { Checkpoint(folder.file("work"), "abc").check_pictures(6); });
  };
  EXPECT_EQ(error_with("[5, false, 1.0, 1.0, 20.0, 40.0]"), "no error");
  for (const char* window :
       {"[6, false, 1.0, 1.0, 20.0, 40.0]", "[4000000, false, 1.0, 1.0, 20.0, 40.0]",
        "[-1, false, 1.0, 1.0, 20.0, 40.0]", "[1e30, false, 1.0, 1.0, 20.0, 40.0]",
        "[0.5, false, 1.0, 1.0, 20.0, 40.0]", "[0, false, 1.0, 1.0, 0.0, 0.0]", "[0, false, 1.0, 1.0, 20.0, -40.0]",
        "[0, false, 1e300, 1.0, 20.0, 40.0]", "[0, false, 1e999, 1.0, 20.0, 40.0]", "[0]", "7"})
    EXPECT_THAT(error_with(window), HasSubstr("state.json: is damaged")) << window;
  for (const char* rounds : {"-1", "1e30", "99999999"})
    EXPECT_THAT(error_with("", rounds), HasSubstr("state.json: is damaged")) << rounds;
}

TEST(FingerprintOf, ChangesWithPicturesAndOptionsButNotWithThreads) {
  const std::vector<TrainingPicture> people(1), background(2);
  TrainOptions options;
  const std::string fingerprint = fingerprint_of(people, background, options);
  options.threads = 7;
  EXPECT_EQ(fingerprint_of(people, background, options), fingerprint);
  EXPECT_NE(fingerprint_of(background, people, options), fingerprint);
  options.rbf.gamma *= 2.0;
  EXPECT_NE(fingerprint_of(people, background, options), fingerprint);
}

}  // namespace
}  // namespace flies
