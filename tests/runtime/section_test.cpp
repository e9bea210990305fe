// SPDX-License-Identifier: MIT
// Widths and twists of sections along a spline.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "caged.h"

namespace kelp::runtime {
namespace {

// A tower whose sections part 1 says; without them if not `sectioned`.
struct Tower {
  static constexpr glm::ivec3 kSize{8, 64, 12};

  explicit Tower(Bend bend, bool sectioned = true, int cell = 4)
      : loaded(packOf(bend, sectioned, cell)), pose(Pose::create(*loaded.asset).value()) {}
  static RawPack packOf(Bend bend, bool sectioned, int cell) {
    const fields::Occupancy block{
        kSize, std::vector<std::uint8_t>(static_cast<std::size_t>(kSize.x * kSize.y * kSize.z), 1)};
    RawPack pack = CagedAsset::packOf(block, cell, bend, straight({0, 0.5f, 1}));
    RawPart sections;
    sections.name = "sections";
    sections.size = {1, 1, 1};
    sections.knots = straight({0, 0.25f, 1});
    pack.parts.push_back(sections);
    pack.parts[0].sections = sectioned ? 1 : -1;
    return pack;
  }
  const Cage& cage(std::size_t i = 0) const { return loaded.asset->pack().parts()[0].cages[i]; }
  std::span<const glm::vec3> nodes() const { return std::as_const(pose).nodes(0); }
  // A node at rest from the middle line, and its height.
  glm::dvec3 rest(std::uint32_t node) const {
    return glm::dvec3(cage().rest(node)) - glm::dvec3(0.5 * kSize.x, 0, 0.5 * kSize.z);
  }
  void set(int knot, const PartSection& section) { pose.setSection(0, knot, section).value(); }

  Loaded loaded;
  Pose pose;
};

// Where a level of the lattice goes without sections: at + a x + b z.
struct Plane {
  glm::dvec3 at, x, z;
};
std::map<int, Plane> planesOf(const Tower& plain) {
  std::map<int, std::map<std::pair<int, int>, glm::dvec3>> levels;
  for (std::uint32_t i = 0; i < plain.cage().nodes(); ++i) {
    const glm::ivec3 rest = plain.cage().rest(i);
    levels[rest.y][{rest.x, rest.z}] = plain.nodes()[i];
  }
  std::map<int, Plane> planes;
  for (auto& [y, at] : levels) {
    Plane& plane = planes[y];
    plane.x = (at[{8, 0}] - at[{0, 0}]) / 8.0;
    plane.z = (at[{0, 12}] - at[{0, 0}]) / 12.0;
    plane.at = at[{0, 0}] + 4.0 * plane.x + 6.0 * plane.z;
  }
  return planes;
}

// The sum of the volumes of all tetrahedra of the finest cage.
double volumeOf(const Tower& tower) {
  double sum = 0;
  for (std::uint32_t cell = 0; cell < tower.cage().cells(); ++cell) {
    for (int t = 0; t < 6; ++t) {
      glm::dvec3 p[4];
      for (int k = 0; k < 4; ++k)
        p[k] = tower.nodes()[tower.cage().node(cell, kCageTetrahedra[t].corners[k])];
      const double sign = t == 0 || t == 3 || t == 4 ? 1 : -1;
      sum += sign * glm::determinant(glm::dmat3(p[1] - p[0], p[2] - p[0], p[3] - p[0])) / 6;
    }
  }
  return sum;
}

std::vector<Knot> stretched(float by) {
  return {{0, {0, 0, 0}, {0, by, 0}}, {0.5f, {0, 0.5f * by, 0}, {0, by, 0}}, {1, {0, by, 0}, {0, by, 0}}};
}

// SPEC.md 4.9, in double precision.
TEST(Section, NodesGoWhereTheFormatSays) {
  for (const Bend bend : {Bend::kShear, Bend::kSweep}) {
    Tower tower(bend), plain(bend, false);
    for (Tower* one : {&tower, &plain}) one->pose.setKnots(0, runtime::leaning()).value();
    tower.set(0, {{1.5f, 0.7f}, -0.3f});
    tower.set(1, {{0.8f, 1.1f}, 0.9f});
    tower.set(2, {{1, 0.6f}, 2});
    const double at[3] = {0, 0.25, 1}, u[3] = {1.5, 0.8, 1}, v[3] = {0.7, 1.1, 0.6},
                 twist[3] = {-0.3, 0.9, 2};
    std::map<int, Plane> planes = planesOf(plain);
    for (std::uint32_t i = 0; i < tower.cage().nodes(); ++i) {
      const glm::dvec3 rest = tower.rest(i);
      const double h = rest.y / Tower::kSize.y;
      const int k = h < 0.25 ? 0 : 1;
      const double share = (h - at[k]) / (at[k + 1] - at[k]);
      const auto between = [&](const double* of) { return of[k] + share * (of[k + 1] - of[k]); };
      const double t = between(twist), a = between(u) * rest.x, b = between(v) * rest.z;
      const Plane& plane = planes[static_cast<int>(rest.y)];
      const glm::dvec3 truth = plane.at + (a * std::cos(t) + b * std::sin(t)) * plane.x +
                               (b * std::cos(t) - a * std::sin(t)) * plane.z;
      ASSERT_LT(glm::distance(truth, glm::dvec3(tower.nodes()[i])), 2e-3) << i;
    }
  }
}

TEST(Section, WidthsAndTwistsRunLinearly) {
  Tower tower(Bend::kSweep);
  tower.set(1, {{1.2f, 1.2f}, 0});
  tower.set(2, {{1, 1}, 1.5f});
  for (std::uint32_t i = 0; i < tower.cage().nodes(); ++i) {
    const glm::dvec3 rest = tower.rest(i);
    if (rest.x == 0 && rest.z == 0) continue;
    const double h = rest.y / Tower::kSize.y;
    const double width = h < 0.25 ? 1 + 0.8 * h : 1.2 - 0.2 / 0.75 * (h - 0.25),
                 twist = h < 0.25 ? 0 : 1.5 * (h - 0.25) / 0.75;
    const glm::dvec3 now =
        glm::dvec3(tower.nodes()[i]) - glm::dvec3(0.5 * Tower::kSize.x, 0, 0.5 * Tower::kSize.z);
    EXPECT_NEAR(std::hypot(now.x, now.z) / std::hypot(rest.x, rest.z), width, 1e-4);
    EXPECT_NEAR(std::remainder(std::atan2(now.x, now.z) - std::atan2(rest.x, rest.z) - twist, 2 * M_PI), 0,
                1e-4);
    EXPECT_NEAR(now.y, rest.y, 1e-4);
  }
}

TEST(Section, KeepTheVolume) {
  for (const Bend bend : {Bend::kShear, Bend::kSweep}) {
    for (const float by : {1.5f, 0.6f}) {
      Tower tower(bend);
      const double rest = volumeOf(tower);
      tower.pose.setKnots(0, stretched(by)).value();
      EXPECT_NEAR(volumeOf(tower) / rest, by, 0.01);
      for (int knot = 0; knot < 3; ++knot) tower.set(knot, {{1, 1}, 0, 1});
      EXPECT_NEAR(volumeOf(tower) / rest, 1, 0.01) << by;
      tower.set(1, {{by, 1}, 0, 1});
      EXPECT_NEAR(volumeOf(tower) / rest, 1, 0.01) << by;
      for (int knot = 0; knot < 3; ++knot) tower.set(knot, {{by, 2}, 0, 1});
      EXPECT_NEAR(volumeOf(tower) / rest, 1, 0.01) << by;
    }
  }
}

TEST(Section, ClipsAndBlendsMoveThem) {
  RawPack pack = Tower::packOf(Bend::kShear, true, 4);
  pack.clips = {{"breathe", 2, {{1, 1, Target::kKnotOffset, {0.4f, 0, 0.2f}, 2, 0}}, {}}};
  const Loaded loaded(pack);
  Pose pose = Pose::create(*loaded.asset).value(), other = Pose::create(*loaded.asset).value();
  addClip(*loaded.asset, 0, 0.5, 1, pose).value();
  EXPECT_NEAR(pose.section(0, 1)->width.x, 1.4f, 1e-6f);
  EXPECT_NEAR(pose.section(0, 1)->width.y, 1.2f, 1e-6f);
  other.setSection(0, 2, {{1, 1}, 1, 0.5f}).value();
  const std::vector<glm::vec3> before(std::as_const(pose).nodes(0).begin(),
                                      std::as_const(pose).nodes(0).end());
  pose.blend(other, 0.5f).value();
  EXPECT_NEAR(pose.section(0, 1)->width.x, 1.2f, 1e-6f);
  EXPECT_NEAR(pose.section(0, 2)->twist, 0.5f, 1e-6f);
  EXPECT_NEAR(pose.section(0, 2)->keep_volume, 0.25f, 1e-6f);
  EXPECT_FALSE(std::equal(before.begin(), before.end(), std::as_const(pose).nodes(0).begin()));
}

TEST(Section, WrongOnesAreRefused) {
  Tower tower(Bend::kShear), plain(Bend::kShear, false);
  EXPECT_FALSE(plain.pose.setSection(0, 0, {}));
  EXPECT_FALSE(plain.pose.section(0, 0));
  EXPECT_FALSE(tower.pose.setSection(1, 0, {}));
  EXPECT_FALSE(tower.pose.setSection(0, 3, {}));
  EXPECT_FALSE(tower.pose.setSection(0, -1, {}));
  const float bad = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(tower.pose.setSection(0, 0, {{1, bad}}));
  EXPECT_FALSE(tower.pose.setSection(0, 0, {{1, 1}, bad}));
  EXPECT_FALSE(tower.pose.setSection(0, 0, {{1, 1}, 0, bad}));
  // Sections that collapse draw nothing, and nothing breaks.
  for (int knot = 0; knot < 3; ++knot) tower.set(knot, {{0, 0}, 0, 1});
  const Instance instance{tower.loaded.asset.get(), &tower.pose};
  EXPECT_TRUE(tower.pose.check());
  EXPECT_FALSE(raycast(instance, {{-5, 0.3f, 0.01f}, {1, 0, 0}}));
  // Numbers that nobody checked: the instance is left out.
  tower.pose
      .setKnots(1,
                {{{0, {bad, 0, 0}, {0, 1, 0}}, {0.25f, {0, 0.25f, 0}, {0, 1, 0}}, {1, {0, 1, 0}, {0, 1, 0}}}})
      .value();
  EXPECT_FALSE(tower.pose.check());
  EXPECT_FALSE(posedCage(instance, 0, 0));
  for (const PartSection& far : {PartSection{{1e30f, 1}}, PartSection{{1, 1}, -1e9f}}) {
    Tower other(Bend::kSweep);
    other.pose.setKnots(0, runtime::leaning()).value();
    other.set(1, far);
    EXPECT_EQ(other.pose.check().error().offset, 0u);
    other.pose.clamp();
    EXPECT_TRUE(other.pose.check());
    EXPECT_EQ(other.pose.section(0, 1)->width, glm::vec2(1));
    EXPECT_TRUE(posedCage({other.loaded.asset.get(), &other.pose}, 0, 0));
  }
}

}  // namespace
}  // namespace kelp::runtime
