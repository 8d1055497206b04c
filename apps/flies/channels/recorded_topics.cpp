#include "channels/recorded_topics.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <tuple>
#include <utility>

#include "flies/core/letters.hpp"

namespace {

constexpr std::string_view kCompressed = "/compressed";
constexpr std::string_view kRight = "right", kLeft = "left";

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_capital(char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; }

/// Where a name says "right", in whatever letters.
std::vector<std::size_t> places_of_right(const std::string& topic) {
  const std::string small = flies::detail::in_small_letters(topic);
  std::vector<std::size_t> places;
  for (auto at = small.find(kRight); at != std::string::npos; at = small.find(kRight, at + kRight.size()))
    places.push_back(at);
  return places;
}

/// Whether it stands alone there, unlike in "rightarm" and "bright".
bool is_whole_word(const std::string& topic, std::size_t at) {
  const std::size_t end = at + kRight.size();
  return (at == 0 || !is_letter(topic[at - 1])) && (end == topic.size() || !is_letter(topic[end]));
}

/// The name with left for right at these places, in ascending order.
std::string with_left(std::string topic, const std::vector<std::size_t>& places) {
  for (auto at = places.rbegin(); at != places.rend(); ++at) {
    std::string left(kLeft);
    for (std::size_t i = 0; i < left.size(); ++i)
      if (is_capital(topic[*at + i])) left[i] = static_cast<char>(std::toupper(static_cast<unsigned char>(left[i])));
    topic.replace(*at, kRight.size(), left);
  }
  return topic;
}

/// The topic of the left pictures to that of right ones, of those that there are. A name may say "right" of more than
/// the camera: whole words count before parts of words, all of them before each alone.
std::optional<std::string> left_of(const std::string& topic, const std::vector<std::string>& topics) {
  const auto places = places_of_right(topic);
  std::vector<std::size_t> words;
  std::ranges::copy_if(places, std::back_inserter(words), [&](std::size_t at) { return is_whole_word(topic, at); });
  std::vector<std::vector<std::size_t>> choices = {words};
  for (const std::size_t at : words) choices.push_back({at});
  choices.push_back(places);
  for (const std::size_t at : places) choices.push_back({at});
  for (const auto& choice : choices)
    if (auto left = with_left(topic, choice); !choice.empty() && std::ranges::find(topics, left) != topics.end())
      return left;
  return std::nullopt;
}

/// The topic with a number one lower, of those that there are.
std::optional<std::string> one_below(const std::string& topic, const std::vector<std::string>& topics) {
  for (std::size_t begin = 0, end = 0; begin < topic.size(); begin = end + 1) {
    for (end = begin; end < topic.size() && is_digit(topic[end]); ++end) continue;
    std::string lower = topic;
    std::size_t at = end;
    while (at > begin && lower[at - 1] == '0') lower[--at] = '9';  // 10 becomes 09, as of numbers of equal length
    if (at == begin) continue;                                     // no digit, or zeros alone
    --lower[at - 1];
    if (std::ranges::find(topics, lower) != topics.end()) return lower;
  }
  return std::nullopt;
}

/// How far from what is wanted the pictures of a topic are.
auto rank(const std::string& topic) { return std::pair(!is_called_rectified(topic), topic.ends_with(kCompressed)); }

/// And among those of one camera: grey ones, then coloured ones, then what may be a mosaic of colours.
int rank_in_camera(const std::string& topic) {
  const std::string name = topic.substr(camera_info_topic(topic).rfind('/') + 1);
  const auto has = [&](std::string_view word) { return name.find(word) != std::string::npos; };
  if (has("color") || has("colour")) return 1;
  return has("raw") ? 2 : 0;
}

}  // namespace

std::string camera_info_topic(std::string pictures) {
  if (pictures.ends_with(kCompressed)) pictures.resize(pictures.size() - kCompressed.size());
  return pictures.substr(0, pictures.rfind('/') + 1) + "camera_info";
}

bool is_called_rectified(const std::string& pictures) { return pictures.find("image_rect") != std::string::npos; }

std::optional<StereoTopics> stereo_topics(const std::vector<std::string>& topics) {
  std::vector<StereoTopics> found;
  for (const auto& topic : topics)
    if (const auto left = left_of(topic, topics)) found.push_back({*left, topic, false});
  if (found.empty())
    for (const auto& topic : topics)
      if (const auto left = one_below(topic, topics)) found.push_back({*left, topic, true});
  if (found.empty()) return std::nullopt;
  const auto least = [](const StereoTopics& pair) {
    return std::tuple(rank(pair.right), rank_in_camera(pair.right), pair.right.size(), pair.right);
  };
  const auto best = *std::ranges::min_element(found, {}, least);
  const bool is_clear = std::ranges::all_of(found, [&](const StereoTopics& pair) {
    return rank(pair.right) != rank(best.right) || camera_info_topic(pair.right) == camera_info_topic(best.right);
  });
  return is_clear ? std::optional(best) : std::nullopt;
}
