#include "flies/train/training_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <map>
#include <optional>
#include <string_view>

#include "flies/core/error.hpp"
#include "flies/eval/text.hpp"
#include "flies/io/image_file.hpp"
#include "flies/io/image_folder.hpp"
#include "flies/io/images.hpp"
#include "flies/train/picture_labels.hpp"

namespace flies {
namespace {

namespace fs = std::filesystem;

/// Crops may be as small as the window that is learnt, or smaller.
constexpr int kMinCropWidth_px = 8;
constexpr int kMinCropHeight_px = 16;

bool has_extension(const fs::path& path, std::span<const std::string_view> extensions) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(extensions.begin(), extensions.end(), extension) != extensions.end();
}
bool is_xml(const fs::path& path) {
  constexpr std::array<std::string_view, 1> kXml = {".xml"};
  return has_extension(path, kXml);
}
bool is_text(const fs::path& path) {
  constexpr std::array<std::string_view, 1> kText = {".txt"};
  return has_extension(path, kText);
}

/// Files of a folder and all below it in name order; hidden ones are passed over.
template <class Accept>
std::vector<fs::path> files_below(const fs::path& folder, const Accept& accept) {
  std::error_code error;
  std::vector<fs::path> files;
  constexpr auto kFollow = fs::directory_options::follow_directory_symlink;
  for (fs::recursive_directory_iterator entry(folder, kFollow, error), end; !error && entry != end;
       entry.increment(error))
    if (entry->is_regular_file() && entry->path().filename().string().front() != '.' && accept(entry->path()))
      files.push_back(entry->path());
  if (error) throw InputError(folder.string(), "", "cannot be read: " + error.message());
  std::sort(files.begin(), files.end());
  return files;
}

void check_folder(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(folder, error)) throw InputError(folder.string(), "", "no such folder");
  if (!fs::is_directory(folder, error)) throw InputError(folder.string(), "", "found a file, expected a folder");
}

TrainingPicture labelled(const fs::path& picture, PictureLabels labels) {
  TrainingPicture result;
  result.path = picture.string();
  result.people = std::move(labels.people);
  result.unclear = std::move(labels.unclear);
  return result;
}

/// Pictures by their name without extension, to be found from the name of a label file.
std::map<std::string, fs::path> by_stem(const fs::path& folder) {
  std::map<std::string, fs::path> pictures;
  for (const auto& file : files_below(folder, detail::is_image_name)) pictures.emplace(file.stem().string(), file);
  return pictures;
}

template <class Parse>
std::vector<TrainingPicture> read_labels(const std::vector<fs::path>& label_files, const fs::path& picture_folder,
                                         const Parse& parse) {
  const auto pictures = by_stem(picture_folder);
  std::vector<TrainingPicture> result;
  for (const auto& file : label_files) {
    PictureLabels labels = parse(detail::read_truth(file), file.string());
    const std::string stem = labels.picture.empty() ? file.stem().string() : fs::path(labels.picture).stem().string();
    const auto picture = pictures.find(stem);
    if (picture == pictures.end())
      throw InputError(file.string(), "",
                       fmt::format("found no picture '{}' in {}, expected one", stem, picture_folder.string()));
    result.push_back(labelled(picture->second, std::move(labels)));
  }
  return result;
}

/// The labelled pictures of a folder, nothing when it holds pictures alone.
std::optional<std::vector<TrainingPicture>> labelled_pictures(const fs::path& folder) {
  if (fs::is_directory(folder / "label_2"))
    return read_labels(files_below(folder / "label_2", is_text), folder / "image_2", parse_kitti_boxes);
  if (fs::is_directory(folder / "Annotations"))
    return read_labels(files_below(folder / "Annotations", is_xml), folder / "JPEGImages", parse_voc_labels);
  const auto labels = files_below(folder, is_xml);
  if (labels.empty()) return std::nullopt;
  return read_labels(labels, folder, parse_voc_labels);
}

std::vector<TrainingPicture> find_pictures(const std::string& folder, bool are_crops) {
  check_folder(folder);
  if (auto pictures = labelled_pictures(folder)) return std::move(*pictures);
  std::vector<TrainingPicture> pictures;
  for (const auto& file : files_below(folder, detail::is_image_name)) {
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

}  // namespace

std::vector<TrainingPicture> find_pictures_of_people(std::span<const std::string> folders, double crop_person_share) {
  std::vector<TrainingPicture> result;
  for (const auto& folder : folders) {
    std::size_t people = 0;
    for (auto& picture : find_pictures(folder, true)) {
      if (picture.is_crop) picture.people = {person_in(load_picture(picture), crop_person_share)};
      if (picture.people.empty()) continue;
      ++people;
      result.push_back(std::move(picture));
    }
    if (people == 0) throw InputError(folder, "", "the labels hold no wholly visible person, expected one at least");
  }
  return result;
}

std::vector<TrainingPicture> find_background(std::span<const std::string> folders) {
  std::vector<TrainingPicture> result;
  for (const auto& folder : folders) {
    auto pictures = find_pictures(folder, false);
    std::move(pictures.begin(), pictures.end(), std::back_inserter(result));
  }
  return result;
}

GrayImage load_picture(const TrainingPicture& picture) {
  return load_gray_image(picture.path, picture.is_crop ? kMinCropWidth_px : kMinImageWidth_px,
                         picture.is_crop ? kMinCropHeight_px : kMinImageHeight_px);
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
