#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "flies/core/stereo_camera.hpp"
#include "flies/eval/dataset.hpp"
#include "flies/synth/cut_out.hpp"
#include "flies/synth/paste.hpp"
#include "shared/staged_folder.hpp"

/// Real pairs with people pasted in, for `flies synth --paste`.
class PastedPairs {
 public:
  /// @throws flies::InputError when the pairs cannot be found
  PastedPairs(const std::string& people, const std::string& pairs, const flies::PasteOptions& options);

  /// What goes into `folder` must not take the place of what it is made of.
  /// @param entries of the folder that are replaced
  /// @throws flies::InputError naming the folder when pairs, truth or people are read from one of them
  void check_apart(const std::string& folder, const std::vector<std::string>& entries) const;

  /// Numbers of the pairs of a run: from `start` on every `step`-th, `frames` of them, which go round again when there
  /// are fewer.
  /// @throws flies::InputError when there is none
  std::vector<std::size_t> choose(int start, int step, std::optional<int> frames) const;

  /// Takes long. Call it once, before `write`.
  /// @throws flies::InputError when the people cannot be read
  void cut_out_people();

  /// Pastes people into a pair and writes both images, truth, labels and, where the pair has one, its disparity map.
  /// @param frame number of the pair in the result
  void write(const StagedFolder& folder, std::size_t frame, std::size_t pair);

  /// The calibration of what was written: one, or one a pair when they differ.
  void write_cameras(const StagedFolder& folder) const;

  /// What to tell the user at the end.
  std::string summary(const std::string& folder) const;

 private:
  /// The files that pairs, truth and people are read from.
  std::vector<std::string> inputs() const;

  std::string people_folder_;
  flies::Dataset dataset_;
  flies::CutOuts cut_outs_;
  flies::PasteOptions options_;
  std::vector<flies::StereoCamera> cameras_;  ///< of the pairs that were written
  std::size_t people_ = 0;
};
