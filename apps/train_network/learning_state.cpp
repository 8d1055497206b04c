// A learning network as bytes: an archive of libtorch that holds the weights, the optimiser and all the rest as
// tensors.
#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "learning.hpp"

namespace flies {
namespace {

torch::Tensor rows_of(const std::vector<double>& values, long columns) {
  return torch::tensor(values, torch::kDouble).view({-1, columns});
}

torch::Tensor tensor_in(torch::serialize::InputArchive& archive, const std::string& name, torch::ScalarType type) {
  torch::Tensor tensor;
  archive.read(name, tensor);
  TORCH_CHECK(tensor.scalar_type() == type, name, " is of another type");
  return tensor.contiguous();
}

std::vector<double> places_as_numbers(const std::deque<Place>& places) {
  std::vector<double> values;
  for (const Place& place : places)
    for (const double value : {static_cast<double>(place.picture), place.window.u_px, place.window.v_px,
                               place.window.width_px, place.window.height_px})
      values.push_back(value);
  return values;
}

/// Nothing when a place is in none of so many pictures.
std::optional<std::deque<Place>> places_from(const torch::Tensor& rows, std::size_t pictures) {
  if (rows.dim() != 2 || rows.size(1) != 5) return std::nullopt;
  std::deque<Place> places;
  for (const double* row = rows.data_ptr<double>(); row != rows.data_ptr<double>() + rows.numel(); row += 5) {
    if (!(row[0] >= 0.0 && row[0] < static_cast<double>(pictures))) return std::nullopt;
    if (!std::all_of(row, row + 5, [](double value) { return std::isfinite(value); })) return std::nullopt;
    places.push_back({static_cast<std::uint32_t>(row[0]), {row[1], row[2], row[3], row[4]}});
  }
  return places;
}

}  // namespace

std::string Learning::state() {
  torch::serialize::OutputArchive archive, network, optimiser;
  network_.module()->save(network);
  optimiser_.save(optimiser);
  archive.write("network", network);
  archive.write("optimiser", optimiser);
  std::ostringstream random;
  random << random_;
  archive.write("random", c10::IValue(random.str()));
  archive.write("torch_random", at::detail::getDefaultCPUGenerator().get_state(), true);
  archive.write("order", torch::tensor(people_.order(), torch::kLong), true);
  archive.write("position", c10::IValue(static_cast<std::int64_t>(people_.position())));
  archive.write("hard", rows_of(places_as_numbers(hard_), 5), true);
  std::vector<double> epochs;
  for (const auto& epoch : epochs_) {
    epochs.push_back(epoch.loss);
    epochs.push_back(static_cast<double>(epoch.hard));
  }
  archive.write("epochs", rows_of(epochs, 2), true);
  std::ostringstream bytes;
  archive.save_to(bytes);
  return bytes.str();
}

bool Learning::restore(const std::string& state) {
  try {
    std::istringstream bytes(state);
    torch::serialize::InputArchive archive, network, optimiser;
    archive.load_from(bytes);
    archive.read("network", network);
    archive.read("optimiser", optimiser);
    network_.module()->load(network);
    optimiser_.load(optimiser);
    c10::IValue random, position;
    archive.read("random", random);
    archive.read("position", position);
    std::istringstream random_text(random.toStringRef());
    random_text >> random_;
    auto generator = at::detail::getDefaultCPUGenerator();
    generator.set_state(tensor_in(archive, "torch_random", torch::kByte));
    const auto order = tensor_in(archive, "order", torch::kLong);
    const std::int64_t* first = order.data_ptr<std::int64_t>();
    auto hard = places_from(tensor_in(archive, "hard", torch::kDouble), pictures_.size());
    if (random_text.fail() || !hard ||
        !people_.go_on({first, first + order.numel()}, static_cast<std::size_t>(position.toInt())))
      return false;
    hard_ = std::move(*hard);
    const auto epochs = tensor_in(archive, "epochs", torch::kDouble);
    epochs_.clear();
    for (const double* row = epochs.data_ptr<double>(); row != epochs.data_ptr<double>() + epochs.numel(); row += 2)
      epochs_.push_back({row[0], static_cast<std::size_t>(row[1])});
    return static_cast<int>(epochs_.size()) <= options_.epochs;
  } catch (const c10::Error&) {
    return false;
  }
}

}  // namespace flies
