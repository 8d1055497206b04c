// flies-train-network on pictures that the tests make, with so few batches that it learns next to nothing.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include "flies/classify/model_file.hpp"
#include "flies/classify/named_models.hpp"
#include "tests/cli/run_flies.hpp"
#include "toy_streets.hpp"

namespace flies::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Words = std::vector<std::string>;

constexpr const char* kState = "net.json.work/network.state";

Words with(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// Short, and no toy is hopeless to the linear machine.
Words train(const Words& more) {
  return with({"--people", "people", "--epochs", "4", "--steps", "3", "--fresh", "300", "--judged", "300",
               "--reject-below", "-100"},
              more);
}

struct TrainNetwork : ::testing::Test {
  TrainNetwork() { write_toy_streets(folder.path() / "people"); }

  /// Everything but the pictures.
  std::vector<std::string> written() const {
    std::vector<std::string> names;
    for (const auto& name : folder.listing())
      if (!name.starts_with("people")) names.push_back(name);
    return names;
  }
  std::string content(const std::string& name) const { return read_text(folder.path() / name); }

  /// Writes `name`. @returns its bytes
  std::string trained(const std::string& name, const Words& more = {}) const {
    const RunResult result = run_flies(folder.path(), train(with({"--out", name, "--name", "net"}, more)));
    EXPECT_EQ(result.status, 0) << result.err;
    return content(name);
  }
  /// A training of net.json that a signal ends as soon as there is a state.
  void stop(int signal) const {
    const RunResult result = interrupt_flies(folder.path(), train({"--out", "net.json"}), signal,
                                             [&] { return fs::exists(folder.path() / kState); });
    ASSERT_EQ(result.status, 128 + signal) << result.err;
  }
  void expect_refused(const Words& words, const std::string& complaint) const {
    const RunResult result = run_flies(folder.path(), words);
    EXPECT_EQ(result.status, 2) << complaint;
    EXPECT_THAT(result.err, HasSubstr(complaint));
    EXPECT_EQ(lines(result.err).size(), 1U) << result.err;
  }

  TestFolder folder;
};

TEST_F(TrainNetwork, NamesLabelLinesThatCannotBeRead) {
  const fs::path label = folder.path() / "people/pictures/label_2/kitti_000003.txt";
  write_text(label, "Pedestrian 0 0 0 90 50 20 150 -1 -1 -1 -1000 -1000 -1000 -10\n");
  expect_refused(train({"--quiet", "--out", "net.json"}), "kitti_000003.txt: line 1: found the box 90 50 20 150");
  write_text(label, "Pedestrian 0 0 0 x\n");
  expect_refused(train({"--quiet", "--out", "net.json"}), "kitti_000003.txt: line 1: found 5 fields");
}

TEST_F(TrainNetwork, RefusesToWriteOverWhatItReads) {
  for (const std::string input : {"people/train/positives/inria/100.png", "people/train/negatives/100.png",
                                  "people/pictures/images/kitti_000003.png", "people/pictures/label_2/kitti_000003.txt",
                                  "people/pictures/partly/images/coco_000008.png"}) {
    const std::string before = content(input);
    expect_refused(train({"--out", input}), input + ": --out: this file is already an input");
    expect_refused(train({"--out", "net.json", "--report", input}),
                   input + ": --report: this file is already an input");
    EXPECT_EQ(content(input), before);
  }
  EXPECT_THAT(written(), IsEmpty());
}

TEST_F(TrainNetwork, WritesAModelAndAReport) {
  const RunResult result = run_flies(folder.path(), train({"--out", "net.json", "--report", "net.html"}));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(written(), ElementsAre("net.html", "net.json"));
  EXPECT_THAT(result.err, HasSubstr("epoch 4 of 4"));
  EXPECT_THAT(result.out, HasSubstr("too few windows without people to tell of 0.0001 false positives a window"));
  EXPECT_THAT(result.out, HasSubstr("% of people at 0.01 false positives a window"));

  const PeopleModel model = read_people_model((folder.path() / "net.json").string());
  ASSERT_TRUE(model.convolution);
  EXPECT_EQ(model.name, "net");

  const std::string html = content("net.html");
  for (const char* chapter : {"Training of net", "On pictures kept apart", "Hardest mistakes", "Epochs", "steps: 3",
                              "<td>0.0001</td>", "<td>0.01</td>", "flies train --network --people people"})
    EXPECT_THAT(html, HasSubstr(chapter));
  std::size_t pictures = 0;
  for (auto at = html.find("src=\"data:image"); at != std::string::npos; at = html.find("src=\"data:image", at + 1))
    ++pictures;
  EXPECT_EQ(pictures, 4U) << "curve, histogram, two contact sheets";
}

TEST_F(TrainNetwork, GivesTheSameBytesForASeed) {
  const std::string first = trained("a.json");
  EXPECT_EQ(first, trained("b.json"));
  EXPECT_NE(first, trained("c.json", {"--seed", "2"}));
}

TEST_F(TrainNetwork, JudgesANetworkThatIsThereAsItDidInTraining) {
  const std::string first = trained("a.json");
  EXPECT_EQ(first, trained("b.json", {"--network-of", "a.json", "--report", "b.html"}));
  EXPECT_THAT(content("b.html"), HasSubstr("Hardest mistakes"));
}

TEST_F(TrainNetwork, LearnsFromAllPicturesWithAnothersCalibration) {
  trained("a.json");
  trained("all.json", {"--all", "--calibration-of", "a.json"});
  const PeopleModel part = read_people_model((folder.path() / "a.json").string()),
                    all = read_people_model((folder.path() / "all.json").string());
  EXPECT_EQ(all.threshold, part.threshold);
  EXPECT_EQ(all.convolution->calibration.slope, part.convolution->calibration.slope);
  EXPECT_NE(all.convolution->last, part.convolution->last);
}

TEST_F(TrainNetwork, PutsANetworkBehindAnotherFirstLook) {
  trained("a.json");
  const RunResult result = run_flies(folder.path(), {"--network-of", "a.json", "--calibration-of", "a.json", "--first",
                                                     "flies-48x96", "--out", "b.json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const PeopleModel before = read_people_model((folder.path() / "a.json").string()),
                    after = read_people_model((folder.path() / "b.json").string());
  EXPECT_EQ(after.convolution->last, before.convolution->last);
  EXPECT_NE(after.linear.weights, before.linear.weights);
}

TEST_F(TrainNetwork, LearnsANetworkInFrontOfTheLinearMachine) {
  const std::string bytes =
      trained("first.json", {"--first-look", "--reject-below", "-1.25", "--report", "first.html"});
  EXPECT_EQ(bytes, trained("again.json", {"--first-look", "--reject-below", "-1.25"}));
  const PeopleModel first = read_people_model((folder.path() / "first.json").string()),
                    linear = people_model("flies-48x96-linear");
  ASSERT_TRUE(first.first_network);
  EXPECT_FALSE(first.convolution);
  EXPECT_EQ(first.first_network->reject_below, -1.25);
  EXPECT_EQ(first.linear.weights, linear.linear.weights);
  EXPECT_EQ(first.threshold, linear.threshold);
  EXPECT_THAT(content("first.html"), HasSubstr("Hardest mistakes"));

  trained("net.json", {"--first", "first.json"});
  const PeopleModel both = read_people_model((folder.path() / "net.json").string());
  ASSERT_TRUE(both.first_network && both.convolution);
  EXPECT_EQ(both.first_network->last, first.first_network->last);
  EXPECT_EQ(both.first_network->reject_below, -1.25);
  EXPECT_EQ(both.linear.reject_below, -100.0);

  trained("all.json", {"--first-look", "--all"});
  EXPECT_NE(read_people_model((folder.path() / "all.json").string()).first_network->last, first.first_network->last);
}

struct StoppedTraining : TrainNetwork, ::testing::WithParamInterface<int> {};

TEST_P(StoppedTraining, GoesOnToTheSameBytes) {
  const std::string whole = trained("whole.json");
  fs::remove(folder.path() / "whole.json");
  stop(GetParam());
  if (GetParam() == SIGINT) {
    EXPECT_THAT(written(), ElementsAre("net.json.work", kState)) << "nothing half written";
  }
  const RunResult result = run_flies(folder.path(), train({"--out", "net.json"}));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("goes on after epoch"));
  EXPECT_EQ(content("net.json"), whole);
  EXPECT_THAT(written(), ElementsAre("net.json"));
}

INSTANTIATE_TEST_SUITE_P(Signals, StoppedTraining, ::testing::Values(SIGINT, SIGTERM, SIGKILL));

TEST_F(TrainNetwork, RefusesTheStateOfAnotherTraining) {
  stop(SIGINT);
  const std::string complaint = "net.json.work: holds the state of a training with other pictures or options";
  for (const Words& other : {Words{"--seed", "2"}, {"--epochs", "5"}, {"--steps", "4"}, {"--fresh", "301"}}) {
    SCOPED_TRACE(other.front());
    const RunResult result = run_flies(folder.path(), train(with({"--quiet", "--out", "net.json"}, other)));
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(result.err, HasSubstr(complaint));
  }
  write_toy_street(folder.path() / "people/pictures", "kitti_000003", 4);
  expect_refused(train({"--quiet", "--out", "net.json"}), complaint);
  EXPECT_THAT(written(), ElementsAre("net.json.work", kState)) << "kept for who started it";
  const RunResult elsewhere =
      run_flies(folder.path(), train({"--quiet", "--out", "net.json", "--work", "other", "--epochs", "1"}));
  EXPECT_EQ(elsewhere.status, 0) << elsewhere.err;
}

TEST_F(TrainNetwork, RefusesADamagedState) {
  stop(SIGINT);
  const std::string state = content(kState);
  std::string turned = state;
  turned[turned.size() / 2] = static_cast<char>(~turned[turned.size() / 2]);
  for (const std::string& damaged : {turned, state.substr(0, state.size() - 1), state.substr(0, 40), std::string(),
                                     std::string("{}"), state + "x"}) {
    write_text(folder.path() / kState, damaged);
    expect_refused(train({"--quiet", "--out", "net.json"}), std::string(kState) + ": is damaged, expected the state");
    EXPECT_FALSE(fs::exists(folder.path() / "net.json"));
  }
  write_text(folder.path() / kState, state);
  EXPECT_EQ(run_flies(folder.path(), train({"--out", "net.json"})).status, 0) << "it was the damage";
}

TEST_F(TrainNetwork, NamesAFaultAndLeavesNothingBehind) {
  struct Case {
    Words words;
    std::string complaint;
  };
  const std::vector<Case> cases = {
      {{"--people", "people"}, "--out"},
      {{"--out", "net.json"}, "--people: missing, expected a folder of pictures"},
      {train({"--out", "net.json", "--epoch", "1"}), "unknown option --epoch; did you mean --epochs?"},
      {train({"--out", "net.json", "--epochs", "0"}), "epochs: found 0, expected a whole number in 1..1000"},
      {train({"--out", "net.json", "--all"}), "--all: keeps nothing apart to calibrate by"},
      {train({"--out", "net.json", "--all", "--calibration-of", "flies-48x96-network", "--report", "a.html"}),
       "--report: needs pictures kept apart"},
      {train({"--out", "net.json", "--first-look", "--calibration-of", "flies-48x96-network"}),
       "--first-look: expected no --calibration-of with it"},
      {train({"--out", "net.json", "--first-look", "--network-of", "flies-48x96-network"}),
       "--first-look: nothing is learnt with --network-of"},
      {train({"--out", "net.json", "--report", "net.json"}), "this file is already the output of --out"},
      {train({"--out", "no/such/net.json"}), "no/such/net.json"},
      {train({"--out", "net.json", "--network-of", "flies-48x96"}), "flies-48x96: convolution: missing"},
      {{"--out", "net.json", "--network-of", "flies-48x96-network"}, "--network-of: expected --people or"},
      {train({"--out", "net.json", "--first", "nowhere.json"}), "nowhere.json"},
      {{"--people", "nowhere", "--out", "net.json"}, "nowhere/pictures/images: cannot be read"},
      {train({"--out", "net.json", "--stereo", "people"}), "people"},
  };
  for (const auto& wrong : cases) {
    expect_refused(with(wrong.words, {"--quiet"}), wrong.complaint);
    EXPECT_THAT(written(), IsEmpty()) << wrong.complaint;
  }
}

TEST_F(TrainNetwork, NamesWhatThePicturesLack) {
  for (const auto& label : fs::directory_iterator(folder.path() / "people/pictures/label_2"))
    if (label.path().stem() >= "kitti_000010") write_text(label.path(), "");
  fs::remove_all(folder.path() / "people/pictures/partly");
  for (const char* part : {"images", "label_2"})
    fs::create_directories(folder.path() / "people/pictures/partly" / part);
  expect_refused(train({"--quiet", "--out", "net.json"}),
                 "people: found no person of 40 px or more in full view among those kept apart");
  EXPECT_THAT(written(), IsEmpty());
}

}  // namespace
}  // namespace flies::testing
