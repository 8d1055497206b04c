#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "flies/concentrate/concentrate_result.hpp"

namespace flies {

/// Groups points that are chained by short distances, keeping memory from call to call.
class Clustering {
 public:
  void reserve(std::size_t points);

  /// @returns the centre of each group, groups in the order of their first points; valid until the next call
  const std::vector<PixelPoint>& cluster(std::span<const PixelPoint> points, double radius_px);

 private:
  std::uint32_t leader(std::uint32_t point) const;
  void join(std::uint32_t a, std::uint32_t b);

  std::vector<std::uint32_t> by_column_;
  std::vector<std::uint32_t> parent_;  ///< union-find: a point nearer to the leader, which is the group's first point
  std::vector<std::uint32_t> members_, group_;  ///< of leaders: how many points they lead, and the index of the centre
  std::vector<PixelPoint> centres_;
};

}  // namespace flies
