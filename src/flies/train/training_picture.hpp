#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "flies/core/results.hpp"
#include "flies/io/gray_image.hpp"
#include "flies/pipeline/detector.hpp"

namespace flies {

/// A picture to take windows from. It is read when its turn comes.
struct TrainingPicture {
  std::string path;
  bool is_crop = false;             ///< the whole picture is one person with a known margin; may be small
  std::vector<ImageBox> people;     ///< head to feet: to be learnt from
  std::vector<ImageBox> unclear;    ///< people that are not fit to learn from, but are no background either
  bool has_proposals = false;       ///< windows without people come from `proposals` only, not from anywhere
  std::vector<ImageBox> proposals;  ///< windows that the flies proposed
  int labelled_width_px = 0, labelled_height_px = 0;  ///< that the labels say the picture has; 0: they do not say
};

/// Is told, in a sentence, what a user should know of the pictures.
using SayNote = std::function<void(const std::string&)>;

/// Finds pictures of people. What a folder holds is recognised from its content:
/// - KITTI: `label_2` beside `image_2`, in it or in `training` there, a text file a picture;
/// - Pascal VOC: an XML file a picture, in `Annotations` beside `JPEGImages`, or next to the pictures;
/// - the text of the INRIA people: a file a picture, in `annotations`, or next to the pictures;
/// - YOLO: a text file a picture, in `labels` beside `images`, or next to the pictures; people are class 0, or what
///   a YAML file with `names`, `classes.txt` or `obj.names` says; pictures without one show nobody;
/// - COCO: JSON files of many pictures each;
/// - otherwise every picture in it and below is the crop of one person.
/// Names of folders are taken in capitals or not. Below the folder pictures and labels may lie in folders of the same
/// names; equal names in several folders belong together by these. Boxes are those of pictures as they are seen, turned
/// by their EXIF orientation; where the size in the labels says that their boxes are of the stored picture, they are
/// turned along. People labelled as difficult, truncated or occluded are not learnt from.
/// @param crop_person_share height of the person, who stands in the middle, over height of a crop
/// @param note is told of pictures among labelled ones that are not used, for they have no labels; may be empty
/// @returns in name order, folder after folder; labelled pictures without a person to learn from are left out
/// @throws InputError naming the folder when it holds no pictures, or the label file and line, or a file or folder of
///         labels that are not read; when most crops are wider than high; from reading a crop
std::vector<TrainingPicture> find_pictures_of_people(std::span<const std::string> folders, double crop_person_share,
                                                     const SayNote& note = {});

/// Finds pictures to take background from: without people, or with all people labelled, as above.
/// @throws InputError as `find_pictures_of_people`
std::vector<TrainingPicture> find_background(std::span<const std::string> folders, const SayNote& note = {});

/// All files in these folders and below that the two above may read: pictures and labels.
std::vector<std::string> files_to_train_on(std::span<const std::string> folders);

/// The left images of stereo pairs with the windows that the flies propose in them. The folders are those that
/// `open_dataset` reads; all people and riders in their truth are marked as not to be learnt from.
/// @throws InputError as `open_dataset`
std::vector<TrainingPicture> find_proposals(std::span<const std::string> folders, const DetectorOptions& options);

/// The pixels. @throws InputError as `load_gray_image`, and when the labels are for a picture of another size
GrayImage load_picture(const TrainingPicture& picture);

/// Checks that the people stand in their picture, once its size is known: the middle of each inside, and none more than
/// twice as high.
/// @throws InputError naming the picture and the box
void check_labels(const TrainingPicture& picture, int width_px, int height_px);

/// The window around a person: aspect 1:2, the person in its middle with this share of its height.
ImageBox window_around(const ImageBox& person, double person_share);

}  // namespace flies
