#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "flies/io/calibration.hpp"
#include "flies/io/lens.hpp"
#include "flies/io/number_table.hpp"

namespace flies::detail {

/// Coefficients of distortion by whichever of their usual names a file has, for all formats: a list (dist_coeffs, D,
/// ...), one a key (k1, k2, p1, ...), or a map of these (distortion: {k1: ...}).

/// What lists of coefficients are called, in small letters and digits alone.
const std::vector<std::string>& distortion_names();

/// Whether that is one of them.
bool is_distortion_name(std::string_view plain);

/// Whether an entry looks like coefficients, or one of them, that are not all 0, by the last part of its key.
bool holds_distortion(std::string_view key, const NumberEntry& entry);

/// Coefficients in OpenCV's order, and where they were read.
struct FoundDistortion {
  std::string key;  ///< empty where there are none
  std::vector<double> coefficients;
};

/// Those at this key: of a list, of the first of several that stand one a key, or of a radial list that a tangential
/// one stands beside.
/// @throws InputError when they are no numbers, or of another model than the lens
FoundDistortion distortion_at(const NumberTable& table, const std::string& key, Lens lens);

/// Those of the camera whose keys begin so: "left.", or "" for a file of one camera.
/// @throws InputError as `distortion_at`
FoundDistortion distortion_below(const NumberTable& table, const std::string& place, Lens lens);

/// @throws InputError when what stands there looks like coefficients under a name that is not known
void check_no_distortion(const NumberTable& table, const std::string& place);

/// Those of a camera's own keys; none where nothing there looks like any.
/// @throws InputError as the two above
std::vector<double> distortion_of(const NumberTable& table, const std::string& place, Lens lens);

/// That a file of raw cameras says nothing of their distortion.
CalibrationNote note_on_missing_distortion();

}  // namespace flies::detail
