#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "flies/train/toy_pictures.hpp"
#include "run_flies.hpp"

namespace flies::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Words = std::vector<std::string>;

/// The command for toy pictures, small enough to take no time.
Words train(const Words& more) {
  Words words = {"train",  "--positives",
                 "people", "--negatives",
                 "street", "--positives.jitters",
                 "1",      "--negatives.first",
                 "120",    "--negatives.rounds",
                 "1",      "--negatives.windows_per_picture",
                 "60",     "--negatives.validation_per_picture",
                 "100",    "--false-positive-rate",
                 "0.01"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

struct Train : ::testing::Test {
  Train() { write_toy_data(folder.path(), 30, 12); }
  /// Everything but the pictures.
  std::vector<std::string> written() const {
    std::vector<std::string> names;
    for (const auto& name : folder.listing())
      if (!name.starts_with("people") && !name.starts_with("street")) names.push_back(name);
    return names;
  }
  TestFolder folder;
};

TEST_F(Train, WritesAModelThatEvaluatesWellOnItsOwnPictures) {
  const RunResult trained = run_flies(folder.path(), train({"--out", "toy.json", "--report", "toy.html"}));
  ASSERT_EQ(trained.status, 0) << trained.err;
  EXPECT_THAT(trained.out, HasSubstr("learnt from    90 windows with people"));
  EXPECT_THAT(written(), ElementsAre("toy.html", "toy.json"));
  EXPECT_THAT(read_text(folder.path() / "toy.html"), HasSubstr("Training of toy"));

  namespace fs = std::filesystem;
  fs::create_directories(folder.path() / "data");
  fs::rename(folder.path() / "people", folder.path() / "data/positives");
  fs::rename(folder.path() / "street", folder.path() / "data/negatives");
  const RunResult judged =
      run_flies(folder.path(), {"evaluate-classifier", "toy.json", "--data", "data", "--negatives", "1000"});
  EXPECT_EQ(judged.status, 0) << judged.err;
  EXPECT_THAT(judged.out, HasSubstr("toy.json"));
}

TEST_F(Train, WritesTheSameFileTwice) {
  ASSERT_EQ(run_flies(folder.path(), train({"--out", "a.json", "--name", "x", "--kernel", "rbf"})).status, 0);
  ASSERT_EQ(
      run_flies(folder.path(), train({"--out", "b.json", "--name", "x", "--kernel", "rbf", "--threads", "2"})).status,
      0);
  EXPECT_EQ(read_text(folder.path() / "a.json"), read_text(folder.path() / "b.json"));
}

TEST_F(Train, NamesAFaultAndLeavesNothingBehind) {
  struct Case {
    Words words;
    std::string complaint;
  };
  const std::vector<Case> cases = {
      {{"--out", "m.json", "--kernel", "cubic"}, "kernel: found 'cubic', expected linear|rbf"},
      {{"--out", "m.json", "--rbf.gama", "1"}, "unknown option --rbf.gama; did you mean --rbf.gamma?"},
      {{"--out", "no/such/m.json"}, "no/such/m.json"},
      {{"--out", "m.json", "--report", "m.json"}, "m.json: --report: this file is already the output of --out"},
      {{"--out", "m.json", "--report", "./m.json"}, "--report: this file is already the output of --out"},
      {{"--out", "m.json", "--negatives", "nowhere"}, "nowhere: no such folder"},
      {{"--out", "m.json", "--about", "licence"}, "--about: found 'licence', expected KEY=TEXT"},
      {{"--out", "m.json", "--about", "licence=\xA9"}, "--about: is not UTF-8"},
      {{"--out", "m.json", "--name", "M\xFCller"}, "--name: is not UTF-8"},
      {{"--out", "M\xFCller.json"}, "--out: is not UTF-8"},
      {{"--out", "m.json", "--stereo-negatives", "street"}, "street"},
      {{"--out", "m.json", "--crop-person-share", "nan"},
       "--crop-person-share: found nan, expected a number in 0.1..1;"},
      {{"--out", "m.json", "--crop-person-share", "1.5"}, "--crop-person-share: found 1.5"},
      {{"--out", "m.json", "--positives", "street"}, "street: holds no labels that are read, and 12 of 12 pictures"},
  };
  for (const auto& wrong : cases) {
    const RunResult result = run_flies(folder.path(), train(wrong.words));
    EXPECT_EQ(result.status, 2) << wrong.complaint;
    EXPECT_THAT(result.err, HasSubstr(wrong.complaint));
    EXPECT_EQ(lines(result.err).size(), 1U) << result.err;
    EXPECT_THAT(written(), IsEmpty()) << wrong.complaint;
  }
}

TEST_F(Train, TellsOfPicturesWithoutLabelsAndOfTooFewWindows) {
  write_text(folder.path() / "street/100.xml", "<annotation><filename>100.png</filename></annotation>");
  for (const char* name : {"101", "102", "103"})
    write_text(folder.path() / "street" / (std::string(name) + ".xml"), "<annotation/>");
  const RunResult result = run_flies(folder.path(), train({"--out", "m.json", "--negatives.validation_per_picture",
                                                           "20", "--false-positive-rate", "0.0001"}));
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err,
            "flies: note: street: 8 of 12 pictures have no labels and are not used, street/104.png the first\n");
  EXPECT_THAT(result.out, HasSubstr("too few windows without people to tell of 0.0001 false positives a window"));
  EXPECT_THAT(result.out, HasSubstr("is above it: too few for 0.0001 false positives a window)"));
}

TEST_F(Train, NamesADamagedPicture) {
  write_text(folder.path() / "people/105.png", "no picture");
  const RunResult result = run_flies(folder.path(), train({"--out", "m.json"}));
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("people/105.png"));
}

/// A folder with the program, where only what a test puts there is beside it.
struct TrainNetwork : ::testing::Test {
  TrainNetwork() { std::filesystem::copy_file(FLIES_BINARY, folder.path() / "flies"); }
  RunResult run(const std::string& words) const {
    const RunResult result = run_flies(folder.path(), {}, "./flies " + words + "; echo $? > status; true");
    return {std::stoi(read_text(folder.path() / "status")), result.out, result.err};
  }
  void write_trainer(const std::string& script) const {
    write_text(folder.path() / "flies-train-network", "#!/bin/sh\n" + script);
    std::filesystem::permissions(folder.path() / "flies-train-network", std::filesystem::perms::owner_all);
  }
  TestFolder folder;
};

TEST_F(TrainNetwork, SaysWhatIsMissingWhereNobodyBuiltTheTrainer) {
  const RunResult result = run("train --network --people people --out net.json");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("needs the program flies-train-network beside flies"));
  EXPECT_THAT(result.err, HasSubstr("libtorch-dev"));
  EXPECT_EQ(lines(result.err).size(), 1U) << result.err;
}

TEST_F(TrainNetwork, GivesTheTrainerAllOtherArgumentsAndReturnsItsStatus) {
  write_trainer("printf '<%s>' \"$@\"; exit 7\n");
  const RunResult result = run("train --people 'my people' --network --out net.json --help");
  EXPECT_EQ(result.out, "<--people><my people><--out><net.json><--help>") << result.err;
  EXPECT_EQ(result.status, 7);
}

TEST_F(TrainNetwork, LetsSignalsReachTheTrainer) {
  write_trainer("kill -TERM $$; sleep 20; echo survived\n");
  EXPECT_EQ(run("train --network").status, 128 + 15);
}

TEST_F(TrainNetwork, IsInTheHelpOfTrain) {
  EXPECT_THAT(run("train --help").out, HasSubstr("flies train --network --help"));
}

}  // namespace
}  // namespace flies::testing
