// Writes a pair of images and its calibration decoded, for `first_result`.
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "bench/decoded_pair.hpp"
#include "flies/io/calibration.hpp"
#include "flies/io/images.hpp"

int main(int argc, char** argv) try {
  if (argc != 5 && argc != 6) {
    std::fputs("usage: decode_pair LEFT RIGHT CALIB OUT [CAMERA_HEIGHT_M]\n", stderr);
    return 2;
  }
  flies::GrayPair images = flies::load_pair(argv[1], argv[2]);
  flies::CalibrationRequest request;
  request.cameras = flies::kitti_cameras_from_paths(argv[1], argv[2]);
  request.width_px = images.left.width_px;
  request.height_px = images.left.height_px;
  if (argc == 6) request.camera_height_m = std::atof(argv[5]);
  const flies::Calibration calibration = flies::load_calibration(argv[3], request);
  if (calibration.rectifier) images = calibration.rectifier->rectify(images);
  DecodedPair pair{calibration.camera, images.left.pixels, images.right.pixels};
  pair.camera.width_px = images.left.width_px;
  pair.camera.height_px = images.left.height_px;
  write_pair(argv[4], pair);
} catch (const std::exception& error) {
  std::fprintf(stderr, "decode_pair: %s\n", error.what());
  return 2;
}
