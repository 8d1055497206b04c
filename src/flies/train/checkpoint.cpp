#include "flies/train/checkpoint.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <exception>
#include <nlohmann/json.hpp>
#include <system_error>

#include "flies/core/convert.hpp"
#include "flies/core/error.hpp"
#include "flies/eval/text.hpp"
#include "flies/io/folder.hpp"
#include "flies/io/output_file.hpp"
#include "flies/train/fingerprint.hpp"

namespace flies {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* kStateFile = "state.json";

/// What a state holds cannot be.
class Damaged : public std::exception {};

Json json_of(const TrainingWindow& w) {
  return {w.picture, w.is_mirrored, w.window.u_px, w.window.v_px, w.window.width_px, w.window.height_px};
}

/// What can be in a state: pictures have up to 32768 pixels a side, trainings some rounds.
constexpr double kMaxPixel = 1e6;
constexpr double kMaxRounds = 10000;

template <class Int>
Int whole(const Json& json, double highest = 1e15) {
  const auto value = whole_number<Int>(json.get<double>());
  if (!value || *value < 0 || static_cast<double>(*value) > highest) throw Damaged();
  return *value;
}

TrainingWindow window_of(const Json& json) {
  const TrainingWindow window{
      whole<std::uint32_t>(json.at(0)),
      json.at(1).get<bool>(),
      {json.at(2).get<double>(), json.at(3).get<double>(), json.at(4).get<double>(), json.at(5).get<double>()}};
  const ImageBox& box = window.window;
  for (const double value : {box.u_px, box.v_px, box.width_px, box.height_px})
    if (!(std::abs(value) <= kMaxPixel)) throw Damaged();
  if (!(box.width_px > 0.0 && box.height_px > 0.0)) throw Damaged();
  return window;
}

InputError damaged(const fs::path& file) {
  return {file.string(), "", "is damaged, expected the state of a training; remove it to start again"};
}

}  // namespace

std::string fingerprint_of(std::span<const TrainingPicture> people, std::span<const TrainingPicture> background,
                           const TrainOptions& options) {
  Fingerprint fingerprint;
  for (const auto& listing : list_options(options))
    if (listing.path != "threads") fingerprint.add(listing.path + "=" + listing.value);
  for (const auto& pictures : {people, background}) {
    for (const auto& picture : pictures) {
      std::error_code error;
      fingerprint.add(picture.path);
      fingerprint.add(fmt::format("{}", fs::file_size(picture.path, error)));
      fingerprint.add(picture.people);
      fingerprint.add(picture.unclear);
      fingerprint.add(picture.proposals);
    }
    fingerprint.add("end");
  }
  return fingerprint.text();
}

Checkpoint::Checkpoint(const fs::path& folder, const std::string& fingerprint)
    : folder_(folder), fingerprint_(fingerprint) {
  if (folder_.empty()) return;
  const fs::path file = folder_ / kStateFile;
  if (!detail::is_there(file)) return;
  Json json;
  TrainingState state;
  try {
    json = Json::parse(detail::read_truth(file));
    if (json.at("fingerprint") != fingerprint_)
      throw InputError(
          folder_.string(), "",
          "holds the state of a training with other pictures or options; remove it or name another folder");
    state.rounds_done = whole<int>(json.at("rounds_done"), kMaxRounds);
    for (const auto& round : json.at("rounds"))
      state.rounds.push_back(
          {round.at(0).get<std::string>(), whole<std::size_t>(round.at(1)), whole<std::size_t>(round.at(2))});
    for (const auto& window : json.at("background")) state.background.push_back(window_of(window));
  } catch (const Json::exception&) {
    throw damaged(file);
  } catch (const Damaged&) {
    throw damaged(file);
  }
  state_ = std::move(state);
}

void Checkpoint::check_pictures(std::size_t background) const {
  for (const auto& window : state_.background)
    if (window.picture >= background) throw damaged(folder_ / kStateFile);
}

void Checkpoint::save(TrainingState state) {
  state_ = std::move(state);
  if (folder_.empty()) return;
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) throw InputError(folder_.string(), "", "cannot create the folder: " + error.message());
  Json windows = Json::array();
  for (const auto& window : state_.background) windows.push_back(json_of(window));
  Json rounds = Json::array();
  for (const auto& round : state_.rounds) rounds.push_back({round.name, round.hard, round.learnt_from});
  const Json json = {{"fingerprint", fingerprint_},
                     {"rounds_done", state_.rounds_done},
                     {"rounds", std::move(rounds)},
                     {"background", std::move(windows)}};
  write_file((folder_ / kStateFile).string(), json.dump());
}

void Checkpoint::remove() {
  if (folder_.empty()) return;
  std::error_code error;  // what cannot be removed does no harm
  fs::remove(folder_ / kStateFile, error);
  fs::remove(folder_, error);
}

}  // namespace flies
