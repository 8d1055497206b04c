#pragma once

#include <string_view>

namespace flies {

/// What a labelled object is to the training.
enum class LabelKind {
  other,   ///< background
  person,  ///< to be learnt from
  unclear  ///< neither: who sits or rides, crowds, regions that are left out
};

/// By the name of its class, in capitals or not, with hyphens, underscores and blanks or without: person, pedestrian,
/// human and PASperson, or their plurals, are people. Other names with one of these in them ("person_sitting"), or with
/// people, cyclist, rider or crowd, are unclear, and so are KITTI's "DontCare" and names that begin with "ignore".
LabelKind label_kind(std::string_view name);

}  // namespace flies
