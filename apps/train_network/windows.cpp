#include "windows.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

#include "flies/classify/resample.hpp"
#include "flies/core/box_overlap.hpp"
#include "flies/core/error.hpp"
#include "flies/eval/dataset.hpp"
#include "flies/eval/people.hpp"
#include "flies/eval/text.hpp"
#include "flies/io/folder.hpp"
#include "flies/io/images.hpp"
#include "flies/train/picture_labels.hpp"
#include "flies/train/samples.hpp"
#include "flies/train/training_picture.hpp"

namespace flies {
namespace {

namespace fs = std::filesystem;

double uniform(Random& random, double from, double to) { return std::uniform_real_distribution(from, to)(random); }
std::size_t below(Random& random, std::size_t count) {
  return std::uniform_int_distribution<std::size_t>(0, count - 1)(random);
}

constexpr double kMinPerson_px = 40.0;
constexpr double kMaxAspect = 0.62, kMinAspect = 0.18;  // of boxes of upright people, arms and bags included
constexpr double kBorder_px = 3.0;                      // a box that ends there may be cut off

bool is_whole(const ImageBox& box, const GrayImage& image) {
  return box.v_px > kBorder_px && box.u_px > kBorder_px && box.v_px + box.height_px < image.height_px - kBorder_px &&
         box.u_px + box.width_px < image.width_px - kBorder_px;
}

/// KITTI text with unknown occlusion as -1.
void read_labels(const fs::path& file, Picture& picture) {
  for (const auto& label : parse_kitti_people(detail::read_truth(file.string()), file.string())) {
    const ImageBox& box = label.box;
    const bool is_clear = label.is_person && box.height_px >= kMinPerson_px && label.truncation <= 0.1 &&
                          label.occlusion <= 1.0 && is_whole(box, picture.image) &&
                          box.width_px < kMaxAspect * box.height_px && box.width_px > kMinAspect * box.height_px;
    (is_clear ? picture.people : picture.unclear).push_back(box);
  }
}

std::vector<Picture> street_pictures(const fs::path& folder, bool has_background) {
  std::vector<Picture> pictures;
  for (const auto& file : detail::files_of(folder / "images")) {
    Picture picture;
    picture.name = file.stem().string();
    picture.image = load_gray_image(file.string());
    picture.has_background = has_background;
    read_labels(folder / "label_2" / (picture.name + ".txt"), picture);
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

/// Pictures that follow each other show one scene: runs of 50 numbers of the squares of Darmstadt, of 10 of the rest.
bool is_kept_apart(const std::string& name) {
  const bool is_sequence = name.starts_with("tud");
  std::uint64_t number = 0;
  const std::string digits = name.substr(name.find('_') + 1);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (error != std::errc{} || end != digits.data() + digits.size())
    throw InputError(name, "", "expected a picture's name like tud_000123: source, underscore, number");
  return number / (is_sequence ? 50 : 10) % 2 == 1;
}

bool is_clear(const ImageBox& window, const Picture& picture) {
  constexpr double kMaxOverlap = 0.3, kMaxUnclear = 0.25;
  return std::none_of(picture.people.begin(), picture.people.end(),
                      [&](const ImageBox& person) {
                        return intersection_over_union(window, window_around(person, kPersonShare)) > kMaxOverlap;
                      }) &&
         std::none_of(picture.unclear.begin(), picture.unclear.end(), [&](const ImageBox& box) {
           return intersection_px2(window, box) > kMaxUnclear * std::min(area_px2(window), area_px2(box));
         });
}

std::vector<Picture> loaded(const std::vector<TrainingPicture>& files) {
  std::vector<Picture> pictures;
  for (const auto& file : files) {
    Picture picture;
    picture.name = file.path;
    picture.image = load_picture(file);
    picture.people = file.people;
    picture.unclear = file.unclear;
    picture.has_background = !file.is_crop;
    picture.has_proposals = file.has_proposals;
    picture.proposals = file.proposals;
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

/// Those who are wholly visible, by the truth of the pairs. Nobody is background there anyway.
void add_people_of_pairs(std::span<const std::string> folders, std::vector<Picture>& pictures) {
  std::size_t picture = 0;
  for (const auto& folder : folders) {
    const Dataset dataset = open_dataset(folder);
    for (std::size_t i = 0; i < dataset.pairs.size(); ++i, ++picture) {
      const FrameTruth truth = dataset.load(i).truth;
      for (const auto& object : truth.objects)
        if (object.type == "Pedestrian" && object.visible && object.occlusion == 0 &&
            object.box.height_px >= kMinPerson_px && is_whole(object.box, pictures[picture].image))
          pictures[picture].people.push_back(object.box);
    }
  }
}

/// @throws InputError naming the folder when there is no person or no place without people to learn from, or to
/// judge by
void check_both_kinds(const std::string& folder, std::span<const Picture> pictures, const std::string& purpose) {
  const auto has_people = [](const Picture& picture) { return !picture.people.empty(); };
  const auto has_background = [](const Picture& picture) { return picture.has_background && !picture.has_proposals; };
  if (std::none_of(pictures.begin(), pictures.end(), has_people))
    throw InputError(folder, "", "found no person of 40 px or more in full view " + purpose);
  if (std::none_of(pictures.begin(), pictures.end(), has_background))
    throw InputError(folder, "", "found no picture without people or with all people labelled " + purpose);
}

void append(std::vector<Picture>& to, std::vector<Picture> pictures) {
  std::move(pictures.begin(), pictures.end(), std::back_inserter(to));
}

}  // namespace

NetworkData load_network_data(const DataFolders& folders) {
  NetworkData data;
  const fs::path people(folders.people);
  const auto divide = [&](std::vector<Picture> pictures) {
    for (auto& picture : pictures) {
      const bool apart = folders.keep_apart && is_kept_apart(picture.name);
      (apart ? data.kept_apart : data.learnt).push_back(std::move(picture));
    }
  };
  divide(street_pictures(people / "pictures", true));
  divide(street_pictures(people / "pictures/partly", false));
  std::vector<std::string> crops = {(people / "train/positives/inria").string(),
                                    (people / "train/positives/mit").string()};
  // The Darmstadt crops may show people of the street pictures that are kept apart.
  if (!folders.keep_apart) crops.push_back((people / "train/positives/tud").string());
  append(data.learnt, loaded(find_pictures_of_people(crops, kPersonShare)));
  const std::vector<std::string> empty = {(people / "train/negatives").string()};
  auto background = loaded(find_background(empty));
  if (folders.keep_apart) {
    const HoldOut parts = split_in_runs(background.size(), 0.2);
    for (const auto i : parts.learnt) data.learnt.push_back(std::move(background[i]));
    for (const auto i : parts.kept_apart) data.kept_apart.push_back(std::move(background[i]));
  } else {
    append(data.learnt, std::move(background));
  }
  DetectorOptions options;
  options.propose.min_person_px = 40.0;
  auto pairs = loaded(find_proposals(folders.stereo, options));
  add_people_of_pairs(folders.stereo, pairs);
  append(data.learnt, std::move(pairs));
  check_both_kinds(folders.people, data.learnt, "to learn from");
  if (folders.keep_apart)
    check_both_kinds(folders.people, data.kept_apart, "among those kept apart, every second run of numbers");
  return data;
}

std::vector<Place> places_of_people(std::span<const Picture> pictures) {
  std::vector<Place> places;
  for (std::uint32_t i = 0; i < pictures.size(); ++i)
    for (const auto& person : pictures[i].people) places.push_back({i, window_around(person, kPersonShare)});
  return places;
}

BackgroundPlaces::BackgroundPlaces(std::span<const Picture> pictures) : pictures_(pictures) {
  for (std::uint32_t i = 0; i < pictures.size(); ++i) {
    if (!pictures[i].has_background) continue;
    (pictures[i].has_proposals ? proposed_ : random_).push_back(i);
  }
}

Place BackgroundPlaces::draw(Random& random) const {
  constexpr double kMinHeight_px = 55.0, kProposedShare = 0.2, kBesidePeople = 0.3;
  constexpr int kMostTries = 1'000'000;  // a picture that people fill has no such place
  for (int tries = 0; tries < kMostTries; ++tries) {
    const bool is_proposed = !proposed_.empty() && uniform(random, 0.0, 1.0) < kProposedShare;
    const auto& some = is_proposed ? proposed_ : random_;
    const std::uint32_t index = some[below(random, some.size())];
    const Picture& picture = pictures_[index];
    ImageBox window;
    if (is_proposed) {
      if (picture.proposals.empty()) continue;
      window = picture.proposals[below(random, picture.proposals.size())];
    } else if (!picture.people.empty() && uniform(random, 0.0, 1.0) < kBesidePeople) {
      const ImageBox person = window_around(picture.people[below(random, picture.people.size())], kPersonShare);
      const double height = person.height_px * std::exp(uniform(random, -1.0, 1.0));
      window = {person.u_px + person.width_px / 2.0 - height / 4.0 + uniform(random, -0.8, 0.8) * person.height_px,
                person.v_px + person.height_px / 2.0 - height / 2.0 + uniform(random, -0.5, 0.5) * person.height_px,
                height / 2.0, height};
    } else {
      const double largest = std::min(1.2 * picture.image.height_px, 2.0 * picture.image.width_px);
      if (largest <= kMinHeight_px) continue;
      const double height = kMinHeight_px * std::pow(largest / kMinHeight_px, uniform(random, 0.0, 1.0));
      const double margin = 0.15 * height;
      window = {uniform(random, -margin, picture.image.width_px - height / 2.0 + margin),
                uniform(random, -margin, std::max(0.0, picture.image.height_px - height + margin)), height / 2.0,
                height};
    }
    if (is_clear(window, picture)) return {index, window};
  }
  throw InputError("pictures", "",
                   "found no room for windows without people in them; add larger ones, or some without people");
}

ImageBox jittered(const ImageBox& window, Random& random) {
  constexpr double kShift = 0.045, kScale = 0.12;
  const double scale = std::exp(uniform(random, -1.0, 1.0) * std::log1p(kScale));
  const double height = window.height_px * scale, width = window.width_px * scale;
  return {window.u_px + (window.width_px - width) / 2.0 + uniform(random, -kShift, kShift) * window.height_px,
          window.v_px + (window.height_px - height) / 2.0 + uniform(random, -kShift, kShift) * window.height_px, width,
          height};
}

void read_window(const Picture& picture, const ImageBox& window, float* pixels) {
  const FloatImage image = resample(picture.image.view(), window, kWindowWidth_px, kWindowHeight_px);
  std::copy_n(image.values.data(), kWindowPixels, pixels);
}

namespace {

void blur(float* pixels) {
  std::vector<float> aside(pixels, pixels + kWindowPixels);
  for (int v = 0; v < kWindowHeight_px; ++v)
    for (int u = 0; u < kWindowWidth_px; ++u) {
      float sum = 0.0F;
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i)
          sum += static_cast<float>((2 - std::abs(i)) * (2 - std::abs(j))) *
                 aside[static_cast<std::size_t>(std::clamp(v + j, 0, kWindowHeight_px - 1) * kWindowWidth_px +
                                                std::clamp(u + i, 0, kWindowWidth_px - 1))];
      pixels[v * kWindowWidth_px + u] = sum / 16.0F;
    }
}

/// Sides and legs behind cars, posts, other people.
void hide(float* pixels, const float* before, Random& random) {
  int left = 0, right = kWindowWidth_px, top = 0;
  const double share = uniform(random, 0.0, 1.0);
  const auto kind = below(random, 3);
  if (kind == 0) {
    top = static_cast<int>(kWindowHeight_px * (0.88 - 0.35 * share));
  } else {
    const int covered = static_cast<int>(8.0 + 12.0 * share);
    if (kind == 1) right = covered;
    if (kind == 2) left = kWindowWidth_px - covered;
    top = static_cast<int>(kWindowHeight_px * uniform(random, 0.0, 0.5));
  }
  for (int v = top; v < kWindowHeight_px; ++v)
    std::copy(before + v * kWindowWidth_px + left, before + v * kWindowWidth_px + right,
              pixels + v * kWindowWidth_px + left);
}

}  // namespace

void disguise(float* pixels, const float* before, double hidden_share, Random& random) {
  const auto chance = [&](double share) { return uniform(random, 0.0, 1.0) < share; };
  if (chance(0.5))
    for (int v = 0; v < kWindowHeight_px; ++v)
      std::reverse(pixels + v * kWindowWidth_px, pixels + (v + 1) * kWindowWidth_px);
  if (before != nullptr && chance(hidden_share)) hide(pixels, before, random);
  if (chance(0.3))
    for (std::size_t i = 0, times = 1 + below(random, 3); i < times; ++i) blur(pixels);
  if (chance(0.5)) {
    const auto gamma = static_cast<float>(std::exp(uniform(random, -0.5, 0.5)));
    for (std::size_t i = 0; i < kWindowPixels; ++i)
      pixels[i] = 255.0F * std::pow(std::max(pixels[i], 0.0F) / 255.0F, gamma);
  }
  if (chance(0.3)) {
    std::normal_distribution<float> noise(0.0F, static_cast<float>(uniform(random, 0.5, 8.0)));
    for (std::size_t i = 0; i < kWindowPixels; ++i) pixels[i] += noise(random);
  }
}

}  // namespace flies
