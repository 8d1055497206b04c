#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstddef>
#include <span>

#include "flies/core/fly.hpp"
#include "flies/fitness/fitness.hpp"

namespace flies {

/// Flies a task: large enough to hide the scheduler, small enough to balance two dozen cores and to stay in cache.
constexpr std::size_t kFliesPerTask = 256;

/// Calls `work`(begin, end) for parts of [begin, end) on oneTBB's current arena.
template <class Work>
void for_parts(std::size_t begin, std::size_t end, const Work& work) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(begin, end, kFliesPerTask),
                    [&](const auto& range) { work(range.begin(), range.end()); });
}

/// Scores the flies [begin, end).
inline void score_part(const RectifiedPair& pair, const FitnessOptions& options, std::size_t begin, std::size_t end,
                       ImagePopulation& flies) {
  const auto part = [&](std::vector<float>& values) { return std::span(values).subspan(begin, end - begin); };
  score_points(pair, options, part(flies.u_px), part(flies.v_px), part(flies.disparity_px), part(flies.fitness));
}

}  // namespace flies
