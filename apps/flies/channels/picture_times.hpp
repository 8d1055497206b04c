#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

/// The stamp of a message of Foxglove in JSON, nanoseconds; 0 where it has none. Read as {"sec": 5, "nsec": 7}, under
/// the names of ROS and protobuf (secs, seconds; nsecs, nanosec, nanos) and as numbers in quotes too, or as a text of
/// RFC 3339 with its time zone. Only this member is read, for pictures are long.
/// @returns nothing where there is one in another form
std::optional<std::uint64_t> json_stamp_ns(std::string_view message);

/// What is known of the time of a picture.
struct PictureTimes {
  std::uint64_t stamp_ns = 0;     ///< when it was taken; 0: the camera does not say
  std::uint64_t recorded_ns = 0;  ///< when its message was recorded
};

/// Times of one clock for the pictures of a topic: their stamps. Of pictures without one when they were recorded, by
/// the clock of the stamps, which the picture with a stamp that was recorded nearest tells.
std::vector<std::uint64_t> times_on_one_clock(const std::vector<PictureTimes>& pictures);

/// How many times the usual distance lies between neighbours; nothing where the distances are no multiples of it.
std::optional<std::vector<std::int64_t>> multiples_of_usual(const std::vector<std::uint64_t>& distances_ns);

/// The entry whose time is nearest; of two the later one. There is one.
template <class ByTime>
typename ByTime::const_iterator nearest(const ByTime& entries, std::uint64_t time_ns) {
  auto found = entries.lower_bound(time_ns);
  if (found == entries.end() ||
      (found != entries.begin() && time_ns - std::prev(found)->first < found->first - time_ns))
    --found;
  return found;
}
