// Runs a fuzz target without a fuzzer: over its seeds, and over as many damaged copies of each as asked for. Damage is
// drawn from a fixed seed, so that a failure comes again; the input is written before it is tried when asked for.
//   flies_fuzz_<target> [--copies N] [--seconds N] [--seed N] [--write FOLDER] [FILE...]
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string_view>

#include "tests/fuzz/target.hpp"

namespace {

struct Arguments {
  unsigned long copies = 200, seconds = 0, seed = 1;
  std::string write;
  std::vector<std::string> files;
};

Arguments parse(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    const auto number = [&] { return ++i < argc ? std::strtoul(argv[i], nullptr, 10) : 0UL; };
    if (word == "--copies")
      arguments.copies = number();
    else if (word == "--seconds")
      arguments.seconds = number();
    else if (word == "--seed")
      arguments.seed = number();
    else if (word == "--write" && i + 1 < argc)
      arguments.write = argv[++i];
    else
      arguments.files.emplace_back(word);
  }
  return arguments;
}

void try_one(const std::string& input) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
}

/// Bytes flipped, cut out, doubled, or numbers and words put in that readers trip over.
std::string damaged(std::string input, std::mt19937& random) {
  constexpr std::string_view kWords[] = {"1e30",    "1e999", "-1", "nan", "2147483648", "{}",  "[",
                                         "&a [*a]", "\xff",  "\n", "0",   "\x00",       "<a>", "99999999999"};
  const auto below = [&](std::size_t n) { return n == 0 ? std::size_t{0} : random() % n; };
  for (std::size_t wounds = 1 + below(4); wounds > 0; --wounds) {
    const std::size_t at = below(input.size() + 1), length = below(16);
    switch (below(5)) {
      case 0:
        if (at < input.size()) input[at] = static_cast<char>(random() & 255U);
        break;
      case 1:
        input.erase(at, length);
        break;
      case 2:
        input.insert(at, input.substr(at, length));
        break;
      case 3:
        input.insert(at, kWords[below(std::size(kWords))]);
        break;
      default:
        input.replace(at, length, kWords[below(std::size(kWords))]);
        break;
    }
  }
  return input;
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments arguments = parse(argc, argv);
  if (!arguments.files.empty()) {
    for (const auto& name : arguments.files) {
      std::ifstream file(name, std::ios::binary);
      try_one({std::istreambuf_iterator<char>(file), {}});
    }
    std::printf("%zu files\n", arguments.files.size());
    return 0;
  }
  const auto seeds = fuzz_seeds();
  if (!arguments.write.empty()) {
    std::filesystem::create_directories(arguments.write);
    for (std::size_t i = 0; i < seeds.size(); ++i)
      std::ofstream(std::filesystem::path(arguments.write) / ("seed-" + std::to_string(i)), std::ios::binary)
          << seeds[i];
    return 0;
  }
  std::mt19937 random(static_cast<std::mt19937::result_type>(arguments.seed));
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(arguments.seconds);
  unsigned long tried = 0;
  for (const auto& seed : seeds) try_one(seed), ++tried;
  do {
    for (const auto& seed : seeds)
      for (unsigned long i = 0; i < arguments.copies; ++i) {
        const std::string input = damaged(seed, random);
        if (const char* kept = std::getenv("FLIES_FUZZ_KEEP")) std::ofstream(kept, std::ios::binary) << input;
        try_one(input);
        ++tried;
      }
  } while (std::chrono::steady_clock::now() < until);
  std::printf("%zu seeds, %lu inputs\n", seeds.size(), tried);
  return 0;
}
