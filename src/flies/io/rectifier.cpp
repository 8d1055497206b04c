#include "flies/io/rectifier.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/core/mat_view.hpp"

namespace flies {
namespace {

struct Remap {
  cv::Mat columns, rows;
};

/// Rotations of both cameras into the rectified frame and their projections, as OpenCV calls them.
struct Rectification {
  cv::Mat r1, r2, p1, p2;
};

template <std::size_t Size>
cv::Mat matrix(const std::array<double, Size>& values, int rows) {
  return cv::Mat(rows, static_cast<int>(Size) / rows, CV_64F, const_cast<double*>(values.data())).clone();
}

std::array<double, 9> numbers(const cv::Mat& rotation) {
  std::array<double, 9> values{};
  for (int i = 0; i < 9; ++i) values[static_cast<std::size_t>(i)] = rotation.at<double>(i / 3, i % 3);
  return values;
}

GrayImage apply(const Remap& map, const GrayImage& image) {
  GrayImage result{image.width_px, image.height_px, std::vector<std::uint8_t>(image.pixels.size())};
  const cv::Mat from = mat_of(image.view());
  cv::Mat to(result.height_px, result.width_px, CV_8U, result.pixels.data());
  cv::remap(from, to, map.columns, map.rows, cv::INTER_LINEAR);
  return result;
}

bool is_of(const RawStereo& raw, Lens lens) { return raw.left.lens == lens && raw.right.lens == lens; }

/// By OpenCV's own functions, for its two models.
Rectification rectify_by_opencv(const RawStereo& raw) {
  const cv::Size size(raw.width_px, raw.height_px);
  const cv::Mat m1 = matrix(raw.left.matrix, 3), m2 = matrix(raw.right.matrix, 3);
  const cv::Mat d1(raw.left.distortion, true), d2(raw.right.distortion, true);
  const cv::Mat r = matrix(raw.rotation, 3), t = matrix(raw.translation_m, 3);
  Rectification result;
  cv::Mat q;
  constexpr double kOnlyValidPixels = 0.0;
  if (is_of(raw, Lens::equidistant))
    cv::fisheye::stereoRectify(m1, d1, m2, d2, size, r, t, result.r1, result.r2, result.p1, result.p2, q,
                               cv::CALIB_ZERO_DISPARITY, size, kOnlyValidPixels);
  else
    cv::stereoRectify(m1, d1, m2, d2, size, r, t, result.r1, result.r2, result.p1, result.p2, q,
                      cv::CALIB_ZERO_DISPARITY, kOnlyValidPixels, size);
  return result;
}

/// The raw pixel that a rectified one is taken from.
std::optional<std::array<double, 2>> raw_pixel(const RawCamera& camera, const cv::Mat& rotation, double focal_px,
                                               cv::Point2d offset_px) {
  const cv::Matx31d ray(offset_px.x / focal_px, offset_px.y / focal_px, 1.0);
  const cv::Matx31d in_camera = cv::Matx33d(rotation).t() * ray;
  const std::array<double, 3> point{in_camera(0), in_camera(1), in_camera(2)};
  constexpr std::size_t kOwnCoefficients = 5;
  if (camera.lens != Lens::brown || camera.distortion.size() <= kOwnCoefficients) return project(camera, point);
  if (!(point[2] > 0.0)) return std::nullopt;
  std::vector<cv::Point2d> pixel;
  cv::projectPoints(std::vector<cv::Point3d>{{point[0], point[1], point[2]}}, cv::Vec3d(), cv::Vec3d(),
                    matrix(camera.matrix, 3), camera.distortion, pixel);
  return std::array{pixel[0].x, pixel[0].y};
}

/// Whether the border of the rectified image is seen by both raw cameras.
/// @param centre_px of the left and of the right rectified camera
bool is_covered(const RawStereo& raw, const Rectification& to, double focal_px,
                const std::array<cv::Point2d, 2>& centre_px) {
  constexpr int kSteps = 32;
  // A quotient of polynomials may have poles, thin rings about the axis that show nothing.
  constexpr std::size_t kRational = 8;
  const bool is_rational = raw.left.lens == Lens::brown && raw.left.distortion.size() >= kRational;
  const double allowed_share = is_rational ? 0.02 : 0.0;
  const double w = raw.width_px - 1, h = raw.height_px - 1;
  int seen = 0, unseen = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const double s = static_cast<double>(i) / kSteps;
    for (const cv::Point2d at :
         {cv::Point2d(s * w, 0.0), cv::Point2d(s * w, h), cv::Point2d(0.0, s * h), cv::Point2d(w, s * h)})
      for (const auto& [camera, rotation, centre] :
           {std::tuple{&raw.left, &to.r1, centre_px[0]}, std::tuple{&raw.right, &to.r2, centre_px[1]}}) {
        const auto pixel = raw_pixel(*camera, *rotation, focal_px, at - centre);
        constexpr double kRounding_px = 0.5;
        const bool is_seen = pixel && (*pixel)[0] >= -kRounding_px && (*pixel)[0] <= w + kRounding_px &&
                             (*pixel)[1] >= -kRounding_px && (*pixel)[1] <= h + kRounding_px;
        ++(is_seen ? seen : unseen);
      }
  }
  return unseen <= allowed_share * (seen + unseen);
}

constexpr double kNarrowest = 8.0;  // focal length over width: 7 degrees across

/// For any model: the rotations do not depend on the lens, the focal length is the least that shows valid pixels only,
/// and no view is wider than a rectified image bears.
Rectification rectify_any_lens(const RawStereo& raw) {
  RawStereo pinhole = raw;
  for (RawCamera* camera : {&pinhole.left, &pinhole.right}) {
    camera->lens = Lens::brown;
    camera->distortion.assign(5, 0.0);
  }
  Rectification result = rectify_by_opencv(pinhole);
  const cv::Point2d middle_px(0.5 * (raw.width_px - 1), 0.5 * (raw.height_px - 1));
  const auto shows_valid = [&](double focal_px) { return is_covered(raw, result, focal_px, {middle_px, middle_px}); };
  double low = kWidestRectified * raw.width_px, high = kNarrowest * raw.width_px;
  if (!shows_valid(high)) CV_Error(cv::Error::StsBadArg, "both cameras never see the same");
  while (high - low > 1e-3 * low) {
    const double middle = 0.5 * (low + high);
    (shows_valid(middle) ? high : low) = middle;
  }
  const double vertical = std::abs(result.p2.at<double>(1, 3)),
               across_m = result.p2.at<double>(0, 3) / result.p2.at<double>(0, 0);
  result.p1 = (cv::Mat_<double>(3, 4) << high, 0, middle_px.x, 0, 0, high, middle_px.y, 0, 0, 0, 1, 0);
  result.p2 = result.p1.clone();
  result.p2.at<double>(0, 3) = high * across_m;
  result.p2.at<double>(1, 3) = vertical;
  return result;
}

/// Whether OpenCV found the least focal length that shows valid pixels only. It goes back from pixels to rays, where
/// its steps may lead astray: with rational models, whose quotient has poles, and with lenses that see to the side.
bool is_tight(const RawStereo& raw, const Rectification& by_opencv) {
  const double focal_px = by_opencv.p1.at<double>(0, 0);
  if (!(focal_px >= kWidestRectified * raw.width_px && focal_px <= kNarrowest * raw.width_px)) return false;
  const auto centre = [](const cv::Mat& p) { return cv::Point2d(p.at<double>(0, 2), p.at<double>(1, 2)); };
  const std::array centres{centre(by_opencv.p1), centre(by_opencv.p2)};
  constexpr double kLarger = 1.05;  // OpenCV looks at a few points of the border alone
  return is_covered(raw, by_opencv, focal_px * kLarger, centres) &&
         !is_covered(raw, by_opencv, focal_px / kLarger, centres);
}

Rectification rectification_of(const RawStereo& raw) {
  if (!is_of(raw, Lens::brown) && !is_of(raw, Lens::equidistant)) return rectify_any_lens(raw);
  Rectification by_opencv = rectify_by_opencv(raw);
  return by_opencv.p2.at<double>(1, 3) != 0.0 || is_tight(raw, by_opencv) ? by_opencv : rectify_any_lens(raw);
}

Remap map_of(const RawCamera& camera, const cv::Mat& rotation, const cv::Mat& projection, const cv::Size& size) {
  const cv::Mat m = matrix(camera.matrix, 3), d(camera.distortion, true);
  Remap map;
  if (camera.lens == Lens::equidistant) {
    cv::fisheye::initUndistortRectifyMap(m, d, rotation, projection, size, CV_16SC2, map.columns, map.rows);
  } else if (camera.lens == Lens::brown) {
    cv::initUndistortRectifyMap(m, d, rotation, projection, size, CV_16SC2, map.columns, map.rows);
  } else {
    cv::Mat columns(size, CV_32F, cv::Scalar(-1)), rows(size, CV_32F, cv::Scalar(-1));
    const double focal_px = projection.at<double>(0, 0);
    const cv::Point2d centre(projection.at<double>(0, 2), projection.at<double>(1, 2));
    for (int v = 0; v < size.height; ++v)
      for (int u = 0; u < size.width; ++u)
        if (const auto pixel = raw_pixel(camera, rotation, focal_px, cv::Point2d(u, v) - centre)) {
          columns.at<float>(v, u) = static_cast<float>((*pixel)[0]);
          rows.at<float>(v, u) = static_cast<float>((*pixel)[1]);
        }
    cv::convertMaps(columns, rows, map.columns, map.rows, CV_16SC2);
  }
  return map;
}

void check_coefficients(const RawCamera& camera, const std::string& source) {
  if (const std::size_t least = least_coefficients(camera.lens); camera.distortion.size() < least)
    throw InputError(source, "distortion",
                     fmt::format("found {} coefficients, expected at least {} of the {} lens", camera.distortion.size(),
                                 least, lens_name(camera.lens)));
}

/// The tables have six bytes a pixel and camera, whatever image there will be.
void check_map_size(const RawStereo& raw, const std::string& source) {
  constexpr double kMostPixels = 1 << 26;
  if (static_cast<double>(raw.width_px) * raw.height_px > kMostPixels)
    throw InputError(source, "image size",
                     fmt::format("found {} x {} px, expected at most {:.0f} million pixels of raw cameras",
                                 raw.width_px, raw.height_px, kMostPixels / 1e6));
}

}  // namespace

struct Rectifier::Maps {
  Remap left, right;
};

Rectifier::Rectifier(const RawStereo& raw, const std::string& source) : raw_(raw), source_(source) {
  check_map_size(raw, source);
  check_coefficients(raw.left, source);
  check_coefficients(raw.right, source);
  const cv::Size size(raw.width_px, raw.height_px);
  auto maps = std::make_shared<Maps>();
  Rectification to;
  try {
    to = rectification_of(raw);
    maps->left = map_of(raw.left, to.r1, to.p1, size);
    maps->right = map_of(raw.right, to.r2, to.p2, size);
  } catch (const cv::Exception& error) {
    throw InputError(source, "camera matrices, distortion, R, T",
                     fmt::format("no rectification exists ({})", error.err));
  }
  if (to.p2.at<double>(1, 3) != 0.0) {
    const auto& t = raw.translation_m;
    throw InputError(source, "T",
                     fmt::format("the cameras stand one {} the other, expected side by side",
                                 std::abs(t[2]) > std::abs(t[1]) ? "before" : "above"));
  }
  camera_.fx_px = to.p1.at<double>(0, 0);
  camera_.fy_px = to.p1.at<double>(1, 1);
  camera_.cx_px = to.p1.at<double>(0, 2);
  camera_.cx_right_px = to.p2.at<double>(0, 2);
  camera_.cy_px = to.p1.at<double>(1, 2);
  camera_.baseline_m = -to.p2.at<double>(0, 3) / to.p2.at<double>(0, 0);
  camera_.width_px = raw.width_px;
  camera_.height_px = raw.height_px;
  left_rotation_ = numbers(to.r1);
  right_rotation_ = numbers(to.r2);
  maps_ = std::move(maps);
}

GrayPair Rectifier::rectify(const GrayPair& raw_pair) const {
  if (!maps_) throw std::logic_error("this rectifier was moved from and cannot be used");
  check_camera_fits(camera_, raw_pair.left.width_px, raw_pair.left.height_px, source_);
  check_camera_fits(camera_, raw_pair.right.width_px, raw_pair.right.height_px, source_);
  return {apply(maps_->left, raw_pair.left), apply(maps_->right, raw_pair.right), raw_pair.bit_depth};
}

}  // namespace flies
