// 01: one call. Reads a stereo pair and its calibration, and prints what stands on the road.
//
//   01_detect LEFT RIGHT CALIB      e.g. left.png right.png calib.yaml
//
// input.hpp reads the files. 02_stages.cpp takes the call apart, 03_own_options.cpp changes its settings, 04_scan.cpp
// reads the scan, 05_engine.cpp serves a living camera.
#include <cstdio>

#include "flies/core/error.hpp"
#include "flies/pipeline/detector.hpp"
#include "flies/road/find_mount.hpp"
#include "input.hpp"

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: %s LEFT RIGHT CALIB\n", argv[0]);
    return 2;
  }
  try {
    Input input = load_input(argv[1], argv[2], argv[3]);

    // Few calibrations say how high a camera stands and how far it looks down. The road does.
    const flies::RectifiedPair pair = input.images.view();
    input.camera.mount = flies::find_mount({&pair, 1}, input.camera).mount;

    // The detector belongs to a camera. It may be kept for a whole sequence: one `process` per pair.
    flies::Detector detector(input.camera);
    const flies::Detection detection = detector.process(pair);

    // Positions are metres in the vehicle frame: x forward, y left, origin on the road below the left camera.
    for (const auto& obstacle : detection.obstacles) {
      std::printf("obstacle   at %5.1f m ahead, %5.1f m to the left, %.1f m wide, %.1f m tall\n", obstacle.x_m,
                  obstacle.y_m, obstacle.width_m, obstacle.height_m);
    }
    for (const auto& person : detection.pedestrians) {
      std::printf("pedestrian at %5.1f m ahead, %5.1f m to the left, %.1f m tall\n", person.x_m, person.y_m,
                  person.height_m);
    }
    std::printf("%zu obstacles, %zu pedestrians\n", detection.obstacles.size(), detection.pedestrians.size());
    return 0;
  } catch (const flies::InputError& error) {
    // Everything that can be wrong with the user's files arrives here as one line.
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
