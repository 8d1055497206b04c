#include "flies/train/labelled_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <string_view>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/eval/text.hpp"
#include "flies/io/exif.hpp"
#include "flies/io/folder.hpp"
#include "flies/io/image_folder.hpp"
#include "flies/io/images.hpp"
#include "flies/io/text_file.hpp"
#include "flies/train/picture_labels.hpp"

namespace flies {
namespace {

namespace fs = std::filesystem;

bool has_extension(const fs::path& path, std::string_view extension) {
  const std::string own = path.extension().string();
  return std::ranges::equal(own, extension,
                            [](unsigned char a, char b) { return static_cast<char>(std::tolower(a)) == b; });
}
bool is_xml(const fs::path& path) { return has_extension(path, ".xml"); }
bool is_text(const fs::path& path) { return has_extension(path, ".txt"); }

/// Where a picture, or the labels of one, belong: the folders below `root` but for those that keep pictures and labels
/// apart, and the name without extension.
fs::path place_of(const fs::path& file, const fs::path& root) {
  constexpr std::array<std::string_view, 6> kApart = {"Annotations", "JPEGImages", "labels",
                                                      "images",      "label_2",    "image_2"};
  fs::path place;
  for (const auto& part : file.lexically_relative(root).parent_path())
    if (std::ranges::find(kApart, part.string()) == kApart.end() && part != ".") place /= part;
  return place / file.stem();
}

/// The pictures of a folder, to be found from their labels.
class Pictures {
 public:
  explicit Pictures(const fs::path& root) : root_(root) {
    for (const auto& file : detail::files_below(root, detail::is_image_name)) {
      by_place_[place_of(file, root)].push_back(file);
      by_stem_[file.stem().string()].push_back(file);
    }
  }

  bool has(const fs::path& place) const { return by_place_.contains(place); }

  /// @param label_root the folder that places of labels count from
  /// @param name that the labels give; empty: that of the label file
  fs::path of(const fs::path& label_file, const fs::path& label_root, const std::string& name) const {
    const fs::path place = place_of(label_file, label_root);
    const std::string stem = name.empty() ? label_file.stem().string() : fs::path(name).stem().string();
    auto found = by_place_.find(place.parent_path() / stem);
    const std::vector<fs::path>* pictures = found == by_place_.end() ? nullptr : &found->second;
    if (pictures == nullptr) {
      const auto anywhere = by_stem_.find(stem);
      if (anywhere == by_stem_.end())
        throw InputError(label_file.string(), "",
                         fmt::format("found no picture '{}' in {}, expected one", stem, root_.string()));
      pictures = &anywhere->second;
    }
    if (pictures->size() == 1) return pictures->front();
    for (const auto& picture : *pictures)
      if (picture.filename() == fs::path(name).filename() && found != by_place_.end()) return picture;
    throw InputError(label_file.string(), "",
                     fmt::format("is for '{}', but {} and {} have that name: labels of pictures in several folders "
                                 "belong into folders of the same names",
                                 stem, (*pictures)[0].string(), (*pictures)[1].string()));
  }

 private:
  fs::path root_;
  std::map<fs::path, std::vector<fs::path>> by_place_;
  std::map<std::string, std::vector<fs::path>> by_stem_;
};

/// Labels by programs that show pictures as they are stored, for those that are turned by a quarter when they are read.
void turn_with_picture(PictureLabels& labels, const fs::path& picture) {
  constexpr std::size_t kMax_bytes = std::size_t{1} << 30;
  if (labels.width_px == 0 || labels.width_px == labels.height_px) return;
  const int orientation = detail::stored_orientation(read_file(picture.string(), kMax_bytes));
  if (orientation < 5) return;
  const GrayImage image = load_gray_image(picture.string());
  if (labels.width_px != image.height_px || labels.height_px != image.width_px) return;
  const double width_px = image.width_px, height_px = image.height_px;
  const auto turn = [&](ImageBox& box) {
    box = {box.v_px, box.u_px, box.height_px, box.width_px};  // transposed, then mirrored
    if (orientation == 6 || orientation == 7) box.u_px = width_px - box.u_px - box.width_px;
    if (orientation == 8 || orientation == 7) box.v_px = height_px - box.v_px - box.height_px;
  };
  std::ranges::for_each(labels.people, turn);
  std::ranges::for_each(labels.unclear, turn);
  std::swap(labels.width_px, labels.height_px);
}

TrainingPicture labelled(const fs::path& picture, PictureLabels labels) {
  TrainingPicture result;
  result.path = picture.string();
  result.people = std::move(labels.people);
  result.unclear = std::move(labels.unclear);
  result.labelled_width_px = labels.width_px;
  result.labelled_height_px = labels.height_px;
  return result;
}

template <class Parse>
std::vector<TrainingPicture> read_labels(const std::vector<fs::path>& label_files, const fs::path& label_root,
                                         const fs::path& picture_root, const Parse& parse) {
  const Pictures pictures(picture_root);
  std::vector<TrainingPicture> result;
  PeopleCheck check;
  for (const auto& file : label_files) {
    PictureLabels labels = parse(detail::read_truth(file), file.string());
    const fs::path picture = pictures.of(file, label_root, labels.picture);
    turn_with_picture(labels, picture);
    check.add(labels, file.string());
    result.push_back(labelled(picture, std::move(labels)));
  }
  check.finish();
  return result;
}

/// What class a person is by the names that belong to YOLO's labels; 0 where there are none.
int yolo_person(const fs::path& folder) {
  const auto is_yaml = [](const fs::path& path) { return has_extension(path, ".yaml") || has_extension(path, ".yml"); };
  for (const auto& file : detail::files_below(folder, is_yaml))
    if (const auto person = parse_yolo_yaml(detail::read_truth(file), file.string())) return *person;
  const auto is_list = [](const fs::path& path) {
    return path.filename() == "classes.txt" || path.filename() == "obj.names";
  };
  const auto lists = detail::files_below(folder, is_list);
  return lists.empty() ? 0 : parse_yolo_names(detail::read_truth(lists.front()), lists.front().string());
}

/// Text files of YOLO: in `labels` beside `images`, or next to their pictures. Pictures without one show nobody.
std::optional<std::vector<TrainingPicture>> read_yolo(const fs::path& folder) {
  const Pictures pictures(folder);
  std::map<fs::path, fs::path> label_files;
  for (const auto& file : detail::files_below(folder, is_text)) {
    const fs::path place = place_of(file, folder);
    const bool is_named_labels = std::ranges::find(file, fs::path("labels")) != file.end();
    if (pictures.has(place) || (is_named_labels && file.filename() != "classes.txt")) label_files[place] = file;
  }
  if (label_files.empty()) return std::nullopt;
  const int person = yolo_person(folder);
  for (const auto& [place, file] : label_files) pictures.of(file, folder, "");
  std::vector<TrainingPicture> result;
  PeopleCheck check;
  for (const auto& picture : detail::files_below(folder, detail::is_image_name)) {
    const auto file = label_files.find(place_of(picture, folder));
    PictureLabels labels;
    if (file != label_files.end()) {
      const GrayImage image = load_gray_image(picture.string());
      labels = parse_yolo_labels(detail::read_truth(file->second), file->second.string(), person, image.width_px,
                                 image.height_px);
      check.add(labels, file->second.string());
    }
    result.push_back(labelled(picture, std::move(labels)));
  }
  check.finish();
  return result;
}

}  // namespace

std::optional<std::vector<TrainingPicture>> labelled_pictures(const fs::path& folder) {
  if (detail::is_there_as_folder(folder / "label_2"))
    return read_labels(detail::files_below(folder / "label_2", is_text), folder / "label_2", folder / "image_2",
                       parse_kitti_boxes);
  const auto labels = detail::files_below(folder, is_xml);
  if (!labels.empty()) return read_labels(labels, folder, folder, parse_voc_labels);
  return read_yolo(folder);
}

}  // namespace flies
