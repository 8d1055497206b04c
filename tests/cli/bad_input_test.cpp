#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "flies/io/calibration.hpp"
#include "run_flies.hpp"
#include "spoilt_street.hpp"
#include "street_pair.hpp"

namespace fs = std::filesystem;

namespace flies::testing {
namespace {

void write_pair_like(const fs::path& folder, int value) {
  const cv::Mat flat(240, 320, CV_8UC1, cv::Scalar(value));
  write_image(folder / "left.png", flat);
  write_image(folder / "right.png", flat);
}

/// Turns the street of the test folder into the fault and gives the command that meets it.
struct BadInput {
  const char* name;
  std::function<Words(const fs::path&)> prepare;
  Words named;  ///< what the message must name: file, field, what was found
  std::string prefix = {};
};

std::ostream& operator<<(std::ostream& stream, const BadInput& input) { return stream << input.name; }

std::vector<BadInput> bad_inputs() {
  const auto with_calibration = [](const std::string& text) {
    return [text](const fs::path& f) {
      write_text(f / "calib.txt", text);
      return detect();
    };
  };
  const auto with_options = [](const std::string& yaml) {
    return [yaml](const fs::path& f) {
      write_text(f / "options.yaml", yaml);
      return detect({"--options", "options.yaml"});
    };
  };
  const auto with_words = [](const Words& more) { return [more](const fs::path&) { return detect(more); }; };
  std::string nan_calibration = kitti_calibration();
  nan_calibration.replace(nan_calibration.find("P2: 300"), 7, "P2: nan");
  return {
      // Images
      {"MissingLeft",
       [](const fs::path& f) {
         fs::remove(f / "left.png");
         return detect();
       },
       {"left.png"}},
      {"MissingRight",
       [](const fs::path& f) {
         fs::remove(f / "right.png");
         return detect();
       },
       {"right.png"}},
      {"TruncatedPng",
       [](const fs::path& f) {
         keep_first_bytes(f / "right.png", 0.5);
         return detect();
       },
       {"right.png"}},
      {"TextInsteadOfImage",
       [](const fs::path& f) {
         write_text(f / "left.png", "hello\n");
         return detect();
       },
       {"left.png"}},
      {"EmptyImageFile",
       [](const fs::path& f) {
         write_text(f / "left.png", "");
         return detect();
       },
       {"left.png"}},
      {"SizesDiffer",
       [](const fs::path& f) {
         write_image(f / "right.png", street_pair().right(cv::Rect(0, 0, 300, 240)));
         return detect();
       },
       {"left.png", "right.png", "320", "300"}},
      {"SwappedPair",
       [](const fs::path&) { return detect({}, "right.png", "left.png"); },
       {"left.png", "right.png", "swapped"}},
      {"OneImageTwice", [](const fs::path&) { return detect({}, "left.png", "left.png"); }, {"left.png"}},
      {"CopyOfOneImage",
       [](const fs::path& f) {
         write_image(f / "right.png", street_pair().left);
         return detect();
       },
       {"left.png", "right.png"}},
      {"OnePixel",
       [](const fs::path& f) {
         write_image(f / "left.png", cv::Mat(1, 1, CV_8UC1, cv::Scalar(9)));
         write_image(f / "right.png", cv::Mat(1, 1, CV_8UC1, cv::Scalar(8)));
         return detect();
       },
       {"left.png", "1 x 1"}},
      {"AllBlack",
       [](const fs::path& f) {
         write_pair_like(f, 0);
         return detect();
       },
       {"left.png"}},
      {"AllWhite",
       [](const fs::path& f) {
         write_pair_like(f, 255);
         return detect();
       },
       {"left.png"}},
      {"UnrelatedPictures",
       [](const fs::path& f) {
         write_image(f / "right.png", unrelated_picture());
         return detect();
       },
       {"left.png", "right.png"}},
      {"PictureOfAnotherFormat",
       [](const fs::path&) {
         return detect({"--top-view", "top.jpg"});
       },
       {"top.jpg", "--top-view", ".png"}},
      {"HeightsInTheWrongOrder",
       [](const fs::path&) {
         return Words{"config", "--propose.min_height_m", "2.5"};
       },
       {"propose.min_height_m"}},
      {"EmptyStretchOfRoad",
       [](const fs::path&) {
         return Words{"config", "--road.x_min_m", "30"};
       },
       {"road.x_min_m"}},
      {"FloatImage",
       [](const fs::path& f) {
         cv::Mat depths;
         street_pair().left.convertTo(depths, CV_32F);
         write_image(f / "left.tiff", depths);
         return detect({}, "left.tiff");
       },
       {"left.tiff"}},
      // Folders
      {"FileForFolder",
       [](const fs::path& f) {
         write_folders(f, 1, 1);
         return detect({}, "l", "right.png");
       },
       {"l", "right.png"}},
      {"EmptyFolder",
       [](const fs::path& f) {
         write_folders(f, 0, 1);
         return detect({}, "l", "r");
       },
       {"l: "}},
      {"FoldersOfDifferentCounts",
       [](const fs::path& f) {
         write_folders(f, 2, 3);
         Words words = detect({}, "l", "r");
         words.insert(words.end(), {"--pair-by", "order"});
         return words;
       },
       {"l", "r", "2", "3"}},
      {"MissingFolder",
       [](const fs::path& f) {
         write_folders(f, 1, 1);
         return detect({}, "gone", "r");
       },
       {"gone"}},
      // Calibration
      {"MissingCalibration",
       [](const fs::path& f) {
         fs::remove(f / "calib.txt");
         return detect();
       },
       {"calib.txt"}},
      {"EmptyCalibration", with_calibration(""), {"calib.txt"}},
      {"CalibrationOfUnknownFormat", with_calibration("the camera was fine yesterday\n"), {"calib.txt", "format"}},
      {"CalibrationIsAnImage",
       [](const fs::path& f) {
         fs::copy_file(f / "left.png", f / "calib.txt", fs::copy_options::overwrite_existing);
         return detect();
       },
       {"calib.txt"}},
      {"CalibrationIsAFolder",
       [](const fs::path& f) {
         fs::remove(f / "calib.txt");
         fs::create_directory(f / "calib.txt");
         return detect();
       },
       {"calib.txt"}},
      {"TruncatedCalibration",
       [](const fs::path& f) {
         const std::string whole = kitti_calibration();
         write_text(f / "calib.txt", whole.substr(0, whole.find("P3") + 20));
         return detect();
       },
       {"calib.txt", "P3", "12"}},
      {"NanFocalLength", with_calibration(nan_calibration), {"calib.txt", "P2"}},
      {"ZeroFocalLength", with_calibration(kitti_calibration(0.0, 160, 0.5)), {"calib.txt", "focal"}},
      {"NegativeBaseline", with_calibration(kitti_calibration(300, 160, -0.5)), {"calib.txt", "baseline"}},
      {"CalibrationOfAnotherSize", with_calibration(kitti_calibration(900, 620, 0.5)), {"calib.txt", "size"}},
      {"CalibrationThatNamesAnotherSize",
       [](const fs::path& f) {
         StereoCamera camera = street_camera();
         camera.width_px = 640;
         write_text(f / "calib.txt", calibration_yaml(camera));
         return detect();
       },
       {"calib.txt", "640", "320"}},
      {"NegativeCameraHeight", with_words({"--camera-height", "-1"}), {"height"}},
      {"CameraPitchBeyondRange", with_words({"--camera-pitch", "80"}), {"pitch", "80"}},
      {"CameraHeightNotANumber", with_words({"--camera-height", "tall"}), {"--camera-height", "tall"}},
      {"CamerasNotTwoNumbers", with_words({"--cameras", "0"}), {"--cameras", "L,R"}},
      {"CamerasOfAFileOfTwo",
       [](const fs::path& f) {
         write_text(f / "calib.txt", calibration_yaml(street_camera()));
         return detect({"--cameras", "0,1"});
       },
       {"calib.txt", "cameras", "flies YAML"}},
      {"SecondCalibrationOfAFileThatSaysAll",
       with_words({"--right-calib", "calib.txt"}),
       {"calib.txt", "right calibration", "KITTI"}},
      {"ValueForgottenAtTheEnd", with_words({"--seed"}), {"--seed", "expects a value N"}},
      {"OptionGivenTwice", with_words({"--csv", "a.csv", "--csv=b.csv"}), {"--csv", "is given twice"}},
      {"MountGivenTwice", with_words({"--camera-height", "1", "--camera-height", "1.65"}), {"is given twice"}},
      {"ValueForgottenBeforeAnOption", with_words({"--csv", "--seed", "3"}), {"--csv", "expects a value", "--seed"}},
      {"CamerasThatDoNotExist", with_words({"--cameras", "7,8"}), {"7"}},
      // Outputs
      {"OutputFolderMissing", with_words({"--csv", "gone/out.csv"}), {"gone/out.csv"}},
      {"OutputFolderIsAFile", with_words({"--top-view", "left.png/top.png"}), {"left.png/top.png"}},
      {"OutputIsAFolder",
       [](const fs::path& f) {
         fs::create_directory(f / "out.csv");
         return detect({"--csv", "out.csv"});
       },
       {"out.csv"}},
      {"DiskFull",
       [](const fs::path&) {
         return Words{"detect",          "left.png", "right.png", "--calib",  "calib.txt",
                      "--camera-height", "1.65",     "--csv",     "/dev/full"};
       },
       {"/dev/full", "No space left"}},
      {"FileSizeLimit", [](const fs::path&) { return detect(); }, {"out.png", "File too large"}, "ulimit -f 64;"},
      {"TwoOutputsOneFile", with_words({"--csv", "out.jsonl"}), {"out.jsonl", "--csv", "--json"}},
      {"TwoOutputsOneFileSpelledDifferently", with_words({"--csv", "./l/../out.jsonl"}), {"--csv"}},
      {"TwoOutputsOnStandardOutput",
       [](const fs::path&) {
         return Words{"detect", "left.png", "right.png", "--calib", "calib.txt", "--json", "-", "--csv", "-"};
       },
       {"standard output"}},
      {"ScanInTheFileOfTheOthers", with_words({"--scan", "out.jsonl"}), {"out.jsonl", "--scan", "--json"}},
      {"ScanFolderMissing", with_words({"--scan", "gone/scan.csv"}), {"gone/scan.csv"}},
      {"PictureOnStandardOutput", with_words({"--top-view", "-"}), {"--top-view"}},
      {"OutputOverAnInput", with_words({"--top-view", "right.png"}), {"right.png", "--top-view", "input"}},
      // Options
      {"UnknownOptionInYaml", with_options("evolve:\n  flis: 300\n"), {"options.yaml", "evolve.flis", "evolve.flies"}},
      {"MalformedYaml", with_options("evolve: [1, 2\n"), {"options.yaml"}},
      {"YamlValueOutOfRange", with_options("evolve:\n  flies: -3\n"), {"options.yaml", "evolve.flies", "-3"}},
      {"MissingOptionsFile", with_words({"--options", "gone.yaml"}), {"gone.yaml"}},
      {"UnknownOptionOnCommandLine", with_words({"--evolve.flis", "300"}), {"--evolve.flis", "--evolve.flies"}},
      {"OptionOutOfRange", with_words({"--evolve.generations", "-1"}), {"evolve.generations", "-1", "0..1000"}},
      {"OptionNotANumber", with_words({"--fitness.noise_gray", "loud"}), {"fitness.noise_gray", "loud"}},
      {"OptionNan", with_words({"--fitness.noise_gray", "nan"}), {"fitness.noise_gray", "nan"}},
      {"OptionUnknownName", with_words({"--fitness.function", "best"}), {"fitness.function", "best", "covariance"}},
      {"SeedNegative", with_words({"--seed", "-1"}), {"seed", "-1"}},
      {"EmptyField", with_words({"--field.x_min_m", "30", "--field.x_max_m", "20"}), {"x_m"}},
      {"UnknownPreset",
       with_words({"--preset", "fast"}),
       {"command line: preset: found 'fast', expected ", "default|paper"}},
      {"MissingModel", with_words({"--model", "gone.json"}), {"gone.json", "opencv-48x96"}},
      {"ModelIsNoModel",
       [](const fs::path& f) {
         write_text(f / "model.json", "{\"name\": \"nobody\"}\n");
         return detect({"--model", "model.json"});
       },
       {"model.json", "format"}},
      {"MissingArgument",
       [](const fs::path&) {
         return Words{"detect", "left.png", "--calib", "calib.txt"};
       },
       {"RIGHT"}},
      {"UnknownSubcommand", [](const fs::path&) { return Words{"detct"}; }, {"detct"}},
      {"CurvesOfAnotherFormat",
       [](const fs::path&) {
         return Words{"evaluate", "l", "--plot", "curves.txt"};
       },
       {"curves.txt", "--plot", ".png"}},
      {"PictureOfRowsOfAnotherFormat",
       [](const fs::path&) {
         return Words{"check", "left.png", "right.png", "--calib", "calib.txt", "--picture", "rows.jpg"};
       },
       {"rows.jpg", "--picture", ".png"}},
  };
}

class BadInputs : public ::testing::TestWithParam<BadInput> {};

TEST_P(BadInputs, EndWithOneLineAndStatus2) {
  const TestFolder folder;
  write_street(folder.path());
  const Words command = GetParam().prepare(folder.path());
  const auto before = folder.listing();

  const RunResult result = run_flies(folder.path(), command, GetParam().prefix);

  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(lines(result.err).size(), 1u) << result.err;
  EXPECT_THAT(result.err, ::testing::StartsWith("flies: "));
  for (const auto& word : GetParam().named) EXPECT_THAT(result.err, ::testing::HasSubstr(word));
  EXPECT_EQ(folder.listing(), before) << "nothing may be left behind";
}

INSTANTIATE_TEST_SUITE_P(Table, BadInputs, ::testing::ValuesIn(bad_inputs()),
                         [](const auto& row) { return std::string(row.param.name); });

TEST(BadInputs, FullStandardOutputIsReported) {
  const TestFolder folder;
  for (const Words& command : {Words{"config"}, Words{"info"}, Words{"--help"}}) {
    const RunResult result = run_flies(folder.path(), command, "", "> /dev/full");
    EXPECT_EQ(result.status, 2);
    EXPECT_EQ(lines(result.err).size(), 1u) << result.err;
    EXPECT_THAT(result.err, ::testing::HasSubstr("standard output"));
  }
}

}  // namespace
}  // namespace flies::testing
