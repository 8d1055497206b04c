#pragma once

#include <string>
#include <vector>

#include "flies/train/picture_labels.hpp"

namespace flies {

/// Reads COCO's labels of many pictures: an object with "images", "annotations" and "categories". What a category is,
/// `label_kind` says of its name. Boxes that are crowds ("iscrowd"), or that have an attribute "occluded", "truncated"
/// or "difficult", are unclear; boxes without width or height are passed over.
/// @returns one entry an image, also for those without people, in the order of the file
/// @throws InputError naming the entry and the key: no JSON, no such lists, a missing key, a value of another type, an
///         image that is not there
std::vector<PictureLabels> parse_coco_labels(const std::string& text, const std::string& source);

}  // namespace flies
