#include "flies/classify/model_file.hpp"
#include "flies/core/error.hpp"
#include "tests/fuzz/target.hpp"

// Without the checksum, which would keep damage from the reader behind it.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    flies::parse_embedded_model({reinterpret_cast<const char*>(data), size}, "input");
  } catch (const flies::InputError&) {
  }
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  flies::PeopleModel model;
  model.name = "tiny";
  model.hog.window_width_px = 16;
  model.hog.window_height_px = 32;
  model.linear.weights.assign(flies::feature_count(model.hog), 0.5F);
  model.linear.reject_below = -1.0;
  model.kernel.emplace();
  model.kernel->mean.assign(model.linear.weights.size(), 0.0F);
  model.kernel->support_vectors = {1, model.linear.weights.size(), model.linear.weights};
  model.kernel->coefficients = {1.0F};
  flies::PeopleModel with_convolutions;
  with_convolutions.name = "tiny";
  with_convolutions.linear.weights.assign(flies::feature_count(with_convolutions.hog), 0.5F);
  with_convolutions.linear.reject_below = -1.0;
  with_convolutions.convolution.emplace();
  with_convolutions.convolution->layers.push_back({2, {1, 9, std::vector<float>(9, 0.5F)}, {0.0F}, 4.0});
  with_convolutions.convolution->last.assign(std::size_t{24} * 48, 0.5F);
  return {flies::people_model_text(model), flies::people_model_text(with_convolutions), "{\"a\":1e999}"};
}
