// Films that are not what they say.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>
#include <string>

#include "live_command.hpp"
#include "run_flies.hpp"

namespace flies::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST_F(LiveCommand, FilmsThatEndEarlyAreTold) {
  const auto both = folder.path() / "beside.avi";
  EXPECT_THAT(run({"beside.avi", "--calib", "calib.txt", "--every-pair"}).err, Not(HasSubstr("ends after")));
  std::filesystem::resize_file(both, std::filesystem::file_size(both) / 2);
  const RunResult cut = run({"beside.avi", "--calib", "calib.txt", "--every-pair"});
  EXPECT_EQ(cut.status, 0);
  EXPECT_THAT(cut.err, HasSubstr("of the 8 pictures that it says it has; is it damaged or cut off?"));

  write_film(folder.path() / "r.avi", street_pair().right, kFrames / 2);
  const RunResult shorter = run({"l.avi", "r.avi", "--calib", "calib.txt", "--every-pair"});
  EXPECT_EQ(shorter.status, 0);
  EXPECT_THAT(shorter.err, HasSubstr("r.avi: ends after 0.20 s, l.avi is 0.40 s long"));
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
