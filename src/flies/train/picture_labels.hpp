#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "flies/core/results.hpp"

/// Label files of single pictures.
namespace flies {

/// The people of one picture, boxes from head to feet.
struct PictureLabels {
  std::string picture;            ///< file name that the labels give, empty when they give none
  std::vector<ImageBox> people;   ///< wholly visible
  std::vector<ImageBox> unclear;  ///< labelled as difficult, truncated or occluded; riders; crowds
};

/// Reads a Pascal VOC annotation. People are the objects named person, pedestrian or PASperson; other objects are
/// passed over.
/// @throws InputError naming `source` and the element: malformed XML, a missing or non-numeric coordinate, an empty box
PictureLabels parse_voc_labels(std::string_view xml, const std::string& source);

/// Reads a KITTI label_2 file: its 2-D boxes. "Pedestrian" is learnt from when it is neither truncated nor occluded;
/// "Person_sitting", "Cyclist" and "DontCare" are unclear.
/// @throws InputError naming the line on a wrong number of fields, a field that is not a number, an empty box
PictureLabels parse_kitti_boxes(std::string_view text, const std::string& source);

}  // namespace flies
