#include "flies/train/training_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <string_view>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/core/letters.hpp"
#include "flies/io/folder.hpp"
#include "flies/io/image_file.hpp"
#include "flies/io/image_folder.hpp"
#include "flies/io/images.hpp"
#include "flies/train/labelled_pictures.hpp"

namespace flies {
namespace {

namespace fs = std::filesystem;

/// Crops may be as small as the window that is learnt, or smaller.
constexpr int kMinCropWidth_px = 8;
constexpr int kMinCropHeight_px = 16;

void check_folder(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(folder, error)) throw InputError(folder.string(), "", "no such folder");
  if (!fs::is_directory(folder, error)) throw InputError(folder.string(), "", "found a file, expected a folder");
}

std::vector<TrainingPicture> find_pictures(const std::string& folder, bool are_crops, const SayNote& note) {
  check_folder(folder);
  if (auto pictures = labelled_pictures(folder, note)) return std::move(*pictures);
  std::vector<TrainingPicture> pictures;
  for (const auto& file : detail::files_below(folder, detail::is_image_name)) {
    pictures.emplace_back().path = file.string();
    pictures.back().is_crop = are_crops;
  }
  if (pictures.empty())
    throw InputError(folder, "", fmt::format("found no pictures, expected {} in it or below", detail::kReadableImages));
  return pictures;
}

/// Half as wide as high; only the middle and the height matter.
ImageBox person_in(const GrayImage& crop, double share) {
  const double height_px = share * crop.height_px, width_px = height_px / 2.0;
  return {(crop.width_px - width_px) / 2.0, (crop.height_px - height_px) / 2.0, width_px, height_px};
}

/// Finds the person in each crop. Scenes without labels are taken for crops, but are not upright as people are.
void read_crops(std::span<TrainingPicture> crops, double person_share, const std::string& folder) {
  std::size_t wide = 0;
  std::string first_wide;
  for (auto& crop : crops) {
    const GrayImage image = load_picture(crop);
    crop.people = {person_in(image, person_share)};
    if (image.width_px > image.height_px && ++wide == 1)
      first_wide = fmt::format("{} with {} x {} px", crop.path, image.width_px, image.height_px);
  }
  if (2 * wide > crops.size())
    throw InputError(folder, "",
                     fmt::format("holds no labels that are read, and {} of {} pictures are wider than high, {} the "
                                 "first: expected labels, or upright crops of one person each",
                                 wide, crops.size(), first_wide));
}

}  // namespace

std::vector<TrainingPicture> find_pictures_of_people(std::span<const std::string> folders, double crop_person_share,
                                                     const SayNote& note) {
  std::vector<TrainingPicture> result;
  for (const auto& folder : folders) {
    auto pictures = find_pictures(folder, true, note);
    if (!pictures.empty() && pictures.front().is_crop) read_crops(pictures, crop_person_share, folder);
    std::erase_if(pictures, [](const TrainingPicture& picture) { return picture.people.empty(); });
    if (pictures.empty())
      throw InputError(folder, "", "the labels hold no wholly visible person, expected one at least");
    std::move(pictures.begin(), pictures.end(), std::back_inserter(result));
  }
  return result;
}

std::vector<TrainingPicture> find_background(std::span<const std::string> folders, const SayNote& note) {
  std::vector<TrainingPicture> result;
  for (const auto& folder : folders) {
    auto pictures = find_pictures(folder, false, note);
    std::move(pictures.begin(), pictures.end(), std::back_inserter(result));
  }
  return result;
}

std::vector<std::string> files_to_train_on(std::span<const std::string> folders) {
  const auto is_read = [](const fs::path& file) {
    constexpr std::array<std::string_view, 6> kLabels = {".txt", ".xml", ".json", ".yaml", ".yml", ".names"};
    const std::string extension = detail::in_small_letters(file.extension().string());
    return detail::is_image_name(file) || std::ranges::find(kLabels, extension) != kLabels.end();
  };
  std::vector<std::string> files;
  for (const auto& folder : folders)
    for (const auto& file : detail::files_below(folder, is_read)) files.push_back(file.string());
  return files;
}

GrayImage load_picture(const TrainingPicture& picture) {
  GrayImage image = load_gray_image(picture.path, picture.is_crop ? kMinCropWidth_px : kMinImageWidth_px,
                                    picture.is_crop ? kMinCropHeight_px : kMinImageHeight_px);
  if (picture.labelled_width_px != 0 &&
      (picture.labelled_width_px != image.width_px || picture.labelled_height_px != image.height_px))
    throw InputError(
        picture.path, "labels",
        fmt::format("are for a picture of {} x {} px, found {} x {} px: was it resized or turned after it "
                    "was labelled, or is it another one?",
                    picture.labelled_width_px, picture.labelled_height_px, image.width_px, image.height_px));
  return image;
}

void check_labels(const TrainingPicture& picture, int width_px, int height_px) {
  for (const auto& box : picture.people) {
    const double u_px = box.u_px + box.width_px / 2.0, v_px = box.v_px + box.height_px / 2.0;
    const bool is_inside = u_px >= 0.0 && u_px <= width_px && v_px >= 0.0 && v_px <= height_px;
    if (!is_inside || !(box.height_px <= 2.0 * height_px))
      throw InputError(
          picture.path, "labels",
          fmt::format("found a person at {} {} {} {}, expected one inside the picture of {} x {} px", box.u_px,
                      box.v_px, box.u_px + box.width_px, box.v_px + box.height_px, width_px, height_px));
  }
}

ImageBox window_around(const ImageBox& person, double person_share) {
  const double height_px = person.height_px / person_share;
  const double width_px = height_px / 2.0;
  return {person.u_px + (person.width_px - width_px) / 2.0, person.v_px + (person.height_px - height_px) / 2.0,
          width_px, height_px};
}

}  // namespace flies
