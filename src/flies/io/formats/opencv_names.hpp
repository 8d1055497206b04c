#pragma once

#include <array>
#include <string>

#include "flies/io/number_table.hpp"

namespace flies::detail {

/// How a file calls what OpenCV's stereoCalibrate and stereoRectify give: M1, cameraMatrixL, left_camera_matrix,
/// left.K, mtxL, ... Case and everything but letters and digits do not count.
struct OpenCvNames {
  /// Of left and right; those of OpenCV's own sample where the file has none.
  std::array<std::string, 2> matrices, distortions, projections;
  /// Mirrors of the omnidirectional model; empty where the file has none.
  std::array<std::string, 2> mirrors;
  std::string rotation, translation;  ///< R or a rotation vector, T; of OpenCV's sample where the file has none
  std::string pose;                   ///< both in one matrix; empty where the file has none
  std::string size;                   ///< a list: width, height; empty where the file has none
  std::array<std::string, 2> sides;   ///< width and height, one each; empty where the file has neither

  std::string reprojection;  ///< Q; empty where the file has none

  bool has_matrices = false;           ///< of one camera at least
  bool has_projections = false;        ///< likewise
  bool are_fisheyes = false;           ///< as the names of the distortions say
  bool has_reprojection_only = false;  ///< Q stands alone
  bool has_pose = false;               ///< rotation and translation, in one matrix or two
  bool is_rows_first = false;          ///< the size is a list: height, width
  bool is_of_matlab = false;           ///< the names are those of MATLAB's stereoParametersToOpenCV
};

OpenCvNames opencv_names(const NumberTable& table);

/// The file with a translation whose x, y and z stand one a key (`T: {x: ..., y: ..., z: ...}`) as the list that others
/// write.
NumberTable with_listed_translation(NumberTable table);

/// The file without what stands before the names of both cameras, as in `stereo.left.K`; as it is where nothing does. A
/// name in front that says `fisheye` is kept as the model of the lens.
NumberTable without_common_prefix(const NumberTable& table);

}  // namespace flies::detail
