#pragma once

#include <array>
#include <string_view>

#include "flies/concentrate/whole_obstacles.hpp"
#include "flies/core/options.hpp"

namespace flies {

/// What an obstacle's position means.
enum class ObstaclePosition {
  near_face,  ///< range of its near face, middle of its width: what a driver brakes for
  candidate,  ///< where the mean shift ended (Li 2010, III.B): inside the object
};
template <>
struct EnumNames<ObstaclePosition> {
  static constexpr std::array<std::string_view, 2> names = {"near_face", "candidate"};
};

struct AssembleOptions {
  ObstaclePosition position = ObstaclePosition::near_face;
  bool merge = true;
  double depth_gap_share = 0.06;
  double lateral_gap_m = 1.2;
  double see_through_share = 0.3;
  double see_through_gap_m = 0.5;
  double max_width_m = 3.0;
  double max_surface_m = 6.0;
  double near_quantile = 0.08;
  double radius_bandwidths = 3.5;
  double min_height_m = 0.3;
  double min_height_px = 9.0;
  double min_extent_m = 0.4;
  double min_score = 0.007;
  int min_flies = 3;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("position", self.position, "near_face: nearest flies, middle of the width; candidate: end of the mean shift");
    field("merge", self.merge, "join candidates that are parts of one object; false: one obstacle per candidate");
    field("depth_gap_share", self.depth_gap_share, Range{0, 1},
          "largest gap in depth inside an object, share of range");
    field("lateral_gap_m", self.lateral_gap_m, Range{0, 10}, "largest sideways gap inside an object");
    field("see_through_share", self.see_through_share, Range{0, 1e6},
          "a gap splits an object when the fitness seen through it, farther away, is at least this share of the weaker "
          "part's fitness");
    field("see_through_gap_m", self.see_through_gap_m, Range{0, 10},
          "narrower gaps never split an object, such as those between legs or the spokes of a wheel");
    field("max_width_m", self.max_width_m, Range{0.1, 100}, "candidates are joined to things up to this width");
    field("max_surface_m", self.max_surface_m, Range{0.1, 100},
          "across half of these gaps candidates are joined up to this width: long vehicles, walls");
    field("near_quantile", self.near_quantile, Range{0, 1},
          "quantile of the flies' range that counts as the near face: 0 the nearest fly");
    field("radius_bandwidths", self.radius_bandwidths, Range{0.5, 20},
          "a fly belongs to a candidate within this many bandwidths");
    field("min_height_m", self.min_height_m, Range{0, 5}, "obstacles whose top is lower are dropped");
    field("min_height_px", self.min_height_px, Range{0, 100},
          "added to min_height_m: a fly this far above a marking still has it in its patch; keep it at "
          "fitness.half_height_px");
    field("min_extent_m", self.min_extent_m, Range{0, 5},
          "obstacles whose flies cover less than this, sideways and upwards, are dropped: one false match is a point");
    field("min_score", self.min_score, Range{0, 1e12},
          "obstacles of lower score are dropped: summed fitness of their flies over the size of the population");
    field("min_flies", self.min_flies, Range{1, 1000}, "obstacles seen by fewer flies are dropped");
  }
};

struct ConcentrateOptions {
  double view_angle_deg = 1.0;
  double half_field_deg = 45.0;
  double bin_m = 0.5;
  int samples = 2;
  double bandwidth_px = 6.0;
  int iterations = 6;
  double min_density = 0.0;
  double min_density_share = 0.02;
  AssembleOptions assemble;
  WholeOptions whole;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("view_angle_deg", self.view_angle_deg, Range{0.1, 30}, "width of a view-angle");
    field("half_field_deg", self.half_field_deg, Range{1, 89}, "view-angles cover this much to each side");
    field("bin_m", self.bin_m, Range{0.05, 10}, "interval of the histograms over x");
    field("samples", self.samples, Range{1, 10}, "sample points per view-angle: the fullest separate intervals");
    field("bandwidth_px", self.bandwidth_px, Range{0.5, 100}, "h of the mean shift, also the distance of clustering");
    field("iterations", self.iterations, Range{0, 100}, "mean shifts of every sample point");
    field("min_density", self.min_density, Range{0, 1e12}, "candidates of lower fitness density are discarded");
    field("min_density_share", self.min_density_share, Range{0, 1},
          "the same limit, as a share of the strongest candidate's density");
    field("assemble", self.assemble);
    field("whole", self.whole);
  }
};

}  // namespace flies
