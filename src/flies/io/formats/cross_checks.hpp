#pragma once

#include <string>
#include <vector>

#include "flies/io/calibration.hpp"
#include "flies/io/formats/pose.hpp"
#include "flies/io/formats/quantities.hpp"
#include "flies/io/number_table.hpp"

namespace flies::detail {

/// What a file says more than once, or of itself: where that differs from what was read, ranges may be wrong.

/// Notes that a file says another distance of the cameras than the one that is used. Nothing when the user says it,
/// when one of them is 0, or when they differ by a hundred or a thousand, which is another unit.
void note_other_baseline(const FoundNumber& used, const FoundNumber& other, const CalibrationRequest& request,
                         CalibrationNotes& notes);

/// The distance of a pose, in metres.
FoundNumber length_of(const std::string& key, const Pose& pose);

/// The same of focal lengths, in pixels.
void note_other_focal_length(const FoundNumber& used, const FoundNumber& other, CalibrationNotes& notes);

/// Whether these are a Q as stereoRectify gives it: 1 0 0 -cx, 0 1 0 -cy, 0 0 0 f, 0 0 -1/Tx (cx - cx')/Tx.
bool is_reprojection(const std::vector<double>& q);

/// Notes that a Q at this key, where there is one, says another baseline or focal length.
/// @param focal that of rectified images; nothing when they are yet to be rectified
void note_other_reprojection(const NumberTable& table, const std::string& key, const FoundNumber& baseline,
                             const FoundNumber* focal, const CalibrationRequest& request, CalibrationNotes& notes);

/// What all formats have in common: a baseline by that name, Middlebury's `doffs`, and how well the calibration went.
/// @throws InputError when `doffs` contradicts the principal points
void check_statements(const NumberTable& table, const CalibrationRequest& request, Calibration& calibration);

}  // namespace flies::detail
