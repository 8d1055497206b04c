#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "flies/core/gray_view.hpp"
#include "flies/core/stereo_camera.hpp"

namespace flies {

/// What can go wrong with some pairs of a run, the gravest first.
enum class PairTrouble {
  left_blank,     ///< nothing to match in the left image: dark, white, covered
  right_blank,    ///< the same of the right one
  swapped,        ///< left and right
  unrelated,      ///< not two views of one scene at one moment, or not rectified
  left_repeats,   ///< the left image is that of the pair before to the bit, the right one is not
  right_repeats,  ///< the other way round
  both_repeat,    ///< both are those of the pair before
  too_near,       ///< something stands nearer than is looked at
};
inline constexpr std::size_t kPairTroubles = 8;

/// From where on things are looked for.
struct NearEnd {
  double range_m = 0.0;     ///< 0: any
  std::string preset = {};  ///< of the options that say so: that for near things is not recommended to who has it
};

/// What to say of a pair that shows something nearer than that, where nothing is looked for: it is not reported, or
/// farther away than it is.
std::optional<std::string> note_on_near_things(const RectifiedPair& pair, const StereoCamera& camera,
                                               const NearEnd& near);

/// Looks at every pair of a run, as cheaply as can be (less than a millisecond), for what the diagnosis of a few pairs
/// does not see: faults that begin, or come and go, while the run lasts.
class PairWatch {
 public:
  /// @param pair rectified, both images of one size, 64 x 48 px at least; the next one of the run
  /// @param name of the pair, in what is told
  /// @returns a sentence for each kind of trouble that is met for the first time
  std::vector<std::string> look(const RectifiedPair& pair, const StereoCamera& camera, const std::string& name,
                                const NearEnd& near = {});

  /// Whether the pair that was looked at last is surely none: swapped, or of other scenes or moments. `check_true_pair`
  /// refuses it and says more; what is found in it stands nowhere.
  bool is_no_pair() const { return is_no_pair_; }

  bool has_near_things() const { return met_.back().pairs > 0; }

  /// A sentence for each kind of trouble with the pairs that have it and the first of them, in the order of
  /// `PairTrouble`; empty when all are well.
  std::vector<std::string> counts() const;

 private:
  struct Met {
    std::uint64_t pairs = 0;
    std::string first;
  };
  bool meet(PairTrouble trouble, const std::string& name);

  std::array<Met, kPairTroubles> met_{};
  std::uint64_t pairs_ = 0;
  bool is_no_pair_ = false;
  std::optional<std::array<std::uint64_t, 2>> last_;  ///< sums of the pair before
};

}  // namespace flies
