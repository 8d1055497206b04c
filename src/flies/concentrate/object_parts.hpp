#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "flies/concentrate/ascending_order.hpp"
#include "flies/concentrate/concentrate_options.hpp"
#include "flies/concentrate/concentrate_result.hpp"
#include "flies/concentrate/sightings.hpp"

namespace flies {

/// Where something is seen from the camera, like the echo of a laser scanner: intervals of range and azimuth, and of
/// height above the road.
struct Extent {
  double near_m = 0.0, far_m = 0.0;  ///< range along the ground
  double right_rad = 0.0, left_rad = 0.0;
  double bottom_m = 0.0, top_m = 0.0;

  double width_m() const { return near_m * (left_rad - right_rad); }
  double azimuth_rad() const { return 0.5 * (right_rad + left_rad); }
};

/// What ends a list of flies, and who owns a fly that belongs to no candidate.
inline constexpr std::uint32_t kNone = UINT32_MAX;

/// The values that flies are kept in ascending order of.
enum Order : std::size_t { kByRange, kByAzimuth, kByHeight, kOrders };

/// A candidate with the flies that belong to it: an object, or a part of one until it is joined to others.
struct Part {
  Candidate candidate;                                               ///< the densest of those joined
  Extent extent;                                                     ///< of its flies
  std::size_t flies = 0;                                             ///< how many
  double fitness = 0.0;                                              ///< summed over its flies
  double squared_fitness = 0.0;                                      ///< likewise
  std::array<std::uint32_t, kOrders> first = {kNone, kNone, kNone};  ///< the nearest, rightmost and lowest of its flies
};

/// The parts and their flies. The flies of a part are a linked list in each order, so that joining parts is merging
/// lists and needs no memory. Keeps what it has from call to call.
class ObjectParts {
 public:
  void reserve(std::size_t flies, std::size_t candidates);

  /// Makes and measures a part of each candidate that owns flies.
  /// @param flies must outlive this object's use
  /// @param owner of each fly: index into `candidates` or `kNone`
  void gather(const Sightings& flies, std::span<const Candidate> candidates, std::span<const std::uint32_t> owner,
              double near_quantile);

  /// Joins parts of one object, closest first: the gaps between them in range and sideways are small, the whole is no
  /// larger than an object may be, and nothing farther away is seen through the gap.
  void join(const AssembleOptions& options);

  std::vector<Part>& parts() { return parts_; }

  /// Calls `use` with the index, into the sightings, of each fly of the part.
  template <class Use>
  void for_each_fly(const Part& part, const Use& use) const {
    for (auto i = part.first[kByAzimuth]; i != kNone; i = next_[kByAzimuth][i]) use(i);
  }

 private:
  /// Parts that may belong together. The closest is least, of equally close ones that of the first parts.
  struct Neighbours {
    double separation;
    std::uint32_t first, second;

    auto operator<=>(const Neighbours&) const = default;
  };

  void find_owned(std::span<const std::uint32_t> owner);
  void sum_up(std::span<const std::uint32_t> owner);
  void link(Order order, std::span<const std::uint32_t> owner);
  std::span<const float> values(Order order) const;
  void measure(Part& part, double near_quantile) const;
  void join(Part& part, Part& other, double near_quantile);

  const Sightings* flies_ = nullptr;
  std::vector<Part> parts_;
  std::array<std::vector<std::uint32_t>, kOrders> next_;  ///< fly of the same part after each, or `kNone`
  std::vector<std::uint32_t> owned_;  ///< the flies that a part owns, from right to left, and a value of each
  std::vector<float> values_;
  AscendingOrder order_;
  std::vector<Neighbours> neighbours_;
};

}  // namespace flies
