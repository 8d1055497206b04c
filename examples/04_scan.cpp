// 04: the scan. What a laser scanner on the left camera would have measured: the nearest obstacle in every direction,
// and how far the ground was seen free. Prints a coarse picture of it, a line for every few degrees.
//
//   04_scan LEFT RIGHT CALIB
#include <cstddef>
#include <cstdio>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/core/free_space.hpp"
#include "flies/pipeline/detector.hpp"
#include "input.hpp"

namespace {

double area_m2(const std::vector<flies::GroundPoint>& polygon) {
  double twice_m2 = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const auto& here = polygon[i];
    const auto& next = polygon[(i + 1) % polygon.size()];
    twice_m2 += here.x_m * next.y_m - next.x_m * here.y_m;
  }
  return twice_m2 / 2.0;
}

void print_scan(const flies::Scan& scan) {
  // Sectors go from right to left, as angles grow; read the lines from the last to the first to see them from left to
  // right.
  constexpr std::size_t kEvery = 8;
  for (std::size_t sector = 0; sector < scan.size(); sector += kEvery) {
    std::printf("%6.1f degrees: ", flies::degrees(scan.angle_rad(sector)));
    switch (scan.states[sector]) {
      case flies::SectorState::obstacle:
        std::printf("obstacle at %.1f m, confidence %.2f, free to %.1f m\n", scan.ranges_m[sector],
                    scan.confidence[sector], scan.free_m[sector]);
        break;
      case flies::SectorState::free:
        std::printf("free to %.1f m, confidence %.2f\n", scan.free_m[sector], scan.confidence[sector]);
        break;
      case flies::SectorState::unknown:
        // A planner must not drive here: nothing was seen, which is not the same as nothing being there.
        std::printf("unknown\n");
        break;
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: %s LEFT RIGHT CALIB\n", argv[0]);
    return 2;
  }
  try {
    const Input input = load_input(argv[1], argv[2], argv[3]);

    flies::Detector detector(input.camera);
    const flies::Detection detection = detector.process(input.images.view());
    print_scan(detection.scan);
    // The same as a polygon, for a planner or a picture: unknown sectors are not part of it.
    std::printf("%zu sectors, %.0f square metres of ground seen free\n", detection.scan.size(),
                area_m2(flies::free_space(detection.scan)));
    return 0;
  } catch (const flies::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
