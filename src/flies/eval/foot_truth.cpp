#include "flies/eval/foot_truth.hpp"

#include <fmt/format.h>

#include <cmath>
#include <sstream>

#include "flies/core/convert.hpp"
#include "flies/core/error.hpp"
#include "flies/core/letters.hpp"
#include "flies/eval/text.hpp"

namespace flies {
namespace {

constexpr double kPersonFootprint_m = 0.5;  // shoulder width
constexpr std::size_t kFields = 10;

}  // namespace

std::vector<FrameTruth> parse_foot_points(std::string_view text, const std::string& source,
                                          const StereoCamera& camera) {
  const Projection projection(camera);
  std::vector<FrameTruth> frames;
  for (const auto& [number, content] : detail::lines_of(text)) {
    const std::string field = fmt::format("line {}", number);
    std::vector<double> values;
    std::istringstream words{content};
    for (std::string word; std::getline(words, word, ',');) {
      values.push_back(detail::parse_number(detail::trimmed(word), source, field));
    }
    if (values.size() != kFields) {
      throw InputError(source, field, fmt::format("found {} fields, expected {}", values.size(), kFields));
    }
    constexpr double kMostFrames = 1e6;
    if (!(values[0] >= 1.0 && values[0] <= kMostFrames)) {
      throw InputError(source, field, fmt::format("found frame {}, expected 1 to {}", values[0], kMostFrames));
    }
    if (!(values[9] > 0.0)) throw InputError(source, field, fmt::format("found Z {}, expected > 0", values[9]));

    const std::size_t frame = saturated<std::size_t>(values[0]) - 1;
    while (frames.size() <= frame) {
      FrameTruth empty;
      empty.frame = static_cast<int>(frames.size());
      frames.push_back(std::move(empty));
    }
    const Point3 foot = vehicle_from_left_camera(camera, projection, {values[7], values[8], values[9]});
    LabelledObject person;
    person.type = "Pedestrian";
    const auto track = whole_number<int>(values[1]);
    if (!track) throw InputError(source, field, fmt::format("found person {}, expected a whole number", values[1]));
    person.track = *track;
    // The lower edge of a box is where the nearer foot stands: the near face.
    const double azimuth_rad = std::atan2(foot.y_m, foot.x_m);
    person.footprint = {foot.x_m + kPersonFootprint_m / 2.0 * std::cos(azimuth_rad),
                        foot.y_m + kPersonFootprint_m / 2.0 * std::sin(azimuth_rad), azimuth_rad, kPersonFootprint_m,
                        kPersonFootprint_m};
    person.bottom_z_m = foot.z_m;
    person.height_m = values[5] * values[9] / camera.fy_px;
    person.visible = values[6] != 0.0;
    person.box = {values[2], values[3], values[4], values[5]};
    frames[frame].objects.push_back(std::move(person));
  }
  return frames;
}

std::vector<FrameTruth> read_foot_points(const std::filesystem::path& file, const StereoCamera& camera) {
  return parse_foot_points(detail::read_truth(file), file.string(), camera);
}

}  // namespace flies
