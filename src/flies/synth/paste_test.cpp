#include "flies/synth/paste.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/core/random.hpp"

namespace flies {
namespace {

constexpr double kFar_m = 50.0;  // what is seen above the road

StereoCamera camera() {
  StereoCamera c;
  c.fx_px = c.fy_px = 400;
  c.cx_px = c.cx_right_px = 200;
  c.cy_px = 90;
  c.baseline_m = 0.5;
  c.width_px = 400;
  c.height_px = 200;
  return c;
}

GrayImage noise(std::uint32_t number) {
  GrayImage image{camera().width_px, camera().height_px, {}};
  for (std::uint32_t i = 0; i < 400 * 200; ++i)
    image.pixels.push_back(static_cast<std::uint8_t>(80 + philox({i, number, 0, 0}, 1)[0] % 64));
  return image;
}

/// Disparities of a level road and of a wall behind it.
std::vector<float> road() {
  const StereoCamera c = camera();
  std::vector<float> disparity_px;
  for (int v = 0; v < c.height_px; ++v) {
    const double road_px = (v - c.cy_px) * c.baseline_m / c.mount.height_m;
    const double wall_px = c.fx_px * c.baseline_m / kFar_m;
    disparity_px.insert(disparity_px.end(), 400, static_cast<float>(std::max(road_px, wall_px)));
  }
  return disparity_px;
}

/// A striped rectangle of 20 x 60 px in a crop of 32 x 80.
CutOut board() {
  GrayImage image{32, 80, {}}, mask{32, 80, {}};
  for (int v = 0; v < 80; ++v)
    for (int u = 0; u < 32; ++u) {
      image.pixels.push_back(u / 4 % 2 == 0 ? 60 : 180);
      mask.pixels.push_back(u >= 6 && u < 26 && v >= 10 && v < 70 ? 255 : 0);
    }
  return *cut_out_by_mask(std::move(image), std::move(mask));
}

struct Street {
  GrayImage left = noise(1), right = noise(2);
  std::vector<float> known_px = road();
  std::vector<float> matched_px = std::vector<float>(400 * 200, std::numeric_limits<float>::quiet_NaN());
  std::vector<CutOut> cut_outs = {board()};
  PasteOptions options = [] {
    PasteOptions o;
    o.noise_gray = 0.0;
    return o;
  }();
  std::vector<ImageBox> keep_clear = {};

  PastedPair paste(std::uint32_t frame = 0) const {
    const RealPair pair{{left.view(), right.view()}, camera(), known_px, matched_px, keep_clear};
    return paste_people(pair, cut_outs, options, frame);
  }
};

TEST(PastePeople, PutsThemOnTheGroundAtTheirRange) {
  const Projection projection(camera());
  const PastedPair pasted = Street{}.paste();
  ASSERT_EQ(pasted.people.size(), 3U);
  for (const auto& person : pasted.people) {
    // Half a row of the image is at 24 m three centimetres of height.
    EXPECT_NEAR(person.z_m, 0.0, 0.05);
    EXPECT_GE(person.x_m, 8.0);
    EXPECT_LE(person.x_m, 24.0);
    EXPECT_GE(person.height_m, 1.55);
    EXPECT_LE(person.height_m, 1.9);
    const double depth_m = projection.depth_m({person.x_m, person.y_m, person.z_m});
    EXPECT_NEAR(person.box.height_px, 400 * person.height_m / depth_m, 0.1);
    const auto middle = pasted.pixels.index(static_cast<int>(person.box.u_px + person.box.width_px / 2),
                                            static_cast<int>(person.box.v_px + person.box.height_px / 2));
    EXPECT_NEAR(pasted.pixels.disparity_px[middle], projection.disparity_at_depth(depth_m), 1e-3);
  }
}

TEST(PastePeople, ShowsTheSameInBothImagesAtTheTrueDisparity) {
  const PastedPair pasted = Street{}.paste();
  double sum = 0.0;
  int count = 0;
  for (int v = 0; v < 200; ++v) {
    for (int u = 1; u < 399; ++u) {
      const auto at = [&](int column) { return pasted.pixels.object[pasted.pixels.index(column, v)]; };
      if (at(u) < 0 || at(u - 1) != at(u) || at(u + 1) != at(u)) continue;
      const double right_u = u - static_cast<double>(pasted.pixels.disparity_px[pasted.pixels.index(u, v)]);
      const auto left_of = static_cast<std::size_t>(std::floor(right_u));
      const double share = right_u - std::floor(right_u);
      const std::uint8_t* row = pasted.right.pixels.data() + v * 400;
      sum += std::abs((1 - share) * row[left_of] + share * row[left_of + 1] -
                      pasted.left.pixels[static_cast<std::size_t>(v * 400 + u)]);
      ++count;
    }
  }
  ASSERT_GT(count, 500);
  // Stripes of 90 to 120 levels; what is left is that both images are interpolated, at different places. One pixel of
  // disparity more gives 18, as seen by trying.
  EXPECT_LT(sum / count, 9.0);
}

TEST(PastePeople, LeavesWhatIsNearerInFront) {
  Street street;
  street.options.people = 8;
  const auto is_pole = [](int u) { return u % 24 < 5; };
  for (int v = 0; v < 200; ++v)
    for (int u = 0; u < 400; ++u)
      if (is_pole(u)) street.known_px[static_cast<std::size_t>(v * 400 + u)] = 60.0F;
  const PastedPair pasted = street.paste();
  ASSERT_GE(pasted.people.size(), 3U);
  for (int v = 0; v < 200; ++v)
    for (int u = 0; u < 400; ++u) {
      const auto i = static_cast<std::size_t>(v * 400 + u);
      if (u % 24 >= 1 && u % 24 <= 3) {  // the edge is soft
        ASSERT_EQ(pasted.left.pixels[i], street.left.pixels[i]) << u << " " << v;
      }
      if (is_pole(u)) {
        EXPECT_EQ(pasted.pixels.disparity_px[i], 60.0F);
      }
    }
  for (const auto& person : pasted.people) {
    if (person.box.width_px < 24) continue;  // may stand between two poles
    EXPECT_GT(person.occlusion, 0.1);
    EXPECT_LT(person.occlusion, 0.5);
  }
}

TEST(PastePeople, PaintsNearerPeopleOverFartherOnes) {
  Street street;
  street.options.people = 60;
  const PastedPair pasted = street.paste();
  ASSERT_GT(pasted.people.size(), 6U);
  EXPECT_TRUE(std::any_of(pasted.people.begin(), pasted.people.end(),
                          [](const TruthObject& person) { return person.occlusion > 0.1; }));
  EXPECT_LT(pasted.people.front().occlusion, 0.02) << "nobody is before the nearest";
  for (std::size_t i = 1; i < pasted.people.size(); ++i)
    EXPECT_LE(pasted.people[i - 1].near_range_m, pasted.people[i].near_range_m);
}

TEST(PastePeople, RepeatsItself) {
  Street street;
  street.options.noise_gray = 1.5;
  const PastedPair once = street.paste(), again = street.paste(), other = street.paste(1);
  EXPECT_EQ(once.left.pixels, again.left.pixels);
  EXPECT_EQ(once.right.pixels, again.right.pixels);
  EXPECT_NE(once.left.pixels, other.left.pixels);
  EXPECT_EQ(street.cut_outs[0].image.pixels, board().image.pixels);
}

TEST(PastePeople, KeepsOffBoxesThatAreToStayClear) {
  Street street;
  street.options.people = 6;
  street.keep_clear = {{0, 0, 200, 200}};
  const PastedPair pasted = street.paste();
  ASSERT_FALSE(pasted.people.empty());
  for (const auto& person : pasted.people) EXPECT_GE(person.box.u_px, 200.0);
}

TEST(PastePeople, NeedsGroundThatIsSeen) {
  Street street;
  std::fill(street.known_px.begin(), street.known_px.end(), 15.0F);  // a wall
  EXPECT_TRUE(street.paste().people.empty());
  EXPECT_EQ(street.paste().left.pixels, street.left.pixels);
  street.known_px = street.matched_px;  // nothing is known
  EXPECT_TRUE(street.paste().people.empty());
  street.matched_px = road();  // nothing but what was matched
  EXPECT_FALSE(street.paste().people.empty());
}

TEST(PastePeople, MatchesTheLight) {
  Street street;
  for (auto* image : {&street.left, &street.right})
    for (auto& pixel : image->pixels) pixel = static_cast<std::uint8_t>(pixel + 90);  // 170 to 233
  const PastedPair dark = Street{}.paste(), light = street.paste();
  const auto mean_on_people = [](const PastedPair& pasted) {
    double sum = 0.0, count = 0.0;
    for (std::size_t i = 0; i < pasted.pixels.object.size(); ++i)
      if (pasted.pixels.object[i] >= 0) {
        sum += pasted.left.pixels[i];
        ++count;
      }
    return sum / count;
  };
  EXPECT_NEAR(mean_on_people(light) - mean_on_people(dark), 90.0, 10.0);
}

TEST(PastePeople, RefusesOptionsThatCannotBe) {
  Street street;
  street.options.people_max_range_m = 7.0;
  EXPECT_THROW(street.paste(), InputError);
  street.options = {};
  street.options.people = -1;
  EXPECT_THROW(street.paste(), InputError);
}

TEST(PastePeople, RefusesSizesThatDoNotFit) {
  Street short_of_truth, short_of_matches, without_people, uneven;
  short_of_truth.known_px.pop_back();
  EXPECT_THROW(short_of_truth.paste(), InputError);
  short_of_matches.matched_px.clear();
  EXPECT_THROW(short_of_matches.paste(), InputError);
  without_people.cut_outs.clear();
  EXPECT_THROW(without_people.paste(), InputError);
  uneven.right.height_px /= 2;
  EXPECT_THROW(uneven.paste(), InputError);
}

}  // namespace
}  // namespace flies
