#include "flies/train/labelled_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <iterator>
#include <map>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/core/letters.hpp"
#include "flies/eval/text.hpp"
#include "flies/io/exif.hpp"
#include "flies/io/folder.hpp"
#include "flies/io/image_folder.hpp"
#include "flies/io/images.hpp"
#include "flies/io/text_file.hpp"
#include "flies/train/coco_labels.hpp"
#include "flies/train/picture_labels.hpp"
#include "flies/train/yolo_labels.hpp"

namespace flies {
namespace {

namespace fs = std::filesystem;

/// Whether a file or folder has one of these names, in capitals or not.
bool is_named(const fs::path& path, std::initializer_list<std::string_view> names) {
  const std::string own = detail::in_small_letters(path.filename().string());
  return std::ranges::find(names, own) != names.end();
}

bool has_extension(const fs::path& path, std::initializer_list<std::string_view> extensions) {
  const std::string own = detail::in_small_letters(path.extension().string());
  return std::ranges::find(extensions, own) != extensions.end();
}
bool is_xml(const fs::path& path) { return has_extension(path, {".xml"}); }
bool is_text(const fs::path& path) { return has_extension(path, {".txt"}); }
bool is_json(const fs::path& path) { return has_extension(path, {".json"}); }

bool is_for_labels(const fs::path& folder) {
  return is_named(folder, {"labels", "annotations", "annotation", "label_2"});
}
bool is_for_pictures(const fs::path& folder) {
  return is_named(folder, {"images", "jpegimages", "pngimages", "image_2"});
}

/// Where a picture, or the labels of one, belong: the folders below `root` but for those that keep pictures and labels
/// apart, and the name without extension.
fs::path place_of(const fs::path& file, const fs::path& root) {
  fs::path place;
  for (const auto& part : file.lexically_relative(root).parent_path())
    if (!is_for_labels(part) && !is_for_pictures(part) && part != ".") place /= part;
  return place / file.stem();
}

/// The pictures of a folder, to be found from their labels.
class Pictures {
 public:
  explicit Pictures(const fs::path& root) : root_(root), files_(detail::files_below(root, detail::is_image_name)) {
    for (const auto& file : files_) {
      by_place_[place_of(file, root)].push_back(file);
      by_stem_[file.stem().string()].push_back(file);
    }
  }

  const std::vector<fs::path>& files() const { return files_; }
  bool has(const fs::path& place) const { return by_place_.contains(place); }

  /// @param label_root the folder that places of labels count from
  /// @param name that the labels give; empty: that of the label file
  fs::path of(const fs::path& label_file, const fs::path& label_root, const std::string& told) const {
    const std::string name = as_found_here(told);
    const fs::path own = place_of(label_file, label_root);
    const std::string stem = name.empty() ? own.filename().string() : fs::path(name).stem().string();
    const auto found = by_place_.find(own.parent_path() / stem);
    if (const auto beside = by_place_.find(own); beside != by_place_.end() && stem != own.filename()) {
      if (by_stem_.contains(stem))
        throw InputError(label_file.string(), "filename",
                         fmt::format("found '{}', but {} has the name of the label file, and both are there: which of "
                                     "them is labelled?",
                                     name, beside->second.front().string()));
      return beside->second.front();  // renamed together with its labels
    }
    if (found != by_place_.end()) return one_of(found->second, label_file, name, stem);
    const auto named = by_place_.find(place_of(root_ / fs::path(name).relative_path(), root_));
    if (!name.empty() && named != by_place_.end()) return one_of(named->second, label_file, name, stem);
    const auto anywhere = by_stem_.find(stem);
    if (anywhere == by_stem_.end())
      throw InputError(
          label_file.string(), "",
          fmt::format("found no picture '{}' in {}, expected one", name.empty() ? stem : told, root_.string()));
    return one_of(anywhere->second, label_file, "", stem);
  }

 private:
  /// Windows writes `images\a.jpg`, which may be a name, too.
  std::string as_found_here(std::string name) const {
    if (!by_stem_.contains(fs::path(name).stem().string())) std::ranges::replace(name, '\\', '/');
    return name;
  }

  /// @param name with the extension that tells pictures in one folder apart; empty where they are in several
  static fs::path one_of(const std::vector<fs::path>& pictures, const fs::path& label_file, const std::string& name,
                         const std::string& stem) {
    if (pictures.size() == 1) return pictures.front();
    if (!name.empty())
      for (const auto& picture : pictures)
        if (picture.filename() == fs::path(name).filename()) return picture;
    throw InputError(label_file.string(), "",
                     fmt::format("is for '{}', but {} and {} have that name: labels of pictures in several folders "
                                 "belong into folders of the same names",
                                 stem, pictures[0].string(), pictures[1].string()));
  }

  fs::path root_;
  std::vector<fs::path> files_;
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

/// Boxes that a set has several times, as where labels of several programs or people are put together.
class RepeatedBoxes {
 public:
  /// Leaves one of each.
  void remove_from(PictureLabels& labels, const fs::path& picture) {
    const std::size_t removed = remove_from(labels.people) + remove_from(labels.unclear);
    if (removed > 0 && removed_ == 0) first_ = picture;
    removed_ += removed;
  }

  void tell(const fs::path& root, const SayNote& note) const {
    if (removed_ == 0 || !note) return;
    note(fmt::format("{}: labels that repeat another one of the same picture exactly are left out: {}, the first in {}",
                     root.string(), removed_, first_.string()));
  }

 private:
  static std::size_t remove_from(std::vector<ImageBox>& boxes) {
    const auto place = [](const ImageBox& box) { return std::tuple(box.u_px, box.v_px, box.width_px, box.height_px); };
    const std::size_t before = boxes.size();
    std::set<std::tuple<double, double, double, double>> seen;
    std::erase_if(boxes, [&](const ImageBox& box) { return !seen.insert(place(box)).second; });
    return before - boxes.size();
  }

  std::size_t removed_ = 0;
  fs::path first_;  ///< picture
};

TrainingPicture labelled(const fs::path& picture, PictureLabels labels) {
  TrainingPicture result;
  result.path = picture.string();
  result.people = std::move(labels.people);
  result.unclear = std::move(labels.unclear);
  result.labelled_width_px = labels.width_px;
  result.labelled_height_px = labels.height_px;
  return result;
}

/// Labels and the file that they are from.
struct FileLabels {
  fs::path file;
  PictureLabels labels;
};

template <class Parse>
std::vector<FileLabels> parse_all(const std::vector<fs::path>& files, const Parse& parse) {
  std::vector<FileLabels> all;
  for (const auto& file : files) all.push_back({file, parse(detail::read_truth(file), file.string())});
  return all;
}

void tell_of_unlabelled(const Pictures& pictures, const std::map<fs::path, fs::path>& labelled, const fs::path& root,
                        const SayNote& note) {
  std::vector<fs::path> others;
  for (const auto& picture : pictures.files())
    if (!labelled.contains(picture)) others.push_back(picture);
  if (others.empty() || !note) return;
  note(fmt::format("{}: {} of {} pictures have no labels and are not used, {} the first", root.string(), others.size(),
                   pictures.files().size(), others.front().string()));
}

std::vector<TrainingPicture> join(std::vector<FileLabels> all, const fs::path& label_root, const fs::path& picture_root,
                                  const SayNote& note) {
  const Pictures pictures(picture_root);
  std::vector<TrainingPicture> result;
  std::map<fs::path, fs::path> labels_of;
  PeopleCheck check;
  RepeatedBoxes repeated;
  for (auto& [file, labels] : all) {
    const fs::path picture = pictures.of(file, label_root, labels.picture);
    if (const auto [other, is_first] = labels_of.emplace(picture, file); !is_first)
      throw InputError(file.string(), "",
                       other->second == file
                           ? fmt::format("has labels of {} twice", picture.string())
                           : fmt::format("is for {}, but so is {}: expected the labels of a picture in one file",
                                         picture.string(), other->second.string()));
    turn_with_picture(labels, picture);
    repeated.remove_from(labels, picture);
    check.add(labels, file.string());
    result.push_back(labelled(picture, std::move(labels)));
  }
  check.finish();
  repeated.tell(picture_root, note);
  tell_of_unlabelled(pictures, labels_of, picture_root, note);
  return result;
}

/// `label_2` beside `image_2`, in a folder or in `training` there.
std::optional<fs::path> kitti_folder(const fs::path& folder) {
  for (const fs::path& root : {folder, folder / "training"})
    if (detail::is_there_as_folder(root / "label_2")) return root;
  return std::nullopt;
}

/// By one file; nothing when it holds no names.
std::optional<YoloClasses> yolo_classes_of(const fs::path& file) {
  const std::string text = detail::read_truth(file);
  return has_extension(file, {".yaml", ".yml"}) ? parse_yolo_yaml(text, file.string())
                                                : parse_yolo_names(text, file.string());
}

/// The files that may hold the names of YOLO's classes, those that count most first.
std::vector<fs::path> files_of_yolo_names(const fs::path& folder) {
  const auto is_yaml = [](const fs::path& path) { return has_extension(path, {".yaml", ".yml"}); };
  const auto is_list = [](const fs::path& path) { return is_named(path, {"classes.txt", "obj.names"}); };
  auto files = detail::files_below(folder, is_yaml);
  std::ranges::move(detail::files_below(folder, is_list), std::back_inserter(files));
  return files;
}

/// The classes by the names that belong to YOLO's labels.
/// @param note is told of another list by which other classes are people
YoloClasses yolo_classes(const fs::path& folder, const SayNote& note) {
  std::optional<YoloClasses> used;
  for (const auto& file : files_of_yolo_names(folder)) {
    if (!used) {
      used = yolo_classes_of(file);
      continue;
    }
    std::optional<YoloClasses> other;
    try {
      other = yolo_classes_of(file);
    } catch (const InputError&) {  // it is not asked
      continue;
    }
    if (other && note && (other->people != used->people || other->unclear != used->unclear))
      note(
          fmt::format("{}: by this list other classes are people than by {}, which is used: take away the one that "
                      "does not belong to the labels",
                      file.string(), used->source));
  }
  return used.value_or(YoloClasses{});
}

/// Of labels whose class the list of names does not have.
void tell_of_unnamed_classes(const YoloClasses& classes, const YoloLines& lines, const SayNote& note) {
  int all = 0, unnamed = 0, first = -1;
  for (const auto& [of_class, labels] : lines.labels_of_class()) {
    all += labels;
    if (classes.named.contains(of_class)) continue;
    if (unnamed == 0) first = of_class;
    unnamed += labels;
  }
  if (classes.source.empty() || unnamed == 0 || !note) return;
  note(
      fmt::format("{}: {} of {} labels are of classes without a name, {} the first, and count as background; does the "
                  "list belong to these labels?",
                  classes.source, unnamed, all, first));
}

/// Text files that lie in a folder for labels, or belong to a picture by their place.
std::vector<fs::path> label_texts(const fs::path& folder, const Pictures& pictures) {
  return detail::files_below(folder, [&](const fs::path& file) {
    if (!is_text(file) || is_named(file, {"classes.txt", "readme.txt", "license.txt", "licence.txt"})) return false;
    const fs::path parents = file.lexically_relative(folder).parent_path();
    return pictures.has(place_of(file, folder)) || std::any_of(parents.begin(), parents.end(), is_for_labels);
  });
}

/// Text files of YOLO: in `labels` beside `images`, or next to their pictures. Pictures without one show nobody.
std::vector<TrainingPicture> read_yolo(const fs::path& folder, const std::vector<fs::path>& texts,
                                       const Pictures& pictures, const SayNote& note) {
  const YoloClasses classes = yolo_classes(folder, note);
  std::map<fs::path, fs::path> label_files;
  YoloLines lines;
  for (const auto& file : texts) {
    const fs::path picture = pictures.of(file, folder, "");
    if (const auto [other, is_first] = label_files.emplace(picture, file); !is_first)
      throw InputError(file.string(), "",
                       fmt::format("is for {}, but so is {}: expected the labels of a picture in one file",
                                   picture.string(), other->second.string()));
    lines.add(detail::read_truth(file));
  }
  tell_of_unnamed_classes(classes, lines, note);
  std::vector<TrainingPicture> result;
  PeopleCheck check;
  RepeatedBoxes repeated;
  for (const auto& picture : pictures.files()) {
    const auto file = label_files.find(picture);
    PictureLabels labels;
    if (file != label_files.end()) {
      const GrayImage image = load_gray_image(picture.string());
      labels = parse_yolo_labels(detail::read_truth(file->second), file->second.string(), classes, lines,
                                 image.width_px, image.height_px);
      repeated.remove_from(labels, picture);
      check.add(labels, file->second.string());
    }
    result.push_back(labelled(picture, std::move(labels)));
  }
  check.finish();
  repeated.tell(folder, note);
  return result;
}

std::vector<FileLabels> parse_coco_files(const std::vector<fs::path>& files) {
  std::vector<FileLabels> all;
  for (const auto& file : files)
    for (auto& labels : parse_coco_labels(detail::read_truth(file), file.string()))
      all.push_back({file, std::move(labels)});
  return all;
}

constexpr const char* kRead = "Pascal VOC, KITTI, YOLO, COCO and the text of the INRIA people are read";

/// That nothing was read is no proof that nobody is labelled.
void check_for_other_labels(const fs::path& folder) {
  const auto is_other = [](const fs::path& file) {
    return has_extension(file, {".csv", ".tsv", ".odgt", ".jsonl", ".ndjson", ".vbb", ".mat"});
  };
  if (const auto others = detail::files_below(folder, is_other); !others.empty())
    throw InputError(
        others.front().string(), "",
        fmt::format("may hold labels of a kind that is not read ({}); where it does not, move it away", kRead));
  std::vector<fs::path> folders = {folder};
  for (std::size_t i = 0; i < folders.size(); ++i) {
    if (i > 0 && is_for_labels(folders[i]))
      throw InputError(
          folders[i].string(), "",
          fmt::format("holds no labels that are read ({}); where the pictures have none, move it away", kRead));
    for (const auto& below : detail::folders_of(folders[i]))
      if (!fs::is_symlink(below)) folders.push_back(below);
  }
}

}  // namespace

std::optional<std::vector<TrainingPicture>> labelled_pictures(const fs::path& folder, const SayNote& note) {
  if (const auto kitti = kitti_folder(folder)) {
    const fs::path label_root = *kitti / "label_2";
    const auto files = detail::files_below(label_root, is_text);
    if (files.empty()) throw InputError(label_root.string(), "", "holds no text files, expected one a picture");
    const bool is_drawn =
        !detail::is_there_as_folder(*kitti / "image_2") && detail::is_there_as_folder(*kitti / "left");
    return join(parse_all(files, parse_kitti_boxes), label_root, *kitti / (is_drawn ? "left" : "image_2"), note);
  }
  if (const auto files = detail::files_below(folder, is_xml); !files.empty())
    return join(parse_all(files, parse_voc_labels), folder, folder, note);
  const Pictures pictures(folder);
  if (const auto files = label_texts(folder, pictures); !files.empty()) {
    if (is_pascal_text(detail::read_truth(files.front())))
      return join(parse_all(files, parse_pascal_text), folder, folder, note);
    return read_yolo(folder, files, pictures, note);
  }
  if (const auto files = detail::files_below(folder, is_json); !files.empty())
    return join(parse_coco_files(files), folder, folder, note);
  check_for_other_labels(folder);
  return std::nullopt;
}

}  // namespace flies
