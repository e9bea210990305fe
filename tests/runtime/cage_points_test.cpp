// SPDX-License-Identifier: MIT
// toWorld(), toRest(), frameAt() and sockets of parts with cages, against the maps that the nodes were moved
// by, and against rays, which find points of the posed model by themselves.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <tuple>

#include "caged_instance.h"

namespace kelp::runtime {
namespace {

using PointMap = std::function<glm::dvec3(const glm::dvec3&)>;

struct NamedMap {
  const char* name;
  PointMap map;
  double strays;  // how far tetrahedra may be from it, voxels
};
std::vector<NamedMap> smoothMaps(const glm::ivec3& size) {
  const glm::dvec3 s(size);
  const auto turned = [=](double angle, const glm::dvec3& p) {
    const double x = p.x - 0.5 * s.x, z = p.z - 0.5 * s.z;
    return glm::dvec3(std::cos(angle) * x - std::sin(angle) * z, p.y,
                      std::sin(angle) * x + std::cos(angle) * z);
  };
  return {{"rest", [](const glm::dvec3& p) { return p; }, 1e-3},
          {"affine",
           [](const glm::dvec3& p) {
             return glm::dmat3(1.5, 0.2, 0, -0.4, 0.8, 0.1, 0, 0.3, 1.1) * p + glm::dvec3(7, -9, 3);
           },
           1e-3},
          {"twisted", [=](const glm::dvec3& p) { return turned(1.2 * p.y / s.y, p); }, 1},
          {"bent",
           [=](const glm::dvec3& p) {
             const double radius = 1.5 * s.y, angle = 1.2 * p.y / s.y, out = radius - p.x;
             return glm::dvec3(radius - out * std::cos(angle), out * std::sin(angle), p.z);
           },
           1}};
}

void moveNodes(const CagedAsset& asset, const PointMap& map, Pose& pose) {
  const Cage& cage = asset.part().cages[0];
  const std::span<glm::vec3> nodes = pose.nodes(0);
  for (std::uint32_t i = 0; i < cage.nodes(); ++i) nodes[i] = glm::vec3(map(glm::dvec3(cage.rest(i))));
}

class CagePoints : public testing::Test {
 protected:
  double unit() { return static_cast<double>(random_()) / 4294967296.0; }
  glm::vec3 solidPoint(const fields::Occupancy& volume) {
    while (true) {
      const glm::dvec3 at = glm::dvec3(volume.size) * glm::dvec3{unit(), unit(), unit()};
      if (volume.solid[volume.index(glm::ivec3(at))]) return glm::vec3(at);
    }
  }
  std::mt19937 random_{11};
};

double voxelsBetween(const CagedAsset& asset, const glm::vec3& a, const glm::vec3& b) {
  return double{glm::distance(a, b) / asset.part().to_object[1].y};
}

TEST_F(CagePoints, ThereAndBack) {
  const int points = test::allTests() ? 65000 : test::shareOf(1500);
  int inner = 0;
  constexpr double kInnerStrays = 5;  // interpolation across the whole block
  for (const fields::Occupancy& volume : {twoLegs({43, 60, 38}), test::hollowBlock()}) {
    for (const int cell : {4, 8}) {
      const CagedAsset asset(volume, cell, Bend::kSweep);
      const Cage& cage = asset.part().cages[0];
      const auto placeOf = [](const glm::ivec3& at) { return std::tuple(at.x, at.y, at.z); };
      std::set<std::tuple<int, int, int>> places;
      for (std::uint32_t i = 0; i < cage.cells(); ++i) places.insert(placeOf(cage.place(i)));
      for (const NamedMap& moved : smoothMaps(volume.size)) {
        SCOPED_TRACE(moved.name);
        Pose pose = asset.pose();
        moveNodes(asset, moved.map, pose);
        ASSERT_EQ(asset.posed(pose).inverted_count, 0u);
        const Instance instance = asset.instance(pose);
        double worst = 0, stray = 0, inner_stray = 0;
        for (int i = 0; i < points; ++i) {
          const glm::vec3 rest = solidPoint(volume);
          const glm::vec3 world = toWorld(instance, 0, asset.toObject(rest)).value();
          const auto back = toRest(instance, 0, world);
          ASSERT_TRUE(back);
          worst = std::max(worst, voxelsBetween(asset, *back, asset.toObject(rest)));
          const double off =
              voxelsBetween(asset, world, asset.toObject(glm::vec3(moved.map(glm::dvec3(rest)))));
          const bool in_cell = places.contains(placeOf(glm::ivec3(rest) / cell));
          double& most = in_cell ? stray : inner_stray;
          most = std::max(most, off);
          inner += !in_cell;
        }
        EXPECT_LT(worst, 0.01) << cell;
        EXPECT_LT(stray, moved.strays) << cell;
        EXPECT_LT(inner_stray, moved.strays < 0.1 ? moved.strays : kInnerStrays) << cell;
      }
    }
  }
  EXPECT_GT(inner, points / 10);
}

// A ray tells which point of the model it hit, and where that is now, also if pieces lie in one another.
TEST_F(CagePoints, GoesWhereRaysFindThePoint) {
  for (const int cell : {4, 8}) {
    const CagedAsset asset(twoLegs({43, 60, 38}), cell, Bend::kSweep);
    for (const float far : {0.1f, 0.3f, 1.0f}) {
      Pose pose = asset.pose();
      pose.setKnots(0, leaning()).value();
      shakeNodes(pose.nodes(0), far * static_cast<float>(cell), 3);
      const Instance instance = asset.instance(pose);
      const Box box = bounds(instance);
      int hits = 0, back = 0, wrong = 0;
      for (int i = 0; i < 3000; ++i) {
        const glm::vec3 target = glm::mix(box.min, box.max, glm::vec3(glm::dvec3{unit(), unit(), unit()}));
        const glm::vec3 way = glm::vec3(glm::dvec3{unit(), unit(), unit()}) - 0.5f;
        const auto hit = raycast(instance, {target - 9.0f * glm::normalize(way), way});
        if (!hit) continue;
        ++hits;
        wrong += voxelsBetween(asset, toWorld(instance, 0, hit->rest).value(), hit->position) > 0.02;
        // A hair below the surface, where nothing else is as a rule.
        const auto rest = toRest(instance, 0, hit->position + 1e-4f * asset.part().to_object[1].y * way);
        back += rest && voxelsBetween(asset, *rest, hit->rest) < 0.05;
      }
      EXPECT_GT(hits, 300);
      EXPECT_LE(wrong, hits / 200) << cell << ' ' << far;
      EXPECT_GE(back, far > 0.5f ? hits / 2 : hits * 95 / 100) << cell << ' ' << far;
    }
  }
}

// Two posts in one cell move apart. Points, frames and a socket stay with their post.
TEST_F(CagePoints, StaysWithItsPiece) {
  fields::Occupancy posts{glm::ivec3(16, 32, 8), std::vector<std::uint8_t>(16 * 32 * 8)};
  for (int i = 0; i < 16 * 32 * 8; ++i) {
    const glm::ivec3 v(i % 16, i / 16 % 32, i / 512);
    posts.solid[static_cast<std::size_t>(i)] = v.x == 3 || v.x == 6;
  }
  RawPack pack = CagedAsset::packOf(posts, 8, Bend::kSweep, straight({0, 1}));
  // Beside the second post; 4.6 voxels from x = 0.
  pack.sockets = {{"hook", 0, 0.5f, {-3.4f / 32, 0}, {1, 0, 0, 0}}};
  const Loaded loaded(pack);
  const Part& part = loaded.asset->pack().parts()[0];
  const Cage& cage = part.cages[0];
  Pose pose = Pose::create(*loaded.asset).value();
  const std::span<glm::vec3> nodes = pose.nodes(0);
  // The first post's cells, by their masks, go to x + 100.
  std::vector<bool> of_first(cage.nodes());
  for (std::uint32_t c = 0; c < cage.cells(); ++c) {
    ASSERT_NE(cage.cell(c)[1], 0u);
    const bool first = (cage.words[cage.cell(c)[1]] >> 3 & 1) != 0;
    for (int i = 0; i < 8; ++i) of_first[cage.node(c, i)] = first;
  }
  const glm::vec3 apart(100, 0, 0);
  for (std::uint32_t n = 0; n < cage.nodes(); ++n)
    if (of_first[n]) nodes[n] += apart;
  const Instance instance{loaded.asset.get(), &pose};
  const auto toObject = [&](const glm::vec3& p) { return part.to_object * glm::vec4(p, 1); };
  for (int i = 0; i < 200; ++i) {
    const float x = static_cast<float>(10 * unit()) - 1;
    const glm::vec3 rest(x, 32 * unit(), 8 * unit());
    const glm::vec3 there = rest + (x < 5 ? apart : glm::vec3(0));
    const glm::vec3 world = toWorld(instance, 0, toObject(rest)).value();
    EXPECT_LT(glm::distance(world, toObject(there)), 1e-5f) << x;
    EXPECT_LT(glm::distance(toRest(instance, 0, world).value(), toObject(rest)), 1e-5f) << x;
  }
  const glm::mat4 hook = socketToWorld(instance, 0).value();
  EXPECT_LT(glm::distance(glm::vec3(hook[3]), toObject(apart + glm::vec3(4.6f, 16, 4))), 1e-5f);
}

// y of a frame goes where the part's y goes, x stays as near to the part's x as it can.
TEST_F(CagePoints, FramesFollowTheGradient) {
  const CagedAsset asset(test::hollowBlock(), 8, Bend::kShear);
  for (const NamedMap& moved : smoothMaps(asset.volume.size)) {
    SCOPED_TRACE(moved.name);
    Pose pose = asset.pose();
    moveNodes(asset, moved.map, pose);
    Instance instance = asset.instance(pose);
    instance.to_world[0][0] = -1;
    for (int i = 0; i < 300; ++i) {
      const glm::dvec3 rest =
          glm::dvec3(1.3) * glm::dvec3(asset.volume.size) * (glm::dvec3{unit(), unit(), unit()} - 0.12);
      const glm::mat4 frame = frameAt(instance, 0, asset.toObject(glm::vec3(rest))).value();
      const glm::mat3 to_world(partToWorld(instance, 0).value());
      const auto along = [&](const glm::dvec3& axis) {
        return glm::normalize(to_world *
                              glm::vec3(moved.map(rest + 1e-3 * axis) - moved.map(rest - 1e-3 * axis)));
      };
      const glm::vec3 x = along({1, 0, 0}), y = along({0, 1, 0});
      const float near = moved.strays < 0.1 ? 1e-3f : 0.4f;
      EXPECT_LT(glm::distance(glm::vec3(frame[1]), y), near);
      EXPECT_LT(glm::distance(glm::vec3(frame[0]), glm::normalize(x - glm::dot(x, y) * y)), near);
      EXPECT_NEAR(glm::determinant(glm::mat3(frame)), 1, 1e-4);
      EXPECT_LT(
          glm::distance(glm::vec3(frame[3]), toWorld(instance, 0, asset.toObject(glm::vec3(rest))).value()),
          1e-6f);
    }
  }
}

// Nothing crashes or hangs, whatever nodes and points are.
TEST_F(CagePoints, AwkwardPosesAndPoints) {
  const CagedAsset asset(test::hollowBlock(), 8, Bend::kSweep);
  Pose pose = asset.pose();
  const Instance instance = asset.instance(pose);
  const float nothing[] = {NAN, INFINITY, -INFINITY};
  for (const float bad : nothing) {
    EXPECT_EQ(toWorld(instance, 0, {0, bad, 0}).error().code, ErrorCode::kMisuse);
    EXPECT_EQ(frameAt(instance, 0, {bad, 0, 0}).error().code, ErrorCode::kMisuse);
    EXPECT_FALSE(toRest(instance, 0, {0, 0, bad}));
  }
  const auto place = [&](int how, const glm::vec3& at) {
    switch (how) {
      case 0:
        return glm::vec3(5);  // on one point
      case 1:
        return glm::vec3(at.x, 0, 0);  // on a line
      case 2:
        return glm::vec3(at.x, at.y, -at.z);  // mirrored
      case 3:
        return 1e6f * at;  // far apart
      default:
        return at + 30.0f * glm::vec3(glm::dvec3{unit(), unit(), unit()});
    }
  };
  for (int how = 0; how < 5; ++how) {
    const Cage& cage = asset.part().cages[0];
    const std::span<glm::vec3> nodes = pose.nodes(0);
    for (std::uint32_t n = 0; n < cage.nodes(); ++n) nodes[n] = place(how, glm::vec3(cage.rest(n)));
    for (int i = 0; i < 300; ++i) {
      const glm::vec3 at = asset.toObject(glm::vec3(150 * unit() - 40, 150 * unit() - 40, 150 * unit() - 40));
      EXPECT_TRUE(toWorld(instance, 0, at));
      EXPECT_NEAR(glm::determinant(glm::mat3(frameAt(instance, 0, at).value())), 1, 1e-3);
      EXPECT_EQ(toRest(instance, 0, at).has_value(), how > 2) << how;
    }
    EXPECT_TRUE(toWorld(instance, 0, glm::vec3(1e30f)));
    EXPECT_TRUE(toWorld(instance, 0, glm::vec3(-1e30f)));
    toRest(instance, 0, glm::vec3(1e30f));
  }
  pose.nodes(0)[3].x = NAN;
  const glm::vec3 at = asset.toObject({5, 6, 7});
  EXPECT_FALSE(toRest(instance, 0, at));
  EXPECT_TRUE(toWorld(instance, 0, at));
}

}  // namespace
}  // namespace kelp::runtime
