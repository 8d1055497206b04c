#include "flies/synth/paste.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "flies/core/error.hpp"
#include "flies/core/mat_view.hpp"
#include "flies/core/random.hpp"
#include "flies/core/usable_pair.hpp"
#include "flies/synth/paste_places.hpp"
#include "flies/synth/surroundings.hpp"

namespace flies {
namespace {

using synth::Place;

constexpr std::uint32_t kNoisePurpose = 131;
constexpr double kDepth_m = 0.05;  // a picture has none; footprints must have some
// How much darker or lighter, flatter or starker people are made.
constexpr double kLeastGain = 0.75, kMostGain = 3.0;
constexpr double kBlack = 8.0, kWhite = 247.0;

/// An image of the cut-out as it looks in its place, `shift_px` further left, in a picture of this size.
cv::Mat in_place(const GrayImage& image, const Place& place, double shift_px, const cv::Size& size) {
  const double scale = place.scale();
  const ImageBox box = place.box();
  cv::Mat smooth = mat_of(image.view());
  if (scale < 1.0) {
    // Into a matrix of its own: the view's pixels are the cut-out's.
    cv::Mat reduced;
    cv::GaussianBlur(smooth, reduced, {}, 0.4 * std::sqrt(1.0 / (scale * scale) - 1.0) + 1e-3);
    smooth = reduced;
  }
  const double u_px = box.u_px - shift_px - scale * place.cut->body.u_px;
  const double v_px = box.v_px - scale * place.cut->body.v_px;
  // Pixels have their centres at half numbers when they are enlarged.
  const cv::Matx23d move(scale, 0, u_px + 0.5 * (scale - 1), 0, scale, v_px + 0.5 * (scale - 1));
  cv::Mat placed;
  cv::warpAffine(smooth, placed, move, size, cv::INTER_LINEAR, cv::BORDER_CONSTANT, 0);
  return placed;
}

/// Mean and deviation of the picture around the person.
struct Light {
  double gain = 1.0, shift = 0.0;
};
Light light_at(const cv::Mat& picture, const Place& place) {
  const ImageBox box = place.box();
  const cv::Rect around(cvRound(box.u_px - box.width_px), cvRound(box.v_px), cvRound(3 * box.width_px),
                        cvRound(box.height_px));
  cv::Scalar mean, deviation;
  cv::meanStdDev(picture(around & cv::Rect({}, picture.size())), mean, deviation);
  const double gain = std::clamp(deviation[0] / place.cut->level_deviation, kLeastGain, kMostGain);
  // Nobody becomes black or white altogether.
  const double least = kBlack - gain * place.cut->dark, most = std::max(least, kWhite - gain * place.cut->bright);
  return {gain, std::clamp(mean[0] - gain * place.cut->level_mean, least, most)};
}

/// Share of every pixel that the person covers, 0 to 1: his mask without what is nearer.
cv::Mat cover_of(const cv::Mat& mask, const cv::Mat& around, double disparity_px) {
  cv::Mat free = around <= static_cast<double>(static_cast<float>(disparity_px) + synth::kSameSurface_px), cover;
  cv::blur(free, free, {3, 3});
  cv::multiply(mask, free, cover, 1.0 / (255.0 * 255.0), CV_32F);
  return cover;
}

/// One of the two images, with noise of its own.
struct Canvas {
  cv::Mat picture;  ///< CV_8U
  const cv::Mat& around;
  bool is_right = false;

  /// @returns what the person covers
  cv::Mat paint(const Place& place, const Light& light, double noise_gray, FlyRandom random) {
    const double shift_px = is_right ? place.disparity_px : 0.0;
    const cv::Mat levels = in_place(place.cut->image, place, shift_px, picture.size());
    cv::Mat cover = cover_of(in_place(place.cut->mask, place, shift_px, picture.size()), around, place.disparity_px);
    for (int v = 0; v < picture.rows; ++v) {
      for (int u = 0; u < picture.cols; ++u) {
        const double share = cover.at<float>(v, u);
        if (share <= 0.0) continue;
        auto& pixel = picture.at<std::uint8_t>(v, u);
        const double level = light.gain * levels.at<std::uint8_t>(v, u) + light.shift + noise_gray * random.normal();
        pixel = cv::saturate_cast<std::uint8_t>(share * level + (1.0 - share) * pixel);
      }
    }
    return cover;
  }
};

GrayImage image_of(const cv::Mat& picture) {
  return {picture.cols, picture.rows, {picture.datastart, picture.dataend}};
}

TruthObject truth_of(const Place& place, std::size_t index, const StereoCamera& camera) {
  const Point3 foot = Projection(camera).triangulate({place.u_px, place.foot_v_px, place.disparity_px});
  TruthObject person;
  person.kind = ObjectClass::pedestrian;
  person.scene_index = index;
  person.x_m = foot.x_m;
  person.y_m = foot.y_m;
  person.z_m = foot.z_m;
  person.length_m = kDepth_m;
  person.width_m = place.box().width_px * place.depth_m / camera.fx_px;
  person.height_m = place.height_m;
  person.near_range_m = std::hypot(foot.x_m, foot.y_m);
  person.whole_box = person.box = place.box();
  return person;
}

/// How much of everybody is seen in the end.
void measure_occlusion(std::span<const std::size_t> silhouettes_px, PastedPair& pasted) {
  for (const int person : pasted.pixels.object)
    if (person >= 0) ++pasted.people[static_cast<std::size_t>(person)].visible_px;
  for (auto& person : pasted.people) {
    const auto all = static_cast<double>(std::max<std::size_t>(1, silhouettes_px[person.scene_index]));
    person.occlusion = std::clamp(1.0 - static_cast<double>(person.visible_px) / all, 0.0, 1.0);
  }
}

}  // namespace

PastedPair paste_people(const RealPair& given, std::span<const CutOut> cut_outs, const PasteOptions& options,
                        std::uint32_t frame) {
  check_options(options, "pasting");
  if (options.people_max_range_m < options.people_min_range_m)
    throw InputError("pasting", "people_max_range_m",
                     fmt::format("found {}, expected at least people_min_range_m, {}", options.people_max_range_m,
                                 options.people_min_range_m));
  if (cut_outs.empty()) throw InputError("pasting", "cut-outs", "found none, expected at least one");
  RealPair pair = given;
  pair.images = detail::usable_pair(given.images);
  const int width_px = pair.images.left.width_px, height_px = pair.images.left.height_px;
  check_camera_fits(pair.camera, width_px, height_px, "camera");
  const synth::Surroundings around =
      synth::surroundings_of(pair.true_disparity_px, pair.matched_disparity_px, width_px, height_px);
  Canvas left{mat_of(pair.images.left).clone(), around.left, false};
  Canvas right{mat_of(pair.images.right).clone(), around.right, true};

  PastedPair pasted;
  pasted.pixels = {width_px, height_px, {pair.true_disparity_px.begin(), pair.true_disparity_px.end()}, {}};
  pasted.pixels.object.assign(pasted.pixels.disparity_px.size(), -1);
  const auto places = synth::draw_places(pair, around, cut_outs, options, frame);
  std::vector<std::size_t> silhouettes_px;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Place& place = places[i];
    const Light light = light_at(mat_of(pair.images.left), place);
    const auto stream = static_cast<std::uint32_t>(2 * i);
    const cv::Mat cover = left.paint(place, light, options.noise_gray, {options.seed, kNoisePurpose, frame, stream});
    right.paint(place, light, options.noise_gray, {options.seed, kNoisePurpose, frame, stream + 1});
    const cv::Mat mask = in_place(place.cut->mask, place, 0.0, cover.size());
    silhouettes_px.push_back(static_cast<std::size_t>(cv::countNonZero(mask >= 128)));
    for (int v = 0; v < height_px; ++v)
      for (int u = 0; u < width_px; ++u)
        if (cover.at<float>(v, u) >= 0.5F) {
          pasted.pixels.object[pasted.pixels.index(u, v)] = static_cast<int>(i);
          pasted.pixels.disparity_px[pasted.pixels.index(u, v)] = static_cast<float>(place.disparity_px);
        }
    pasted.people.push_back(truth_of(place, i, pair.camera));
  }
  measure_occlusion(silhouettes_px, pasted);
  std::ranges::stable_sort(pasted.people, {}, &TruthObject::near_range_m);
  pasted.left = image_of(left.picture);
  pasted.right = image_of(right.picture);
  return pasted;
}

}  // namespace flies
