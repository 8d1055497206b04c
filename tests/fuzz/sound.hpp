#pragma once

#include "flies/pipeline/detector.hpp"

/// What must hold of results, whatever the input: every number finite where it has to be, sizes not negative,
/// probabilities from 0 to 1, lists as long as they say and in their order.
namespace flies::testing {

/// Ends the program when it does not.
void require(bool ok);

void require_sound(const ImageBox& box);
void require_sound(const Scan& scan);
void require_sound(const Detection& found);

}  // namespace flies::testing
