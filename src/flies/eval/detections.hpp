#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "flies/core/results.hpp"
#include "flies/core/scan.hpp"
#include "flies/io/pair_source.hpp"

namespace flies {

/// What some program reported for one pair: a line of JSON Lines as `flies detect --json` writes them.
struct ReportedFrame {
  int line = 0;  ///< of the file, from 1
  std::optional<int> frame;
  std::string left;          ///< empty when the line does not say
  bool is_unusable = false;  ///< the line has an "error": its program could not use the pair; nothing counts as found
  std::vector<Obstacle> obstacles;
  std::optional<std::vector<Pedestrian>> pedestrians;  ///< nothing when the line has no such list
  std::optional<Scan> scan;                            ///< nothing when the line has none
  std::optional<double> time_ms;                       ///< sum of `stage_ms` up to the obstacles
  std::optional<double> people_time_ms;                ///< sum of all of `stage_ms`
};

/// Reads JSON Lines of any program. An object needs "obstacles", a list whose entries need "x_m" and "y_m"; "width_m",
/// "height_m", "score" and "range_m" (else hypot(x, y)) may be left out. "pedestrians" is such a list as well; its
/// entries need "probability", 0 to 1 (else "score", any number that grows with it) and "box" ("u_px", "v_px",
/// "width_px", "height_px") too, for they are matched in the image. "scan" is an object as `flies detect --json` writes
/// it: needed are "angle_min_rad", "angle_increment_rad", "states" (a letter a sector: o, f or u) and "ranges_m" (a
/// number where the state is o); "free_m" and "confidence" may be left out. Either all lines have people, or a scan, or
/// none, but for those with an "error", which, as `flies detect` and `flies track` write it, says why a pair could not
/// be used. Further keys are ignored, and so are empty lines.
/// @param source file name, for errors
/// @throws InputError naming the line and the key on malformed JSON, a missing key, a value of another type or a
///         position that is not finite
std::vector<ReportedFrame> parse_detections(std::string_view text, const std::string& source);

/// The same from a file.
/// @throws InputError also when it cannot be read
std::vector<ReportedFrame> read_detections(const std::string& path);

/// A sentence on the lines that say that their pair could not be used; nothing when there are none.
/// @param source file name
std::optional<std::string> note_on_unusable(const std::vector<ReportedFrame>& reported, const std::string& source);

/// Sentences on obstacles and people that cannot be where the lines say: their positions are no metres, or their ranges
/// are those of other positions.
/// @param source file name
std::vector<std::string> notes_on_positions(const std::vector<ReportedFrame>& reported, const std::string& source);

/// Puts the reports into the order of the pairs: by the name of the left image where every line has one, else by
/// "frame" (the pair's index, from 0) where every line has one, else in the order of the lines.
/// @throws InputError naming `source` when there is not exactly one line a pair
std::vector<ReportedFrame> match_detections(std::vector<ReportedFrame> reported, const std::vector<PairPaths>& pairs,
                                            const std::string& source);

}  // namespace flies
