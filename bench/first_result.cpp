// Finds what is in one decoded pair, as `decode_pair` writes it, and ends. bench/report takes the time from the start
// of the process to its end.
#include <cstdio>

#include "bench/decoded_pair.hpp"
#include "flies/pipeline/detector.hpp"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const DecodedPair pair = read_pair(argv[1]);
  const flies::Detection found = flies::Detector(pair.camera).process(pair.view());
  std::printf("%zu obstacles, %zu people\n", found.obstacles.size(), found.pedestrians.size());
}
