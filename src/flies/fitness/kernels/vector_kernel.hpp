#pragma once

#include <vector>

#include "flies/fitness/kernels/kernel.hpp"

namespace flies::kernels {

/// The kernels for the vector instruction sets of this CPU, fastest first; none on a CPU without.
std::vector<Kernel> vector_kernels();

}  // namespace flies::kernels
