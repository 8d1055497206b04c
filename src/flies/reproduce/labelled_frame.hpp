#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "flies/eval/dataset.hpp"
#include "flies/eval/score.hpp"
#include "flies/eval/truth.hpp"
#include "flies/reproduce/person_experiment.hpp"
#include "flies/synth/scene_options.hpp"

namespace flies {

/// A pair of which it is known what stands where.
struct LabelledFrame : TruthFrame {
  std::string name;
};

/// Renders a scene. The truth's lidar is one exact return per few pixels of the left image.
/// @throws InputError when an option is out of range
LabelledFrame render_labelled_frame(const SceneOptions& options, const std::string& name);

/// The frames of a folder with truth that show a person.
/// @param kind what the folder must hold, see `open_dataset`
/// @throws InputError naming the file when one is missing or malformed, or the folder when it is of another kind or no
///         frame shows a person
std::vector<LabelledFrame> read_frames_with_people(const std::filesystem::path& folder, TruthKind kind,
                                                   const MatchOptions& match = {});

/// People of the frame that have to be found: pedestrians, seated people and cyclists that are visible and in the range
/// of `match`.
std::vector<PersonPlace> people_in(const FrameTruth& truth, const MatchOptions& match = {});

}  // namespace flies
