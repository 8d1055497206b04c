#include "flies/synth/cut_out.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/core/mat_view.hpp"
#include "flies/core/quantile.hpp"
#include "flies/io/folder.hpp"
#include "flies/io/image_folder.hpp"
#include "flies/io/images.hpp"

namespace flies {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMaskEnding = "_mask";
constexpr int kLeastPixels = 64;
constexpr int kLeastSide_px = 8;
constexpr double kExtreme = 0.05;   // of a person's pixels
constexpr int kRounds = 4;          // of graph cuts; the mask hardly moves after three
constexpr double kSmooth_px = 0.6;  // standard deviation of the mask's soft edge, in crops whose person is 96 px tall

// What a standing person fills of the box that is as high as he is and 0.41 times as wide. Walkers with both legs seen
// fill about half; the bounds leave room for coats and for arms that were cut off.
constexpr double kAspect = 0.41, kLeastFill = 0.38, kMostFill = 1.0;
constexpr double kMostTopGap = 0.05, kMostFootGap = 0.05;  // of the person's height that the cut may leave out
constexpr double kMostAtEdge = 0.02;                       // of the mask that may lie at the sides of the crop

GrayImage image_of(const cv::Mat& gray) {
  const cv::Mat whole = gray.isContinuous() ? gray : gray.clone();
  return {whole.cols, whole.rows, {whole.datastart, whole.dataend}};
}

/// Where a standing person is for sure, probably, probably not, and not.
cv::Mat outline_of_a_person(const cv::Size& size, double person_share) {
  const double height = person_share * size.height, top = 0.5 * (size.height - height), middle = 0.5 * size.width;
  const auto at = [&](double across, double down) {
    return cv::Point(cvRound(middle + across * height), cvRound(top + down * height));
  };
  const auto size_of = [&](double across, double down) {
    return cv::Size(cvRound(across * height), cvRound(down * height));
  };
  const auto ellipse = [&](cv::Mat& mask, double down, double half_width, double half_height, int value) {
    cv::ellipse(mask, at(0, down), size_of(half_width, half_height), 0, 0, 360, value, cv::FILLED);
  };
  cv::Mat mask(size, CV_8UC1, cv::Scalar(cv::GC_BGD));
  ellipse(mask, 0.50, 0.25, 0.54, cv::GC_PR_BGD);
  ellipse(mask, 0.09, 0.085, 0.10, cv::GC_PR_FGD);  // head
  ellipse(mask, 0.34, 0.16, 0.22, cv::GC_PR_FGD);   // trunk and arms
  ellipse(mask, 0.72, 0.12, 0.30, cv::GC_PR_FGD);   // legs
  ellipse(mask, 0.10, 0.03, 0.05, cv::GC_FGD);
  ellipse(mask, 0.36, 0.07, 0.17, cv::GC_FGD);
  ellipse(mask, 0.56, 0.05, 0.08, cv::GC_FGD);
  return mask;
}

/// What the graph cut tells apart: grey level, that of the surroundings, and how much is going on there.
cv::Mat features_of(const cv::Mat& gray) {
  cv::Mat level, smooth, busy, features;
  cv::normalize(gray, level, 0, 255, cv::NORM_MINMAX);
  cv::GaussianBlur(level, smooth, {}, 1.5);
  cv::absdiff(level, smooth, busy);
  cv::GaussianBlur(busy, busy, {}, 1.5);
  cv::merge(std::vector<cv::Mat>{level, smooth, busy}, features);
  return features;
}

/// The largest patch of the mask. The gap between two legs is no part of it.
cv::Mat largest_patch(const cv::Mat& mask) {
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(mask, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  cv::Mat patch(mask.size(), CV_8UC1, cv::Scalar(0));
  if (outlines.empty()) return patch;
  const auto largest =
      std::ranges::max_element(outlines, {}, [](const auto& outline) { return cv::contourArea(outline); });
  cv::drawContours(patch, outlines, static_cast<int>(largest - outlines.begin()), cv::Scalar(255), cv::FILLED);
  cv::bitwise_and(patch, mask, patch);
  return patch;
}

bool is_a_standing_person(const cv::Mat& mask, double person_share) {
  const cv::Rect box = cv::boundingRect(mask);
  const double height = person_share * mask.rows, top = 0.5 * (mask.rows - height);
  const double fill = cv::countNonZero(mask) / (kAspect * height * height);
  const int at_edge = cv::countNonZero(mask.col(0)) + cv::countNonZero(mask.col(mask.cols - 1));
  return fill >= kLeastFill && fill <= kMostFill && std::abs(box.y - top) <= kMostTopGap * height &&
         std::abs(box.br().y - (top + height)) <= kMostFootGap * height &&
         at_edge <= kMostAtEdge * cv::countNonZero(mask);
}

/// Pictures in the folder and below, without the masks.
std::vector<fs::path> photographs_of(const fs::path& folder) {
  if (!detail::is_folder(folder.string())) throw InputError(folder.string(), "", "is not a folder");
  return detail::files_below(folder, [](const fs::path& file) {
    return detail::is_image_name(file) && !file.stem().string().ends_with(kMaskEnding);
  });
}

std::optional<CutOut> load_cut_out(const fs::path& file, double person_share) {
  GrayImage image = load_gray_image(file.string(), kLeastSide_px, kLeastSide_px);
  const fs::path mask_file = file.parent_path() / (file.stem().string() + kMaskEnding + ".png");
  if (!detail::is_there(mask_file)) return cut_out_person(image.view(), person_share);
  GrayImage mask = load_gray_image(mask_file.string(), kLeastSide_px, kLeastSide_px);
  if (mask.width_px != image.width_px || mask.height_px != image.height_px)
    throw InputError(mask_file.string(), "size",
                     fmt::format("found {} x {} px, expected {} x {} px, the size of its picture", mask.width_px,
                                 mask.height_px, image.width_px, image.height_px));
  return cut_out_by_mask(std::move(image), std::move(mask));
}

}  // namespace

std::optional<CutOut> cut_out_by_mask(GrayImage image, GrayImage mask) {
  const cv::Mat is_person = mat_of(mask.view()) >= 128;
  if (cv::countNonZero(is_person) < kLeastPixels) return std::nullopt;
  const cv::Rect body = cv::boundingRect(is_person);
  cv::Scalar mean, deviation;
  cv::meanStdDev(mat_of(image.view()), mean, deviation);
  CutOut cut;
  cut.body = {static_cast<double>(body.x), static_cast<double>(body.y), static_cast<double>(body.width),
              static_cast<double>(body.height)};
  std::vector<double> levels;
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    if (mask.pixels[i] >= 128) levels.push_back(image.pixels[i]);
  cut.dark = quantile(levels, kExtreme);
  cut.bright = quantile(levels, 1.0 - kExtreme);
  cut.level_mean = mean[0];
  cut.level_deviation = std::max(1.0, deviation[0]);
  cut.image = std::move(image);
  cut.mask = std::move(mask);
  return cut;
}

std::optional<CutOut> cut_out_person(const GrayView& crop, double person_share) {
  const cv::Mat gray = mat_of(crop);
  cv::Mat labels = outline_of_a_person(gray.size(), person_share), inside, outside;
  cv::theRNG().state = 1;  // the graph cut begins with clusters of grey levels that it draws
  cv::grabCut(features_of(gray), labels, {}, inside, outside, kRounds, cv::GC_INIT_WITH_MASK);
  // Not OpenCV's expressions of matrices, whose shared state ThreadSanitizer cannot see set up.
  cv::Mat is_surely, is_probably, is_person;
  cv::compare(labels, static_cast<int>(cv::GC_FGD), is_surely, cv::CMP_EQ);
  cv::compare(labels, static_cast<int>(cv::GC_PR_FGD), is_probably, cv::CMP_EQ);
  cv::bitwise_or(is_surely, is_probably, is_person);
  cv::Mat mask;
  cv::morphologyEx(is_person, mask, cv::MORPH_OPEN, cv::getStructuringElement(cv::MORPH_ELLIPSE, {3, 3}));
  mask = largest_patch(mask);
  if (!is_a_standing_person(mask, person_share)) return std::nullopt;
  cv::GaussianBlur(mask, mask, {}, kSmooth_px * person_share * gray.rows / 96.0);
  return cut_out_by_mask(image_of(gray), image_of(mask));
}

CutOuts load_cut_outs(const fs::path& folder, double person_share) {
  const std::vector<fs::path> files = photographs_of(folder);
  std::vector<std::optional<CutOut>> found(files.size());
  tbb::parallel_for(std::size_t{0}, files.size(),
                    [&](std::size_t i) { found[i] = load_cut_out(files[i], person_share); });
  CutOuts cuts{{}, files.size()};
  for (auto& cut : found)
    if (cut) cuts.people.push_back(std::move(*cut));
  if (cuts.people.empty())
    throw InputError(
        folder.string(), "",
        fmt::format("nobody could be cut out of {} pictures, expected crops of one upright person each, or "
                    "masks beside them (NAME{}.png)",
                    files.size(), kMaskEnding));
  return cuts;
}

}  // namespace flies
