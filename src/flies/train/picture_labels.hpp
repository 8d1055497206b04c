#pragma once

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
  int leaving = 0;                  ///< YOLO's boxes of people that leave the picture by over `kMaxTruncation`
  int upright_as_corners = 0;       ///< those that are upright when their four numbers are two corners
};

/// A tenth of a person outside of the picture is no more than a jitter.
inline constexpr double kMaxTruncation = 0.1;

namespace detail {

/// @throws InputError naming the field unless left < right and top < bottom
ImageBox box_between(double left, double top, double right, double bottom, const std::string& source,
                     const std::string& field);

}  // namespace detail

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

/// Reads a Pascal VOC annotation. What its objects are, `label_kind` says; people are learnt from when they are neither
/// difficult nor truncated nor occluded.
/// @throws InputError naming `source` and the element: malformed XML, a missing or non-numeric coordinate, an empty box
PictureLabels parse_voc_labels(std::string_view xml, const std::string& source);

/// A line of a KITTI label_2 file that tells of people, or of what may be one, as `label_kind` says.
struct KittiPersonLabel {
  bool is_person = false;  ///< else someone who sits or rides, or a region that is left out
  double truncation = 0.0, occlusion = 0.0;
  ImageBox box;
};

/// Reads these lines; others are passed over.
/// @throws InputError naming the line on a wrong number of fields, a field that is not a number, an empty box
std::vector<KittiPersonLabel> parse_kitti_people(std::string_view text, const std::string& source);

/// Reads a KITTI label_2 file: its 2-D boxes. "Pedestrian" is learnt from when it is neither truncated nor occluded;
/// "Person_sitting", "Cyclist" and "DontCare" are unclear.
/// @throws InputError naming the line on a wrong number of fields, a field that is not a number, an empty box
PictureLabels parse_kitti_boxes(std::string_view text, const std::string& source);

/// Reads the annotation of one picture as the INRIA and Penn-Fudan people have it, text that begins with
/// "# PASCAL Annotation Version 1.00". People as in Pascal VOC.
/// @throws InputError naming the line: no box of four numbers, an empty box
PictureLabels parse_pascal_text(std::string_view text, const std::string& source);

/// Whether a text is one for the function above.
bool is_pascal_text(std::string_view text);

}  // namespace flies
