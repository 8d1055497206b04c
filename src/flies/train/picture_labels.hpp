#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "flies/core/results.hpp"

/// Label files of single pictures.
namespace flies {

/// The people of one picture, boxes from head to feet.
struct PictureLabels {
  std::string picture;              ///< file name that the labels give, empty when they give none
  std::vector<ImageBox> people;     ///< wholly visible
  std::vector<ImageBox> unclear;    ///< labelled as difficult, truncated or occluded; riders; crowds
  int width_px = 0, height_px = 0;  ///< of the picture, as the labels say; 0: they do not say
  int upright_as_corners = 0;       ///< YOLO's boxes that are upright when their four numbers are two corners
};

/// Notices labels whose numbers mean something else than they are read as: over the whole set, for one box may be odd.
class PeopleCheck {
 public:
  /// @param source the file that the labels of a picture are from
  void add(const PictureLabels& labels, const std::string& source);

  /// @throws InputError naming the first file with such a box when most people of ten or more are wider than tall, or
  ///         when nearly all boxes are upright as corners but not as the middle, width and height that YOLO has
  void finish() const;

 private:
  std::string first_wide_, first_odd_;
  int people_ = 0, wide_ = 0;                         // to be learnt from
  int boxes_ = 0, odd_ = 0, upright_as_corners_ = 0;  // all; wide or leaving the picture
};

/// Reads a Pascal VOC annotation. People are the objects named person, pedestrian or PASperson, in capitals or not;
/// other objects are passed over.
/// @throws InputError naming `source` and the element: malformed XML, a missing or non-numeric coordinate, an empty box
PictureLabels parse_voc_labels(std::string_view xml, const std::string& source);

/// A line of a KITTI label_2 file that tells of people, or of what may be one.
struct KittiPersonLabel {
  bool is_person =
      false;  ///< "Pedestrian" (or "Person", in capitals or not); else "Person_sitting", "Cyclist", "DontCare"
  double truncation = 0.0, occlusion = 0.0;
  ImageBox box;
};

/// Reads these lines; others are passed over.
/// @throws InputError naming the line on a wrong number of fields, a field that is not a number, an empty box
std::vector<KittiPersonLabel> parse_kitti_people(std::string_view text, const std::string& source);

/// Reads a KITTI label_2 file: its 2-D boxes. "Pedestrian" (or "Person", in capitals or not) is learnt from when it is
/// neither truncated nor occluded; "Person_sitting", "Cyclist" and "DontCare" are unclear.
/// @throws InputError naming the line on a wrong number of fields, a field that is not a number, an empty box
PictureLabels parse_kitti_boxes(std::string_view text, const std::string& source);

/// Reads YOLO's labels of one picture: lines of a class and the middle, width and height of a box, or the corners of a
/// polygon, in shares of the picture's width and height. Boxes that leave the picture by over a tenth are unclear.
/// @param person the class of people; others are passed over
/// @throws InputError naming the line: a wrong number of fields, no number, a share outside of 0 to 1
PictureLabels parse_yolo_labels(std::string_view text, const std::string& source, int person, int width_px,
                                int height_px);

/// The number of the class that people are, in YOLO's list of names, a line each.
/// @throws InputError when none is a person
int parse_yolo_names(std::string_view text, const std::string& source);

/// The same of a data set's YAML, whose `names` are a list, or a map from numbers.
/// @returns nothing when the file has no `names`
/// @throws InputError when it is no YAML or none of the names is a person
std::optional<int> parse_yolo_yaml(const std::string& text, const std::string& source);

}  // namespace flies
