// 05: a living camera. An engine has a thread of its own: pairs go in when they come, results are read when they are
// needed.
//
//   05_engine LEFT RIGHT CALIB
//
// The one pair given here stands for a camera that stands still: it is submitted twenty times, a hundred times a
// second.
#include <chrono>
#include <cstdio>
#include <thread>

#include "flies/core/error.hpp"
#include "flies/pipeline/engine.hpp"
#include "input.hpp"

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: %s LEFT RIGHT CALIB\n", argv[0]);
    return 2;
  }
  try {
    const Input input = load_input(argv[1], argv[2], argv[3]);

    flies::Engine engine(input.camera);
    // The camera: it waits for nobody. Were the engine too slow, pairs would be dropped and counted.
    std::thread camera([&] {
      for (int i = 0; i < 20; ++i) {
        engine.submit(input.images.view(), 0.01 * i);
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      }
    });
    camera.join();

    // The user, at any time: `snapshot` is what is known now, `wait` waits for the next result.
    auto snapshot = engine.snapshot();
    while (snapshot->tracking.time_s < 0.19) snapshot = engine.wait(snapshot->number, std::chrono::seconds(10));
    for (const auto& track : snapshot->tracking.tracks)
      std::printf("track %llu at %5.1f m ahead, %5.1f m to the left, %4.1f m/s\n",
                  static_cast<unsigned long long>(track.id), track.state.x_m, track.state.y_m, track.velocity.vx_mps);
    std::printf("%zu tracks; %llu pairs, %llu of them dropped\n", snapshot->tracking.tracks.size(),
                static_cast<unsigned long long>(snapshot->submitted),
                static_cast<unsigned long long>(snapshot->dropped));
    return 0;
  } catch (const flies::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
