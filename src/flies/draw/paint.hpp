#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "flies/core/results.hpp"

/// Small brushes shared by the pictures of this module; not installed.
namespace flies::paint {

inline const cv::Scalar kBlack{0, 0, 0};
inline const cv::Scalar kWhite{255, 255, 255};
inline const cv::Scalar kPaper{250, 250, 250};
inline const cv::Scalar kInk{40, 40, 40};
inline const cv::Scalar kGridLine{215, 215, 215};
inline const cv::Scalar kPanel{32, 32, 32};
inline const cv::Scalar kGreen{60, 200, 0};
inline const cv::Scalar kRed{0, 0, 255};
inline const cv::Scalar kGray{150, 150, 150};

inline constexpr double kSmallText = 0.42;
inline constexpr double kTitleText = 0.55;

/// Rounds to a pixel; keeps positions far outside or not finite where drawing clips them instead of overflowing.
int pixel(double position_px);
cv::Point pixel(double u_px, double v_px);
cv::Rect pixel_rect(const ImageBox& box);

/// @throws nothing; an empty `image` gives an empty BGR image
cv::Mat as_bgr(const cv::Mat& image);

/// `image` in the top-left corner of a canvas at least `min_width_px` wide with `strip_height_px` more rows.
cv::Mat with_strip(const cv::Mat& image, int strip_height_px, int min_width_px);

cv::Size text_size(const std::string& text, double scale = kSmallText);
/// @param left_baseline left end of the baseline
void put_text(cv::Mat& canvas, const std::string& text, cv::Point left_baseline, const cv::Scalar& color,
              double scale = kSmallText);
/// The same with an outline, readable on any image.
void put_outlined_text(cv::Mat& canvas, const std::string& text, cv::Point left_baseline, const cv::Scalar& color,
                       const cv::Scalar& outline = kBlack);
void put_centred_text(cv::Mat& canvas, const std::string& text, cv::Point centre_baseline, const cv::Scalar& color,
                      double scale = kSmallText);
/// Text that reads upwards, centred on `centre`.
void put_upward_text(cv::Mat& canvas, const std::string& text, cv::Point centre, const cv::Scalar& color,
                     double scale = kSmallText);

/// Places labels next to boxes so that they neither overlap one another nor leave the image.
class LabelPlacer {
 public:
  explicit LabelPlacer(cv::Rect area, const cv::Scalar& outline = kBlack) : area_(area), outline_(outline) {}
  /// Keeps labels off this place.
  void block(const cv::Rect& place) { taken_.push_back(place); }
  /// Draws the label above, inside or below the box, or nowhere when no place is free.
  void put(cv::Mat& canvas, const std::string& text, const cv::Rect& box, const cv::Scalar& color);

 private:
  cv::Rect area_;
  cv::Scalar outline_;
  std::vector<cv::Rect> taken_;
};

/// `fitness_color` as OpenCV takes it.
cv::Scalar fitness_bgr(double relative_fitness);

/// A horizontal colour bar; `color` maps 0..1 along it.
void put_color_bar(cv::Mat& canvas, const cv::Rect& bar, const std::function<cv::Scalar(double)>& color);

/// Indices of `values` from small to large, so that the strongest is drawn last.
std::vector<std::size_t> ascending(const std::vector<float>& values);

/// A number with three significant digits for an axis, e.g. "0.25", "12400", "1.2e+09".
std::string short_number(double value);

}  // namespace flies::paint
