#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "flies/train/picture_labels.hpp"

/// YOLO's labels: a text file a picture, a line an object.
namespace flies {

/// What the classes of a set are, by their numbers.
struct YoloClasses {
  std::set<int> people = {0};
  std::set<int> unclear;     ///< people that are not learnt from: who sits or rides, crowds
  int keypoint_numbers = 0;  ///< that follow a box, by the `kpt_shape` of the set; 0: it has none
  std::string source = {};   ///< file with their names; empty: the set has none
  std::set<int> named = {};  ///< all that have a name
};

/// Which lines of a set are boxes with more behind them: a confidence, a number of a track, keypoints. An odd number of
/// fields, seven or more, is a polygon's too, so the whole set is asked: a polygon has no number above 1.
class YoloLines {
 public:
  /// The lines of one picture.
  void add(std::string_view text);

  /// Whether lines of so many fields, seven or more, are boxes.
  bool are_boxes(std::size_t fields) const;

  /// How many labels there are of each class.
  const std::map<int, int>& labels_of_class() const { return labels_of_class_; }

 private:
  std::set<std::size_t> boxes_;
  std::map<int, int> labels_of_class_;
  int sevens_ = 0, sevens_with_track_ = 0;
};

/// Reads YOLO's labels of one picture: lines of a class and the middle, width and height of a box, or the corners of a
/// polygon, in shares of the picture's width and height. What follows a box (as its programs write it: keypoints, then
/// the confidence, then the number of a track) is passed over. Boxes that leave the picture by over a tenth are
/// unclear.
/// @param lines of the set
/// @throws InputError naming the line: a wrong number of fields, no number, a share outside of 0 to 1
PictureLabels parse_yolo_labels(std::string_view text, const std::string& source, const YoloClasses& classes,
                                const YoloLines& lines, int width_px, int height_px);

/// The classes by YOLO's list of names, a line each.
/// @throws InputError when none is a person
YoloClasses parse_yolo_names(std::string_view text, const std::string& source);

/// The same of a data set's YAML, whose `names` are a list, or a map from numbers.
/// @returns nothing when the file has no `names`
/// @throws InputError when it is no YAML, none of the names is a person or `kpt_shape` is no shape
std::optional<YoloClasses> parse_yolo_yaml(const std::string& text, const std::string& source);

}  // namespace flies
