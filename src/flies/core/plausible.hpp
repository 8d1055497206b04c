#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "flies/core/stereo_camera.hpp"

namespace flies::detail {

/// What no stereo camera can be is refused, what hardly one is becomes a note that says what to check.
/// @param camera numbers as `check_camera` allows them
/// @param says_size the file itself says the size of the images, so that its principal point is theirs
/// @returns sentences on what is improbable
/// @throws InputError naming field, value and the likely unit
std::vector<std::string> check_plausible(const StereoCamera& camera, const std::string& source, bool says_size = true);

/// The focal length of one camera, rectified or not.
/// @param camera its focal lengths, principal point and, where it is known, the width of its images
/// @param field in what is thrown and told
/// @param sees_to_the_side the lens bends rays so much that hardly any focal length is too short
/// @returns sentences on what is improbable
/// @throws InputError naming the likely unit
std::vector<std::string> check_focal_length(const StereoCamera& camera, const std::string& source,
                                            const std::string& field, bool sees_to_the_side = false);

/// Where the principal point of one camera lies in its images, rectified or not.
/// @param field in what is thrown and told
/// @param probable_offset from the middle, over the size of the images
/// @returns a sentence when it is improbable, else nothing
/// @throws InputError when cx and cy, or width and height, are swapped
std::optional<std::string> check_principal_point(double cx_px, double cy_px, int width_px, int height_px,
                                                 const std::string& source, const std::string& field,
                                                 double probable_offset = 0.11);

/// The size of the images that a camera without one is calibrated for, where that can be told: KITTI's cameras are
/// known by their numbers; else the principal point is near the middle, which tells the half and the quarter of a size
/// from it.
/// @param width_px, height_px of the images at hand
/// @returns width and height; nothing when the images at hand may well be those that it is for
std::optional<std::array<int, 2>> size_of_unsized(const StereoCamera& camera, int width_px, int height_px);

/// A file without a size still has a principal point near the middle of its images.
/// @throws InputError when that tells that the images were resized by one scale
void check_size_of_unsized(const StereoCamera& camera, int width_px, int height_px, const std::string& source);

/// Whether width and height of a size are exchanged, as NumPy and MATLAB say rows first: the images at hand are of
/// exactly the other way round, and the principal point lies in the middle of that.
/// @param camera principal point and size
bool has_exchanged_size(const StereoCamera& camera, int width_px, int height_px);

/// Whether the numbers of a camera are those of the images at hand, whatever size its file says: the principal point
/// lies far from the middle of that size, and in the middle of the images, from which it differs by one scale.
/// @param camera principal point and the size that the file says
bool has_numbers_of(const StereoCamera& camera, int width_px, int height_px);

/// @param camera one whose file says no size
/// @throws InputError when cx and cy are exchanged: they lie outside the images, and in their middle the other way
/// round
void check_not_exchanged(const StereoCamera& camera, int width_px, int height_px, const std::string& source,
                         const std::string& field);

/// The one scale between two sizes rounded to the nearest pixel or down, of halves and the like also up; else nothing.
std::optional<double> one_scale(int from_width_px, int from_height_px, int to_width_px, int to_height_px);

/// How images were resized.
struct ImageScale {
  double across = 1.0, down = 1.0;
};

/// The camera after its images were resized to this size.
StereoCamera scaled_camera(StereoCamera camera, ImageScale scale, int width_px, int height_px);

/// A coordinate of a pixel grid that was resized: centres of pixels lie at whole numbers.
inline double scaled_centre_px(double centre_px, double scale) { return (centre_px + 0.5) * scale - 0.5; }

/// How the camera stands. @throws InputError unless it is above the road and looks along it
void check_mount(const CameraMount& mount, const std::string& source);

/// A 3 x 3 camera matrix: fx 0 cx, 0 fy cy, 0 0 1. @throws InputError, naming the transposed one of MATLAB, and one in
/// other units than pixels
void check_camera_matrix(const std::array<double, 9>& m, const std::string& source, const std::string& key);

/// @throws InputError unless the rows are orthonormal and right-handed
void check_rotation(const std::array<double, 9>& r, const std::string& source, const std::string& key);

}  // namespace flies::detail
