// What the components `io` and `track` are asked for: a calibration from a file, two pairs through a tracker, images as
// matrices of OpenCV.
#include <cstdint>
#include <fstream>
#include <iostream>
#include <opencv2/core.hpp>

#include "flies/core/mat_view.hpp"
#include "flies/flies.hpp"
#include "flies/io/calibration.hpp"
#include "flies/pipeline/tracker.hpp"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  std::ofstream(argv[1]) << "fx_px: 400\nfy_px: 400\ncx_px: 240\ncy_px: 110\nbaseline_m: 0.5\n"
                            "width_px: 480\nheight_px: 240\n";
  const flies::StereoCamera camera = flies::load_calibration(argv[1]).camera;
  flies::Tracker tracker(camera);
  for (int i = 0; i < 2; ++i) {
    constexpr int kDisparity_px = 20;
    cv::Mat left(camera.height_px, camera.width_px, CV_8UC1), right;
    cv::randu(left, 0, 256);
    cv::hconcat(left.colRange(kDisparity_px, left.cols), left.colRange(0, kDisparity_px), right);
    tracker.process(flies::view_of(left, right), 0.1 * i);
  }
  std::cout << "flies " << flies::library_version() << ", " << camera.baseline_m << " m\n";
  return flies::library_version() == FLIES_VERSION ? 0 : 1;
}
