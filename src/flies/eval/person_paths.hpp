#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "flies/core/stereo_camera.hpp"
#include "flies/eval/people.hpp"
#include "flies/eval/score.hpp"
#include "flies/eval/truth.hpp"
#include "flies/pipeline/detector.hpp"

namespace flies {

/// The stage that lost a labelled person, in the order of the pipeline. For who has a box of his own it does not matter
/// where the box came from: the first three speak of those alone who have none.
enum class PersonStage {
  no_flies,     ///< hardly a fly in his box and near him
  no_obstacle,  ///< flies, but no obstacle near him
  no_box,       ///< an obstacle, but none of its boxes overlaps his by `min_overlap`
  first_look,   ///< the classifier's first look rejects all boxes that overlap his
  suppression,  ///< they lost against a surer box of someone or something else, or were drawn away from him by others
  second_look,  ///< the last word was below the threshold
  found,
};
inline constexpr std::array<std::string_view, 7> kPersonStageNames = {
    "no_flies", "no_obstacle", "no_box", "first_look", "suppression", "second_look", "found"};
inline constexpr std::size_t kPersonStageCount = kPersonStageNames.size();

/// How far one labelled person got.
struct PersonPath {
  std::size_t object = 0;  ///< index into the truth's objects
  PersonStage stage = PersonStage::found;
  std::size_t flies = 0;            ///< in his box and near him, of any fitness above 0
  double best_overlap = 0.0;        ///< intersection over union of his box and the best proposed one, 0 to 1
  std::optional<std::size_t> rank;  ///< boxes that the first look finds surer than the surest that overlaps his enough
};

/// What of a detection was asked about people.
struct PeopleTrail {
  std::vector<PersonPath> paths;  ///< of the counted people, in the order of the truth's objects
  std::size_t boxes = 0;          ///< proposed in the pair
};

/// Follows every counted person of a pair through the stages.
/// @param reports         verdicts of any probability, as for the curve
/// @param first_threshold that boxes exceed to be looked at again
/// @param threshold       that reported people exceed
PeopleTrail follow_people(const FrameTruth& truth, const StereoCamera& camera, const Detection& detection,
                          std::span<const Pedestrian> reports, double first_threshold, double threshold,
                          const PeopleOptions& people = {}, const MatchOptions& match = {});

/// How many people each stage lost, and what the proposals are worth.
struct PeopleLosses {
  std::array<int, kPersonStageCount> people{};  ///< by stage; summed over runs
  double boxes_per_pair = 0.0;
  /// Share of the people who have a box of their own among so many boxes of their pair, the surest at first look. The
  /// last one is of all boxes, and counts none.
  std::vector<std::pair<std::optional<std::size_t>, double>> recall;
};

/// @param trails of all pairs and runs
PeopleLosses sum_up(std::span<const PeopleTrail> trails);

}  // namespace flies
