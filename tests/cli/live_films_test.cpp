// Films that are not what they say.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <string>

#include "live_command.hpp"
#include "run_flies.hpp"

namespace flies::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

TEST_F(LiveCommand, FilmsThatEndEarlyAreTold) {
  const auto both = folder.path() / "beside.avi";
  EXPECT_THAT(run({"beside.avi", "--calib", "calib.txt", "--every-pair"}).err, Not(HasSubstr("ends after")));
  std::filesystem::resize_file(both, std::filesystem::file_size(both) / 2);
  const RunResult cut = run({"beside.avi", "--calib", "calib.txt", "--every-pair"});
  EXPECT_EQ(cut.status, 0);
  EXPECT_THAT(cut.err, HasSubstr("of the 0.40 s that it says it lasts; is it damaged or cut off?"));

  write_film(folder.path() / "r.avi", street_pair().right, kFrames / 2);
  const RunResult shorter = run({"l.avi", "r.avi", "--calib", "calib.txt", "--every-pair"});
  EXPECT_EQ(shorter.status, 0);
  EXPECT_THAT(shorter.err, HasSubstr("r.avi: ends after 0.20 s, while l.avi is 0.40 s long"));
}

TEST_F(LiveCommand, AFilmGivenTwiceIsNoPair) {
  std::filesystem::create_symlink("l.avi", folder.path() / "link.avi");
  std::filesystem::copy_file(folder.path() / "l.avi", folder.path() / "copy.avi");
  for (const char* second : {"l.avi", "link.avi"}) {
    const RunResult result = run({"l.avi", second, "--calib", "calib.txt", "--json", "-"});
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(result.err, HasSubstr(std::string(second) + ": is given twice"));
  }
  const RunResult copied = run({"l.avi", "copy.avi", "--calib", "calib.txt", "--every-pair", "--json", "-"});
  EXPECT_EQ(copied.status, 2);
  EXPECT_THAT(copied.err, HasSubstr("l.avi: no pair could be used; the first error: "));
  ASSERT_THAT(lines(copied.out), SizeIs(kFrames));
  for (const auto& line : lines(copied.out))
    EXPECT_THAT(nlohmann::json::parse(line).at("error").get<std::string>(), HasSubstr("not a pair: it is identical"));
}

TEST_F(LiveCommand, PairThatIsRefusedInTheMiddleHasItsLine) {
  cv::Mat beside, twice;
  cv::hconcat(street_pair().left, street_pair().right, beside);
  cv::hconcat(street_pair().left, street_pair().left, twice);
  cv::VideoWriter writer((folder.path() / "m.avi").string(), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 20.0,
                         beside.size());
  for (int i = 0; i < 9; ++i) {
    cv::Mat color;
    cv::cvtColor(i == 6 ? twice : beside, color, cv::COLOR_GRAY2BGR);
    writer.write(color);
  }
  writer.release();
  const auto all = records({"m.avi", "--calib", "calib.txt", "--every-pair", "--json", "-"});
  ASSERT_THAT(all, SizeIs(9));
  for (int i = 0; i < 9; ++i) {
    EXPECT_EQ(all[static_cast<std::size_t>(i)].at("frame"), i);
    EXPECT_EQ(all[static_cast<std::size_t>(i)].contains("error"), i == 6) << i;
  }
}

TEST_F(LiveCommand, FileAddressIsAFile) {
  const std::string address = "file://" + (folder.path() / "beside.avi").string();
  EXPECT_THAT(records({address, "--calib", "calib.txt", "--every-pair", "--json", "-"}), SizeIs(kFrames));
  const RunResult over = run({address, "--calib", "calib.txt", "--every-pair", "--json", "beside.avi"});
  EXPECT_EQ(over.status, 2);
  EXPECT_THAT(over.err, HasSubstr("beside.avi: --json: this file is already an input"));
  const RunResult pipeline =
      run({"filesrc location=\"beside.avi\" ! avidemux ! jpegdec", "--calib", "calib.txt", "--json", "beside.avi"});
  EXPECT_EQ(pipeline.status, 2);
  EXPECT_THAT(pipeline.err, HasSubstr("beside.avi: --json: this file is already an input"));
}

TEST_F(LiveCommand, AFilmOfOneCameraNeedsThatOfTheOther) {
  write_text(folder.path() / "sized.yaml",
             "fx_px: 320\ncx_px: 160\ncy_px: 120\nbaseline_m: 0.5\nwidth_px: 320\nheight_px: 241\n");
  for (const char* calibration : {"sized.yaml", "calib.txt"})
    for (const char* split : {"side", "top"}) {
      const RunResult result = run({"l.avi", "--calib", calibration, "--split", split});
      EXPECT_EQ(result.status, 2);
      EXPECT_THAT(result.err, HasSubstr("l.avi: image size: found whole pictures of 320 x 240 px, the size that the "
                                        "calibration is for; expected the left and the right picture in each"))
          << calibration << " " << split;
    }
  const RunResult other = run({"beside.avi", "--calib", "sized.yaml", "--split", "top"});
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.err, Not(HasSubstr("whole pictures")));
}

TEST_F(LiveCommand, ColoursAreNoMosaic) {
  const RunResult gray = run({"beside.avi", "--calib", "calib.txt", "--every-pair", "--bayer", "rggb"});
  EXPECT_EQ(gray.status, 0) << gray.err;
  cv::Mat both, color;
  cv::hconcat(street_pair().left, street_pair().right, both);
  cv::merge(std::vector<cv::Mat>{both, 0.5 * both, both}, color);
  cv::VideoWriter writer((folder.path() / "c.avi").string(), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 20.0,
                         color.size());
  for (int i = 0; i < 3; ++i) writer.write(color);
  writer.release();
  const RunResult result = run({"c.avi", "--calib", "calib.txt", "--every-pair", "--bayer", "rggb"});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("c.avi: pixels: found colours, expected the grey levels of a mosaic (--bayer)"));
}

}  // namespace
}  // namespace flies::testing
