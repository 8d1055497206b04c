#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "flies/core/options.hpp"

namespace flies {

/// Which machine has the last word.
enum class SvmKernel {
  linear,  ///< a linear machine alone
  rbf,     ///< behind it a machine with a Gaussian kernel, for the windows that the linear one does not reject
};
template <>
struct EnumNames<SvmKernel> {
  static constexpr std::array<std::string_view, 2> names = {"linear", "rbf"};
};

/// How a labelled person becomes training windows: as it is, mirrored, and off by as much as proposed boxes are.
struct PositiveOptions {
  double person_share = 0.75;
  int jitters = 4;
  double jitter_scale = 0.1;
  double jitter_shift = 0.03;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("person_share", self.person_share, Range{0.3, 1.0},
          "height of the person over height of the window; detection must use the same (propose.person_share)");
    field("jitters", self.jitters, Range{0, 64},
          "windows that are slightly off, in addition to the exact one and its mirror image");
    field("jitter_scale", self.jitter_scale, Range{0.0, 0.5}, "their size is off by up to this share");
    field("jitter_shift", self.jitter_shift, Range{0.0, 0.5},
          "their position is off by up to this share of the height");
  }
};

/// Where windows without people come from.
struct NegativeOptions {
  int first = 12000;
  int rounds = 3;
  int windows_per_picture = 800;
  int per_round = 12000;
  int per_picture = 200;
  int validation_per_picture = 2000;
  double min_height_px = 80.0;
  double min_proposed_px = 50.0;
  double hard_above = -1.0;
  double max_overlap = 0.3;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("first", self.first, Range{1, 10000000}, "windows drawn at random for the first machine, over all pictures");
    field("rounds", self.rounds, Range{0, 32},
          "rounds of hard windows: those that the machine so far takes for people");
    field("windows_per_picture", self.windows_per_picture, Range{1, 1000000},
          "new windows drawn from every picture in every round; only the hard ones are kept");
    field("per_round", self.per_round, Range{1, 10000000}, "hard windows added in a round at most, the hardest first");
    field("per_picture", self.per_picture, Range{1, 1000000}, "hard windows added from one picture in a round at most");
    field("validation_per_picture", self.validation_per_picture, Range{1, 1000000},
          "windows drawn from every picture kept apart, for calibration, threshold and report");
    field("min_height_px", self.min_height_px, Range{8.0, 4096.0}, "height of the smallest of these windows");
    field("min_proposed_px", self.min_proposed_px, Range{8.0, 4096.0},
          "height of the smallest persons for whom boxes are proposed on stereo pairs; smaller ones would be blurred "
          "by enlarging");
    field("hard_above", self.hard_above, Range{-10.0, 10.0},
          "score above which a window is hard; -1 is the margin, windows below it do not change a machine");
    field("max_overlap", self.max_overlap, Range{0.0, 1.0},
          "a window that shares more of its union with a labelled person's window is not taken");
  }
};

struct LinearSvmOptions {
  double c = 0.01;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("c", self.c, Range{1e-6, 1e6}, "penalty for a window on the wrong side of the margin");
  }
};

struct KernelSvmOptions {
  double c = 10.0;
  double gamma = 0.03;
  int projection = 200;
  double reject_below = -1.5;
  int rounds = 1;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("c", self.c, Range{1e-6, 1e6}, "penalty for a window on the wrong side of the margin");
    field("gamma", self.gamma, Range{1e-9, 1e6}, "gamma in the kernel exp(-gamma * distance^2)");
    field("projection", self.projection, Range{1, 100000}, "principal axes of the features that are kept");
    field("reject_below", self.reject_below, Range{-100.0, 100.0},
          "score of the linear machine below which a window is rejected without asking the second one");
    field("rounds", self.rounds, Range{0, 32}, "rounds of hard windows that both machines so far take for people");
  }
};

/// All options of training, nested like the calls.
struct TrainOptions {
  std::uint64_t seed = 1;
  int threads = 1;
  SvmKernel kernel = SvmKernel::linear;
  int window_height_px = 96;
  double false_positive_rate = 1e-4;
  double validation_share = 0.2;
  bool refit = true;
  PositiveOptions positives;
  NegativeOptions negatives;
  LinearSvmOptions linear;
  KernelSvmOptions rbf;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("seed", self.seed, "seed of all random numbers; same pictures, seed and options give the same model");
    field("threads", self.threads, Range{0, 256},
          "worker threads, 0 for one per core; the model does not depend on it");
    field("kernel", self.kernel, "linear: one machine; rbf: a second one with a Gaussian kernel behind it");
    field("window_height_px", self.window_height_px, Range{32, 512},
          "height that windows are resized to, twice their width, a multiple of 16; smaller windows are classified "
          "faster");
    field("false_positive_rate", self.false_positive_rate, Range{0.0, 1.0},
          "the threshold lets this share of the validation windows without people through");
    field("validation_share", self.validation_share, Range{0.01, 0.9},
          "share of the pictures that is kept apart for calibration, threshold and report");
    field("refit", self.refit, "finally train the machines that are written on all pictures, those kept apart too");
    field("positives", self.positives);
    field("negatives", self.negatives);
    field("linear", self.linear);
    field("rbf", self.rbf);
  }
};

}  // namespace flies
