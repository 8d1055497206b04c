#include "flies/io/images.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/io/gray_levels.hpp"
#include "flies/io/image_borders.hpp"
#include "flies/io/image_codecs.hpp"
#include "flies/io/image_file.hpp"
#include "flies/io/text_file.hpp"

namespace flies {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{1} << 30;

using Notes = std::vector<std::string>;

cv::Mat decode(const std::string& path, Notes& notes) {
  const std::string bytes = read_file(path, kMaxBytes);
  const std::string fault = detail::image_file_fault(bytes);
  if (!fault.empty()) throw InputError(path, "", fault);
  cv::Mat image = decode_image(bytes);
  if (image.empty()) throw InputError(path, "", "is damaged or truncated: its pixels cannot be decoded");
  if (has_second_image(bytes)) notes.emplace_back("the files hold further images of this size; only the first is read");
  return image;
}

void check_pixels(const cv::Mat& image, const std::string& path, const cv::Size& least) {
  if (image.depth() == CV_32F || image.depth() == CV_64F)
    throw InputError(path, "pixels",
                     fmt::format("found floating point{}, expected 8 or 16 bits",
                                 cv::checkRange(image) ? "" : " with values that are not finite"));
  if (image.depth() != CV_8U && image.depth() != CV_16U)
    throw InputError(path, "pixels", "found signed or 32-bit values, expected 8 or 16 bits");
  if (image.cols < least.width || image.rows < least.height)
    throw InputError(path, "size",
                     fmt::format("found {} x {} px, expected at least {} x {} px", image.cols, image.rows, least.width,
                                 least.height));
}

/// Grey with the bit depth of the file.
cv::Mat to_gray(const cv::Mat& image, const std::string& path) {
  if (image.channels() > 4)
    throw InputError(path, "pixels", fmt::format("found {} channels, expected 1 to 4", image.channels()));
  cv::Mat gray = gray_levels(image);
  double minimum = 0, maximum = 0;
  cv::minMaxLoc(gray, &minimum, &maximum);
  if (minimum == maximum)
    throw InputError(path, "pixels", fmt::format("all have grey level {}: nothing can be seen in this image", minimum));
  return gray;
}

cv::Mat read_gray(const std::string& path, Notes& notes,
                  const cv::Size& least = {kMinImageWidth_px, kMinImageHeight_px}) {
  cv::Mat image = decode(path, notes);
  check_pixels(image, path, least);
  if (auto note = put_bytes_in_order(image)) notes.push_back(*std::move(note));
  return to_gray(image, path);
}

/// Mosaics whose colours are weak can show neither.
std::optional<std::string> pattern_note(const cv::Mat& mosaic, BayerPattern pattern) {
  const auto seen = recognise_mosaic(image_of_levels(mosaic).view());
  if (!seen || *seen == greens_of(pattern)) return std::nullopt;
  return std::string("--bayer: the green pixels of the images are in other places; they look like ") +
         patterns_of(*seen);
}

/// Grey of a mosaic, which some programs save with three equal channels.
cv::Mat read_mosaic(const std::string& path, BayerPattern pattern, Notes& notes) {
  const cv::Mat image = decode(path, notes);
  check_pixels(image, path, {kMinImageWidth_px, kMinImageHeight_px});
  for (int channel = 1; channel < std::min(3, image.channels()); ++channel) {
    cv::Mat first, other;
    cv::extractChannel(image, first, 0);
    cv::extractChannel(image, other, channel);
    if (cv::norm(first, other, cv::NORM_INF) > 0.0)
      throw InputError(path, "pixels", "found colours, expected the grey levels of a mosaic (--bayer)");
  }
  const cv::Mat mosaic = to_gray(image, path);
  if (auto note = pattern_note(mosaic, pattern)) notes.push_back(*std::move(note));
  return demosaiced(mosaic, pattern);
}

cv::Mat read_gray(const std::string& path, const PairReading& reading, Notes& notes) {
  return reading.bayer ? read_mosaic(path, *reading.bayer, notes) : read_gray(path, notes);
}

}  // namespace

GrayImage load_gray_image(const std::string& path, int min_width_px, int min_height_px) {
  Notes notes;
  return image_of_levels(read_gray(path, notes, {min_width_px, min_height_px}));
}

namespace {

/// @param notes on the two files; those that are equal are kept once
GrayPair pair_of(const cv::Mat& left, const cv::Mat& right, const std::string& left_path, const std::string& right_path,
                 Notes notes) {
  if (left.size() != right.size())
    throw InputError(right_path, "size",
                     fmt::format("found {} x {} px, expected {} x {} px as in {}", right.cols, right.rows, left.cols,
                                 left.rows, left_path));
  if (left.depth() != right.depth())
    throw InputError(right_path, "pixels",
                     fmt::format("found {} bits, expected {} bits as in {}", 8 * right.elemSize1(),
                                 8 * left.elemSize1(), left_path));
  if (cv::norm(left, right, cv::NORM_INF) == 0.0)
    throw InputError(right_path, "pixels", fmt::format("not a pair: the image is identical to {}", left_path));
  notes.erase(std::unique(notes.begin(), notes.end()), notes.end());
  GrayPair pair = pair_of_levels(left, right);
  pair.notes.insert(pair.notes.begin(), notes.begin(), notes.end());
  return pair;
}

GrayPair halves_of(const cv::Mat& both, Split split, const std::string& path, Notes notes) {
  const bool is_side = split == Split::side_by_side;
  const int length = is_side ? both.cols : both.rows;
  if (length % 2 != 0)
    throw InputError(path, "size",
                     fmt::format("found {} x {} px, whose {} cannot be halved: does the file hold two images?",
                                 both.cols, both.rows, is_side ? "width" : "height"));
  const int width = is_side ? both.cols / 2 : both.cols, height = is_side ? both.rows : both.rows / 2;
  const cv::Mat left = both(cv::Rect(0, 0, width, height));
  const cv::Mat right = both(cv::Rect(both.cols - width, both.rows - height, width, height));
  for (const cv::Mat* half : {&left, &right}) check_pixels(*half, path, {kMinImageWidth_px, kMinImageHeight_px});
  return pair_of(left, right, path + " (first half)", path + " (second half)", std::move(notes));
}

GrayPair load_split_pair(const std::string& path, const PairReading& reading) {
  Notes notes;
  const cv::Mat both = read_gray(path, reading, notes);
  return halves_of(both, reading.split, path, std::move(notes));
}

}  // namespace

GrayPair pair_of_halves(const cv::Mat& levels, Split split, const std::string& name) {
  return halves_of(levels, split, name, {});
}

GrayPair load_pair(const PairPaths& paths, const PairReading& reading) {
  if (reading.split != Split::none) return load_split_pair(paths.left, reading);
  Notes notes;
  const cv::Mat left = read_gray(paths.left, reading, notes);  // the left one's faults are told first
  const cv::Mat right = read_gray(paths.right, reading, notes);
  return pair_of(left, right, paths.left, paths.right, std::move(notes));
}

GrayPair load_pair(const std::string& left_path, const std::string& right_path) {
  return load_pair(PairPaths{left_path, right_path}, {});
}

std::vector<std::string> notes_on_images(const RectifiedPair& images) {
  std::vector<std::string> notes;
  for (const auto& note : {mosaic_note(images), borders_note(images)})
    if (note) notes.push_back(*note);
  return notes;
}

std::optional<Split> split_of(const std::string& word) {
  if (word == "none") return Split::none;
  if (word == "side" || word == "side-by-side" || word == "lr") return Split::side_by_side;
  if (word == "top" || word == "top-bottom" || word == "tb") return Split::top_bottom;
  return std::nullopt;
}

}  // namespace flies
