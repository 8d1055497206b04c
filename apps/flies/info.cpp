#include <fmt/format.h>
#include <oneapi/tbb/version.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <opencv2/core/version.hpp>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#ifdef FLIES_HAS_SYNTH
#include <embree3/rtcore_config.h>
#endif

#include "flies/classify/named_models.hpp"
#include "flies/core/options.hpp"
#include "flies/fitness/fitness.hpp"
#include "flies/pipeline/detector.hpp"
#include "flies/version.hpp"
#include "shared/commands.hpp"
#include "shared/standard_output.hpp"

namespace {

std::string cpu_features() {
  std::vector<std::string_view> found;
#if defined(__x86_64__) && defined(__GNUC__)
  if (__builtin_cpu_supports("sse4.2")) found.emplace_back("sse4.2");
  if (__builtin_cpu_supports("avx")) found.emplace_back("avx");
  if (__builtin_cpu_supports("avx2")) found.emplace_back("avx2");
  if (__builtin_cpu_supports("fma")) found.emplace_back("fma");
  if (__builtin_cpu_supports("avx512f")) found.emplace_back("avx512f");
  if (__builtin_cpu_supports("avx512bw")) found.emplace_back("avx512bw");
#elif defined(__aarch64__)
  found.emplace_back("neon");
#endif
  return found.empty() ? "not known" : fmt::format("{}", fmt::join(found, " "));
}

/// The instruction set in use, and a word to those who asked for another one.
std::string fitness_kernel() {
  const std::string used(flies::kernel_target_name());
  const auto names = flies::kernel_target_names();
  const char* wanted = std::getenv("FLIES_TARGET");
  const auto same_letters = [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); };
  if (wanted == nullptr || *wanted == '\0' || std::ranges::equal(std::string_view(wanted), used, same_letters))
    return fmt::format("{} (of {})", used, fmt::join(names, " "));
  return fmt::format("{} (FLIES_TARGET is {}, but this CPU has {})", used, wanted, fmt::join(names, " "));
}

void run_info() {
  std::string text;
  const auto line = [&](std::string_view name, const std::string& value) {
    text += fmt::format("{:<16}{}\n", name, value);
  };
  line("flies", FLIES_VERSION);
  line("build type", FLIES_BUILD_TYPE);
  line("compiler", FLIES_COMPILER);
  line("opencv", CV_VERSION);
  line("tbb", TBB_runtime_version());
#ifdef FLIES_HAS_SYNTH
  line("embree", RTC_VERSION_STRING);
#endif
  line("fmt", fmt::format("{}.{}.{}", FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100));
  line("nlohmann-json",
       fmt::format("{}.{}.{}", NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH));
  line("cpu features", cpu_features());
  line("cpu threads", fmt::format("{}", std::thread::hardware_concurrency()));
  line("fitness kernel", fitness_kernel());
  line("presets", fmt::format("{}", fmt::join(flies::EnumNames<flies::Preset>::names, " ")));
  line("models",
       fmt::format("{}; default {}", fmt::join(flies::people_model_names(), " "), flies::people_model_names()[0]));
  print(text);
}

}  // namespace

void setup_info(CLI::App& app) {
  CLI::App* command = app.add_subcommand("info", "print versions, CPU features, presets and models");
  command->footer(
      "\nExample:\n"
      "  flies info\n"
      "\nThe environment variable FLIES_TARGET selects another fitness kernel for any command,\n"
      "e.g. FLIES_TARGET=SSE4 or FLIES_TARGET=scalar. Results stay the same.\n"
      "\nExit status: 0.");
  command->callback(run_info);
}
