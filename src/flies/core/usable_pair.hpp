#pragma once

#include "flies/core/gray_view.hpp"

namespace flies::detail {

/// The pair as the stages take it: views that have no stride (0) are packed, one row directly behind the other.
/// @throws InputError as `check_pair`, and for a stride that is shorter than a row
RectifiedPair usable_pair(RectifiedPair pair);

/// Whether both images show the same levels everywhere, and more than one. Images of two cameras differ in the first
/// row, but where both see nothing, black or white.
/// @param pair as `usable_pair` returns it
bool is_one_image_twice(const RectifiedPair& pair);

}  // namespace flies::detail
