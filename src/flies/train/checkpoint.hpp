#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "flies/train/train_options.hpp"
#include "flies/train/training_windows.hpp"

namespace flies {

/// A round of hard windows.
struct RoundSummary {
  std::string name;             ///< "round 1", or "kept apart" for the pictures that were
  std::size_t hard = 0;         ///< windows found
  std::size_t learnt_from = 0;  ///< windows without people that the next machine learns from
};

/// How far a training has come: everything that cannot be computed again quickly and exactly.
struct TrainingState {
  int rounds_done = 0;                     ///< rounds of hard windows, of both parts of the training
  std::vector<TrainingWindow> background;  ///< windows without people that the next machine learns from
  std::vector<RoundSummary> rounds = {};   ///< for the report
};

/// Keeps the state of a training in a folder, so that it can go on after an interruption. The folder belongs to one
/// training: its pictures, their sizes and all options that decide the result.
class Checkpoint {
 public:
  /// @param folder      made when there is something to keep; empty: nothing is kept
  /// @param fingerprint from `fingerprint_of`
  /// @throws InputError naming the folder when it holds the state of another training, or the state file when it is
  ///         damaged
  Checkpoint(const std::filesystem::path& folder, const std::string& fingerprint);

  const TrainingState& state() const { return state_; }

  /// @throws InputError when the state names a picture that the training, of so many of background, does not have
  void check_pictures(std::size_t background) const;

  /// @throws InputError when the folder cannot be made or the state cannot be written
  void save(TrainingState state);

  /// Removes the state, and the folder when it holds nothing else.
  void remove();

 private:
  std::filesystem::path folder_;
  std::string fingerprint_;
  TrainingState state_;
};

/// The same for the same pictures (paths, file sizes, labels, proposals) and options; the number of threads is left
/// out.
std::string fingerprint_of(std::span<const TrainingPicture> people, std::span<const TrainingPicture> background,
                           const TrainOptions& options);

}  // namespace flies
