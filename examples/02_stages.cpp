// 02: stage by stage. The same result as 01_detect, by the free functions that `Detector::process` calls. Use them to
// stop half way, to replace a stage by your own, or to look at what lies between.
//
//   02_stages LEFT RIGHT CALIB
#include <algorithm>
#include <cstdio>

#include "flies/core/error.hpp"
#include "flies/pipeline/detector.hpp"
#include "flies/road/find_mount.hpp"
#include "input.hpp"

namespace {

void run(const flies::GrayPair& images, flies::StereoCamera camera) {
  // The options are nested like the calls below; these are the values of the preset `default`.
  const flies::DetectorOptions options;
  const flies::RectifiedPair pair = images.view();

  // 0. How does the camera stand? Few calibrations say; the road does.
  camera.mount = flies::find_mount({&pair, 1}, camera).mount;
  const flies::Projection projection(camera);

  // 1. Where is the road? Calibrations know the camera's height and tilt only roughly.
  const flies::RoadResult road = flies::estimate_road(pair, projection, options.road);
  std::printf("road: %s, %.2f m at the car, rises %.1f %%\n", road.found ? "fitted" : "nominal", road.plane.height_m,
              100 * road.plane.slope);

  // 2. Flies: points in space that score high where both images show the same thing. They are random, and the same
  //    for the same seed and frame.
  const flies::EvolveResult evolved = flies::evolve(pair, projection, road.plane, options.field, options.fitness,
                                                    options.evolve, {.seed = options.seed, .frame = 0});
  const flies::Population& population = evolved.flies;
  const auto scored =
      std::count_if(population.fitness.begin(), population.fitness.end(), [](float f) { return f > 0; });
  std::printf("evolve: %zu flies, %td with fitness, %zu evaluations\n", population.size(), scored, evolved.evaluations);

  // 3. The scan: what a laser scanner would have measured, sector by sector.
  const flies::Scan scan = flies::scan(pair, projection, road.plane, population, options.field, options.scan);
  const auto seen = std::count(scan.states.begin(), scan.states.end(), flies::SectorState::obstacle);
  std::printf("scan: %zu sectors, an obstacle in %td\n", scan.size(), seen);

  // 4. Concentrating: from many flies to few obstacles. Every step on the way is part of the result. What flies and
  //    scan show of one thing is then made whole.
  const flies::ConcentrateResult concentrated =
      flies::concentrate(population, projection, road.plane, options.field, options.concentrate);
  std::printf("concentrate: %zu view-angles, %zu shifted points, %zu candidates, %zu obstacles\n",
              concentrated.view_angles.size(), concentrated.shifted.size(), concentrated.candidates.size(),
              concentrated.obstacles.size());
  const auto obstacles =
      flies::whole_obstacles(concentrated.obstacles, scan, projection, road.plane, options.concentrate.whole);

  const auto classifier = flies::default_people_classifier();

  // 5. Where would a person be, if what the flies show were one? Boxes with the feet on the road, of several heights,
  //    and the same before surfaces of the scan that no obstacle covers.
  const auto rois = flies::propose_rois(concentrated.obstacles, scan, projection, road.plane, pair.left.width_px,
                                        pair.left.height_px, flies::for_classifier(options.propose, *classifier));
  std::printf("propose: %zu boxes\n", rois.size());

  // 6. The classifier scores the boxes; of boxes that show the same person the surest is kept.
  const auto pedestrians = flies::find_people(pair.left, rois, *classifier, options.classify).pedestrians;
  std::printf("classify: %zu pedestrians with the model %s\n", pedestrians.size(), classifier->name().c_str());

  // The lines of 01_detect.
  for (const auto& obstacle : obstacles) {
    std::printf("obstacle   at %5.1f m ahead, %5.1f m to the left, %.1f m wide, %.1f m tall\n", obstacle.x_m,
                obstacle.y_m, obstacle.width_m, obstacle.height_m);
  }
  for (const auto& person : pedestrians) {
    std::printf("pedestrian at %5.1f m ahead, %5.1f m to the left, %.1f m tall\n", person.x_m, person.y_m,
                person.height_m);
  }
  std::printf("%zu obstacles, %zu pedestrians\n", obstacles.size(), pedestrians.size());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: %s LEFT RIGHT CALIB\n", argv[0]);
    return 2;
  }
  try {
    const Input input = load_input(argv[1], argv[2], argv[3]);
    run(input.images, input.camera);
    return 0;
  } catch (const flies::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
