#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "flies/reproduce/labelled_frame.hpp"
#include "flies/reproduce/reproduce.hpp"

/// The paper's figures 2 to 5 of our own data.
namespace flies {

/// A picture with its number in the paper and its caption.
struct PaperFigure {
  std::string number;     ///< "2a"
  std::string caption;    ///< plain text, a sentence or two with units
  cv::Mat picture;        ///< CV_8UC3, BGR
  bool is_photo = false;  ///< holds a camera image: JPEG, otherwise lines and text: PNG
};

/// Figures 2 to 5 of a set: 2 to 4 for the frame of the shown person, 5 for up to three further frames.
std::vector<PaperFigure> paper_figures(const FrameSet& set, const SetResult& result, const PersonOptions& options);

/// Figure 3a: the left image, darkened outside the view-angle, with a box around the person.
cv::Mat draw_view_angle(const LabelledFrame& frame, const ViewAngle& view, const PersonPlace& person);

}  // namespace flies
