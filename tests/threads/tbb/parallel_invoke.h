#pragma once

#include <cstddef>

#include "tbb/stand_in.hpp"

namespace tbb {

/// Calls both at once.
template <class First, class Second>
void parallel_invoke(const First& first, const Second& second) {
  stand_in::run_at_once(2, [&](std::size_t i) { i == 0 ? first() : second(); });
}

}  // namespace tbb
