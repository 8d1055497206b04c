#include "flies/io/formats/stated_size.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <string_view>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/io/formats/named_keys.hpp"

namespace flies::detail {
namespace {

constexpr Names kWidth = {"width", "widthpx", "imagewidth", "imgwidth"};
constexpr Names kHeight = {"height", "heightpx", "imageheight", "imgheight"};
constexpr Names kSize = {"resolution", "imagesize", "imgsize", "imageresolution", "framesize", "size"};
constexpr Names kShape = {"imageshape", "imgshape", "shape"};  // of a NumPy array: rows, columns

/// Whole numbers of pixels of an image.
bool is_size(double number) {
  constexpr double kMost_px = 1e5;
  return number >= 1.0 && number <= kMost_px && number == std::floor(number);
}

/// 640x480 or 640*480 in one word, or with blanks.
std::optional<ImageSize> size_of_words(const NumberTable& table, const std::string& key) {
  const auto& entry = table.entries.find(key)->second;
  const std::string word = table.word(key);
  NumberTable split{table.source, {}};
  if (entry.numbers.size() == 2 && (word == "x" || word == "*")) {
    split.entries[key].numbers = entry.numbers;
    return size_of_list(split, key);
  }
  const auto at = word.find_first_of("x*");
  const auto is_digit = [](unsigned char c) { return std::isdigit(c) != 0; };
  if (!entry.numbers.empty() || at == std::string::npos || at == 0 || at + 1 == word.size() || word.size() > 12 ||
      !std::all_of(word.begin(), word.begin() + static_cast<std::ptrdiff_t>(at), is_digit) ||
      !std::all_of(word.begin() + static_cast<std::ptrdiff_t>(at) + 1, word.end(), is_digit))
    return std::nullopt;
  split.entries[key].numbers = {std::stod(word.substr(0, at)), std::stod(word.substr(at + 1))};
  return size_of_list(split, key);
}

struct SizeAt {
  std::string key;
  ImageSize size;
};

/// Two whole numbers as a size; nothing of others.
std::optional<ImageSize> size_of_numbers(double width, double height) {
  if (!is_size(width) || !is_size(height)) return std::nullopt;
  return ImageSize{static_cast<int>(width), static_cast<int>(height)};
}

bool is_list_of_size(const NumberTable& table, const std::string& key) {
  const auto& entry = table.entries.at(key);
  return entry.not_a_number.empty() && (entry.numbers.size() == 2 || entry.numbers.size() == 3);
}

/// What a key says in one: a list or words; nothing where that is no size.
std::optional<ImageSize> size_in_one(const NumberTable& table, const std::string& key, bool is_rows_first) {
  if (!is_list_of_size(table, key)) return size_of_words(table, key);
  const auto& numbers = table.entries.at(key).numbers;
  if (!std::ranges::all_of(numbers, is_size)) return std::nullopt;
  if (numbers.size() == 3) return size_of_numbers(numbers[1], numbers[0]);  // the shape of a NumPy array
  return is_rows_first ? size_of_numbers(numbers[1], numbers[0]) : size_of_numbers(numbers[0], numbers[1]);
}

/// Width and height of their own keys, pair by pair: image_width with image_height.
std::vector<SizeAt> sizes_of_two(const NumberTable& table) {
  std::vector<SizeAt> sizes;
  const auto is_one = [](const std::string&, const NumberEntry& entry) { return entry.numbers.size() == 1; };
  for (std::size_t name = 0; name < kWidth.size(); ++name) {
    const auto widths = keys_of(table, {*(kWidth.begin() + name)}, is_one);
    const auto heights = keys_of(table, {*(kHeight.begin() + name)}, is_one);
    for (std::size_t i = 0; i < std::min(widths.size(), heights.size()); ++i) {
      const auto size =
          size_of_numbers(table.entries.at(widths[i]).numbers[0], table.entries.at(heights[i]).numbers[0]);
      if (size && is_beside(widths[i], heights[i])) sizes.push_back({widths[i], *size});
    }
  }
  return sizes;
}

bool holds(ImageSize size, const SizeQuery& query) {
  return query.cx_px < size.width_px && query.cy_px < size.height_px;
}

/// Everything in the file that may be the size of the camera's images; below other keys only where nothing is on top.
std::vector<SizeAt> sizes_that_hold(const NumberTable& table, const SizeQuery& query) {
  std::vector<SizeAt> sizes = sizes_of_two(table);
  for (const auto& [key, entry] : table.entries) {
    const std::string name = plain_name(key);
    const bool is_shape = std::ranges::find(kShape, name) != kShape.end();
    if (!is_shape && (std::ranges::find(kSize, name) == kSize.end() || (name == "size" && !is_on_top(key)))) continue;
    if (const auto size = size_in_one(table, key, is_shape)) sizes.push_back({key, *size});
  }
  std::erase_if(sizes, [&](const SizeAt& at) { return !holds(at.size, query); });
  if (std::ranges::any_of(sizes, [](const SizeAt& at) { return is_on_top(at.key); }))
    std::erase_if(sizes, [](const SizeAt& at) { return !is_on_top(at.key); });
  return sizes;
}

/// The same of a size whose width and height may be exchanged.
bool may_hold(ImageSize size, const SizeQuery& query) {
  return holds(size, query) || holds({size.height_px, size.width_px}, query);
}

/// The height beside a width, or the width beside a height, of the same names: image_height beside image_width; "" when
/// there is none.
std::string other_side(const NumberTable& table, const std::string& key) {
  const auto index_in = [](Names names, const std::string& of) {
    return std::ranges::find(names, plain_name(of)) - names.begin();
  };
  const bool is_width = index_in(kWidth, key) < std::ssize(kWidth);
  const auto index = index_in(is_width ? kWidth : kHeight, key);
  for (const auto& [other, entry] : table.entries)
    if (is_beside(other, key) && index_in(is_width ? kHeight : kWidth, other) == index && entry.numbers.size() == 1)
      return other;
  return "";
}

/// Whether a key is the width or height of something that is smaller than the images.
bool is_side_of_other(const NumberTable& table, const std::string& key, const SizeQuery& query) {
  const auto& side = table.entries.at(key).numbers;
  if (side.size() != 1) return false;
  const std::string other = other_side(table, key);
  if (other.empty()) return !is_size(side[0]) || side[0] <= std::min(query.cx_px, query.cy_px);
  const auto size = size_of_numbers(side[0], table.entries.at(other).numbers[0]);
  return !size || !may_hold(*size, query);
}

/// The file without sizes of other things, such as those of a board, which the principal point does not lie in. What
/// stands beside the camera is its own as long as nothing else is.
NumberTable less_other_sizes(const NumberTable& table, const SizeQuery& query) {
  NumberTable rest = table;
  const bool has_size = !sizes_that_hold(table, query).empty();
  std::erase_if(rest.entries, [&](const auto& item) {
    const std::string &key = item.first, name = plain_name(key);
    const auto is_one_of = [&](Names names) { return std::ranges::find(names, name) != names.end(); };
    if (is_beside(key, query.camera_key) && !has_size) return false;
    if (is_one_of(kWidth) || is_one_of(kHeight)) return is_side_of_other(table, key, query);
    if (!is_one_of(kSize) && !is_one_of(kShape)) return false;
    const auto size = size_in_one(table, key, is_one_of(kShape));
    return size && !may_hold(*size, query);
  });
  return rest;
}

/// The key of a number; two are one with a decimal comma, which is told when it is asked for.
std::string key_of_one(const NumberTable& table, Names names) {
  const auto is_one = [](const std::string&, const NumberEntry& entry) { return entry.numbers.size() <= 2; };
  return chosen(table, keys_of(table, names, is_one));
}

/// That of the first of the names.
ImageSize first_size(const NumberTable& table) {
  const std::string width = key_of_one(table, kWidth), height = key_of_one(table, kHeight);
  if (!width.empty() || !height.empty())
    return {table.require_size(width.empty() ? "width" : width),
            table.require_size(height.empty() ? "height" : height)};
  const auto says_size = [&](const std::string& key, const NumberEntry&) {
    return (is_list_of_size(table, key) || size_of_words(table, key)) && (is_on_top(key) || plain_name(key) != "size");
  };
  if (const std::string key = chosen(table, keys_of(table, kSize, says_size)); !key.empty()) {
    const auto of_words = size_of_words(table, key);
    return of_words ? *of_words : size_of_list(table, key);
  }
  if (const std::string key = chosen(table, keys_of(table, kShape, says_size)); !key.empty()) {
    const auto size = size_of_list(table, key);
    return table.require(key).size() == 2 ? ImageSize{size.height_px, size.width_px} : size;
  }
  return {};
}

}  // namespace

ImageSize size_in(const NumberTable& whole, const SizeQuery& query) {
  const NumberTable table = less_other_sizes(whole, query);
  return agreed_size(table, first_size(table), query);
}

ImageSize agreed_size(const NumberTable& table, ImageSize found, const SizeQuery& query) {
  if (found.width_px == 0) return found;
  const auto is = [](ImageSize size, int width_px, int height_px) {
    return size.width_px == width_px && size.height_px == height_px;
  };
  const auto sizes = sizes_that_hold(table, query);
  const auto other = std::ranges::find_if(sizes, [&](const SizeAt& at) {
    // NumPy and MATLAB write rows first.
    return !is(at.size, found.width_px, found.height_px) && !is(at.size, found.height_px, found.width_px);
  });
  if (other == sizes.end() || is(found, query.said_width_px, query.said_height_px)) return found;
  for (const auto& at : sizes)
    if (is(at.size, query.said_width_px, query.said_height_px)) return at.size;
  throw InputError(table.source, other->key,
                   fmt::format("found {} x {} px, but {} x {} px elsewhere in the file: which is the size of the "
                               "images that the calibration is for? --calib-size W,H says it",
                               other->size.width_px, other->size.height_px, found.width_px, found.height_px));
}

}  // namespace flies::detail
