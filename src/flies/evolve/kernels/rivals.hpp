#pragma once

#include <cstddef>
#include <cstdint>

#include "flies/evolve/kernels/cells.hpp"

namespace flies::kernels {

/// What a fly looks at in one of the images.
struct Look {
  float fitness = 0.0F, u_px = 0.0F, v_px = 0.0F, disparity_px = 0.0F;
};

/// The search for rivals in one of the two images.
struct RivalSearch {
  const float *fitness, *u_px, *v_px, *disparity_px;  ///< of each fly
  std::size_t flies;
  float shift;  ///< 0 for the left image, 1 for the right one: flies look at column u - shift * disparity
  Cells cells;
  float reach_u_px, reach_v_px;  ///< rivals are this close; not larger than a cell
  float disparity_gap_px;        ///< and differ by more than this
  float margin;                  ///< and are more than so many times as fit

  Look* looks;                 ///< of each fly; memory
  std::uint32_t* cell_of_fly;  ///< memory
  std::uint32_t* listed;       ///< one more than flies; memory
  Look* fittest;               ///< of each cell, and two more; memory, without fitness before and after
};

/// Sets `rivalled` to 1 for each fly that has a rival: the fittest of its own or a neighbouring cell, if that is near
/// enough, of other disparity and fit enough. Leaves the others.
void mark_rivalled(const RivalSearch& search, std::uint8_t* rivalled);

/// The same in plain loops: the yardstick, and what runs where there are no vectors.
void mark_rivalled_scalar(const RivalSearch& search, std::uint8_t* rivalled);

}  // namespace flies::kernels
