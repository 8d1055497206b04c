#pragma once

#include <array>
#include <string_view>

#include "flies/core/options.hpp"
#include "flies/evolve/kernels/scouts.hpp"

namespace flies {

/// How the first flies and the immigrants are spread.
enum class InitialDistribution {
  ratios,  ///< u and height above the road uniform, disparity at equal ratios: every distance gets its share
  image,   ///< u, disparity and height above the road uniform: every part of the image gets its share
  space,   ///< x, y and z uniform in the field of detection: most flies are far away
};
template <>
struct EnumNames<InitialDistribution> {
  static constexpr std::array<std::string_view, 3> names = {"ratios", "image", "space"};
};

struct SharingOptions {
  int cell_px = 12;
  double strength = 1.0;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("cell_px", self.cell_px, Range{1, 64}, "edge of the image cells in which flies count as crowded");
    field("strength", self.strength, Range{0, 4}, "power of the crowding that divides the fitness; 0 for no sharing");
  }
};

struct UniquenessOptions {
  bool enforce = true;
  double reach_u_px = 5.0;
  double reach_v_px = 7.0;
  double disparity_px = 2.0;
  double margin = 1.0;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("enforce", self.enforce, "a fly scores 0 if a fitter one of another disparity rivals it for the same pixels");
    field("reach_u_px", self.reach_u_px, Range{0.5, 64}, "flies this close in columns look at the same place");
    field("reach_v_px", self.reach_v_px, Range{0.5, 64}, "flies this close in rows look at the same place");
    field("disparity_px", self.disparity_px, Range{0, 64}, "difference of disparity that makes them rivals");
    field("margin", self.margin, Range{1, 100}, "the rival must be this many times as fit");
  }
};

struct MutationOptions {
  double image_px = 6.0;
  double disparity_px = 2.0;
  double cooling = 0.7;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("image_px", self.image_px, Range{0, 100}, "standard deviation of the move in u and in v");
    field("disparity_px", self.disparity_px, Range{0, 100}, "standard deviation of the move in disparity");
    field("cooling", self.cooling, Range{0.05, 1}, "factor on both deviations from one generation to the next");
  }
};

struct RefineOptions {
  double share = 0.5;
  double step_px = 0.5;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("share", self.share, Range{0, 1}, "share of the last population, the fittest, whose disparity is refined");
    field("step_px", self.step_px, Range{0.0625, 8}, "distance in disparity of the neighbours that are tried");
  }
};

struct EvolveOptions {
  int flies = 3000;
  int generations = 1;
  InitialDistribution initial = InitialDistribution::ratios;
  double informative_gray = 12.0;
  int scouts = 16;
  double keep_share = 0.25;
  double crossover_share = 0.1;
  double immigration_share = 0.5;
  double steering_share = 0.2;
  SharingOptions sharing;
  UniquenessOptions uniqueness;
  MutationOptions mutation;
  RefineOptions refine;

  template <class Self, class Field>
  static void fields(Self& self, Field&& f) {
    f("flies", self.flies, Range{1, 10'000'000}, "size of the population");
    f("generations", self.generations, Range{0, 1000}, "rounds of selection and re-generation");
    f("initial", self.initial,
      "ratios: uniform in u, height and the logarithm of disparity; image: uniform in u, height and disparity; space: "
      "uniform in x, y and z");
    f("informative_gray", self.informative_gray, Range{0, 255},
      "first flies and immigrants are drawn again while grey levels beside their projection differ by less; 0 for off");
    f("scouts", self.scouts, Range{0, kernels::kMaxScouts},
      "disparities tried for each first fly and immigrant: the one whose single row of pixels matches best is born; 0 "
      "for no choice");
    f("keep_share", self.keep_share, Range{0, 1}, "share of the population that selection keeps");
    f("crossover_share", self.crossover_share, Range{0, 1}, "share of the children that are crossed");
    f("immigration_share", self.immigration_share, Range{0, 1}, "share of the children that are drawn anew");
    f("steering_share", self.steering_share, Range{0, 1},
      "share of the children (and of the first flies) drawn on the obstacles of the last pair");
    f("sharing", self.sharing);
    f("uniqueness", self.uniqueness);
    f("mutation", self.mutation);
    f("refine", self.refine);
  }
};

}  // namespace flies
