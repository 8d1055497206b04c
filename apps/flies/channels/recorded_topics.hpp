#pragma once

#include <optional>
#include <string>
#include <vector>

/// What the names of topics of ROS say of the pictures in them.

/// The topic that says how a camera sees: beside that of its pictures.
std::string camera_info_topic(std::string pictures);

/// Whether these pictures are called rectified: image_rect, image_rect_color.
bool is_called_rectified(const std::string& pictures);

struct StereoTopics {
  std::string left, right;
  bool is_by_number = false;  ///< no name says left or right
};

/// The topics of the left and of the right pictures: two whose names differ in the word for the side, or where no two
/// do, in a number that is one higher on the right: cam0 and cam1, infra1 and infra2. Of several the rectified ones, of
/// those the ones that are not compressed a second time, and of several of one camera the grey ones.
/// @param topics all that hold pictures
/// @returns nothing when no two differ so, or when those of several cameras are as good
std::optional<StereoTopics> stereo_topics(const std::vector<std::string>& topics);
