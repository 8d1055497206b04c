#pragma once

#include <tbb/blocked_range.h>

#include <algorithm>
#include <cstddef>

#include "tbb/stand_in.hpp"

namespace tbb {

/// Calls `body`(part) for parts of `range`, each of its grain size at most.
template <class Value, class Body>
void parallel_for(const blocked_range<Value>& range, const Body& body) {
  const auto size = static_cast<std::size_t>(range.end() - range.begin()), grain = range.grainsize();
  stand_in::deal_out((size + grain - 1) / grain, [&](std::size_t part) {
    const auto begin = part * grain, end = std::min(begin + grain, size);
    body(blocked_range<Value>(range.begin() + static_cast<Value>(begin), range.begin() + static_cast<Value>(end),
                              grain));
  });
}

/// Calls `body`(i) for all i in [first, last).
template <class Index, class Body>
void parallel_for(Index first, Index last, const Body& body) {
  if (first >= last) return;
  stand_in::deal_out(static_cast<std::size_t>(last - first),
                     [&](std::size_t part) { body(static_cast<Index>(first + static_cast<Index>(part))); });
}

}  // namespace tbb
