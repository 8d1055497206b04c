#include "flies/core/error.hpp"
#include "flies/io/number_table.hpp"
#include "flies/io/options_yaml.hpp"
#include "flies/pipeline/detector.hpp"
#include "tests/fuzz/calibration_seeds.hpp"
#include "tests/fuzz/target.hpp"

// Tables of numbers, behind all calibration formats, and options.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    flies::parse_number_table(text, "input");
  } catch (const flies::InputError&) {
  }
  try {
    flies::parse_options_yaml(text, "input");
  } catch (const flies::InputError&) {
  }
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  std::vector<std::string> seeds = {
      "P2: 700 0 600 0 0 700 170 0 0 0 1 0\nP3: 700 0 600 -280 0 700 170 0 0 0 1 0\nR0_rect: 1 0 0 0 1 0 0 0 1\n",
      "seed: 3\nevolve:\n  flies: 5000\n  initial: image\nroad.estimate: false\n",
      "a: &a [[],[],[],[]]\nb: &b [*a,*a,*a,*a]\nc: &c [*b,*b,*b,*b]\nd: [*c,*c,*c,*c]\n",
      flies::options_yaml(flies::list_options(flies::DetectorOptions{}))};
  for (const auto& files : flies::testing::calibration_seeds()) seeds.push_back(files.substr(0, files.find('\0')));
  return seeds;
}
