// Runs a fuzz target without a fuzzer: over its seeds, and over as many damaged copies of each as asked for. Damage is
// drawn from a fixed seed, so that a failure comes again; the input is written before it is tried when asked for (the
// environment's FLIES_FUZZ_KEEP names the file). An input may take two seconds and a gigabyte.
//   flies_fuzz_<target> [--copies N] [--seconds N] [--seed N] [--write FOLDER] [FILE...]
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
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

// Sanitizers cost time, and reserve addresses without end.
#ifdef FLIES_FUZZ_SANITIZED
constexpr bool kIsSanitized = true;
#else
constexpr bool kIsSanitized = false;
#endif
#ifdef __OPTIMIZE__
constexpr double kMost_s = kIsSanitized ? 10.0 : 2.0;
#else
constexpr double kMost_s = 10.0;
#endif
constexpr rlim_t kKilobyte = 1024, kMost_kB = rlim_t{1} << 20;

/// The most address space that the program has had.
rlim_t peak_kB() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (rlim_t peak = 0; word == "VmPeak:" && status >> peak) return peak;
  return 0;
}

/// By the clock of the processor, for others may keep the machine busy.
double processor_s() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Tries inputs, and ends the program when one takes more than it may.
class Trial {
 public:
  /// What asks for far more is refused, for the machine's sake; whoever bears that is still found by what it had
  /// before.
  Trial() {
    const rlimit limit{(first_kB_ + 4 * kMost_kB) * kKilobyte, RLIM_INFINITY};
    if (!kIsSanitized && setrlimit(RLIMIT_AS, &limit) != 0) std::perror("setrlimit");
  }

  void operator()(const std::string& input) const {
    const double before_s = processor_s();
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
    const double took_s = processor_s() - before_s;
    const rlim_t took_kB = kIsSanitized ? 0 : peak_kB() - first_kB_;
    if (took_s <= kMost_s && took_kB <= kMost_kB) return;
    std::fprintf(stderr, "an input of %zu bytes took %.1f s and %.2f GB, at most %.0f s and 1 GB are allowed\n",
                 input.size(), took_s, static_cast<double>(took_kB) / static_cast<double>(kMost_kB), kMost_s);
    std::abort();
  }

 private:
  rlim_t first_kB_ = peak_kB();
};

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
  const Trial try_one;
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
  const auto keep_and_try = [&](const std::string& input) {
    if (const char* kept = std::getenv("FLIES_FUZZ_KEEP")) std::ofstream(kept, std::ios::binary) << input;
    try_one(input);
    ++tried;
  };
  for (const auto& seed : seeds) keep_and_try(seed);
  do {
    for (const auto& seed : seeds)
      for (unsigned long i = 0; i < arguments.copies; ++i) keep_and_try(damaged(seed, random));
  } while (std::chrono::steady_clock::now() < until);
  std::printf("%zu seeds, %lu inputs\n", seeds.size(), tried);
  return 0;
}
