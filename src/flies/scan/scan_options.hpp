#pragma once

#include "flies/core/options.hpp"

namespace flies {

/// How the cells of a pair are matched. Costs are in half grey levels of clipped gradient, summed over a cell.
struct CellOptions {
  int row_step = 2;
  int max_gradient = 7;
  int max_cost = 150;
  int slant_across = 1;
  int slant_upward = 4;
  int jump = 48;
  int certain_margin = 21;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("row_step", self.row_step, Range{1, 8}, "a cell reads four rows of pixels, this far apart");
    field("max_gradient", self.max_gradient, Range{1, 7}, "grey levels that horizontal gradients are clipped to");
    field("max_cost", self.max_cost, Range{1, 190},
          "upper limit to the cost of a cell: larger differences are due to chance");
    field("slant_across", self.slant_across, Range{0, 63},
          "cost per pixel of difference in disparity between neighbouring columns");
    field("slant_upward", self.slant_upward, Range{0, 63}, "the same between a cell and the one above it");
    field("jump", self.jump, Range{0, 63}, "cost of a larger step between neighbouring cells");
    field("certain_margin", self.certain_margin, Range{1, 255},
          "a cell counts in full when any other disparity costs at least this much more, plus a step upward");
  }
};

/// How much what speaks for or against an obstacle in a direction counts, in cells that are believed in full.
struct EvidenceOptions {
  double tolerance_px = 0.44;
  double tolerance_share = 0.023;
  double seen_through = 0.4;
  double body_height_m = 1.0;
  double seen_before = 1.7;
  double support = 1.9;
  double enough_support = 2.0;
  double obstacle = 0.8;
  double fly = 0.0;
  double slant = 0.28;
  double jump = 12.0;
  double end = 3.4;
  double memory = 0.8;
  double recall_below = 4.0;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("tolerance_px", self.tolerance_px, Range{0.05, 20},
          "disparities that differ by less count as the same place");
    field("tolerance_share", self.tolerance_share, Range{0, 0.5}, "added to tolerance_px: this share of the disparity");
    field("seen_through", self.seen_through, Range{0, 100}, "cost of a cell that shows what is behind the obstacle");
    field("body_height_m", self.body_height_m, Range{0.05, 10},
          "up to this height above the road nothing is seen through an obstacle");
    field("seen_before", self.seen_before, Range{0, 100}, "cost of a cell that shows something standing nearer");
    field("support", self.support, Range{0, 100}, "gain of a cell that shows the obstacle");
    field("enough_support", self.enough_support, Range{0.1, 100}, "more cells of support than this gain no more");
    field("obstacle", self.obstacle, Range{-100, 100}, "cost of reporting that something stands in a direction");
    field("fly", self.fly, Range{0, 100}, "weight of a fly, times its fitness, as a share of that of a cell");
    field("slant", self.slant, Range{0, 100},
          "cost per pixel of difference in disparity between neighbouring directions");
    field("jump", self.jump, Range{0, 100}, "cost of a larger step between neighbouring directions");
    field("end", self.end, Range{0, 100}, "cost of a step to or from a direction without an obstacle");
    field("memory", self.memory, Range{0, 0.95},
          "share of the evidence of the previous pair that counts again, where the motion since then is known");
    field("recall_below", self.recall_below, Range{0.1, 100},
          "that share is reduced in directions where cells show an obstacle, to nothing at this many cells");
  }
};

struct ScanOptions {
  bool enable = true;
  double angle_increment_deg = 0.5;
  double x_min_m = 3.5;
  double x_max_m = 90.0;
  double z_min_m = 0.3;
  double z_max_m = 2.3;
  double top_m = 2.1;
  double near_quantile = 0.02;
  double min_confidence = 0.0;
  CellOptions cells = {};
  EvidenceOptions evidence = {};

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("enable", self.enable, "false: no scan");
    field("angle_increment_deg", self.angle_increment_deg, Range{0.05, 10}, "width of a sector");
    field("x_min_m", self.x_min_m, Range{0.2, 100}, "nearest distance ahead that is matched");
    field("x_max_m", self.x_max_m, Range{1, 1000}, "farthest distance ahead that is told apart from the background");
    field("z_min_m", self.z_min_m, Range{0, 20}, "things lower than this above the road are no obstacles");
    field("z_max_m", self.z_max_m, Range{0.1, 20}, "things that hang higher than this above the road are no obstacles");
    field("top_m", self.top_m, Range{0.1, 20},
          "pixels are matched up to the row of this height above the road, 5 m ahead");
    field("near_quantile", self.near_quantile, Range{0, 1},
          "quantile of the ranges of an obstacle's cells: 0 the nearest");
    field("min_confidence", self.min_confidence, Range{0, 1}, "sectors of lower confidence are reported as unknown");
    field("cells", self.cells);
    field("evidence", self.evidence);
  }
};

}  // namespace flies
