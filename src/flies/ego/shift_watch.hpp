#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "flies/core/stereo_camera.hpp"
#include "flies/ego/ego_motion.hpp"

namespace flies {

/// Watches over a run whether all disparities are too small or too large by a constant, which no single pair tells
/// where nothing far away is seen: a shift of disparities looks like a tilt of the road then.
class DisparityShiftWatch {
 public:
  /// @param ego of the next pair of the run
  void look(const EgoMotion& ego);

  /// The median of the pairs that tell a shift and half of the interval that holds the middle two thirds of them;
  /// nothing before `kLeastPairs` did.
  std::optional<DisparityShift> shift() const;

  /// Pairs that told a shift.
  std::size_t pairs() const { return shifts_px_.size(); }

  /// What to say when the shift is large and sure; empty when it is not, and after it has been said.
  std::string first_note(const StereoCamera& camera);

  static constexpr std::size_t kLeastPairs = 10;

 private:
  std::vector<double> shifts_px_;  ///< the latest ones
  bool is_told_ = false;
};

/// What to say of a shift that is large and sure; empty when it is not.
std::string note_on_shift(const DisparityShift& shift, std::size_t pairs, const StereoCamera& camera);

}  // namespace flies
