// SPDX-License-Identifier: MIT
// raycast() of parts with cages against a brute force in double precision: every tetrahedron of every cell
// that is not inverted, and every voxel in it.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "caged.h"

namespace kelp::runtime {
namespace {

// A range of s on a ray.
struct Range {
  double from = 0, to = std::numeric_limits<double>::infinity();
  // Where f + s slope >= 0.
  void clip(double f, double slope) {
    if (slope > 0) from = std::max(from, -f / slope);
    if (slope < 0) to = std::min(to, -f / slope);
    if (slope == 0 && f < 0) to = -1;
  }
  bool empty() const { return !(from <= to); }
};

class BruteCage {
 public:
  // Voxels of a level in the cage of this level, or of a finer one.
  BruteCage(const CagedAsset& asset, int level, int cage)
      : asset_(asset),
        level_(level),
        cage_(asset.part().cages[static_cast<std::size_t>(cage)]),
        solid_(asset.volume) {
    for (int l = 0; l < level; ++l) solid_ = fields::coarser(solid_);
    for (std::uint32_t i = 0; i < cage_.cells(); ++i) voxels_.push_back(voxelsOf(i));
  }

  struct Touch {
    double s = std::numeric_limits<double>::infinity();
    glm::ivec3 voxel{-1};
    glm::dvec3 rest{0};
    bool found() const { return std::isfinite(s); }
  };
  // The first solid along o + s r from outside, part space; voxels and tetrahedra are taken that much larger,
  // voxels by negative numbers smaller.
  Touch first(std::span<const glm::vec3> nodes, const glm::dvec3& o, const glm::dvec3& r,
              double larger) const {
    Touch first;
    for (std::uint32_t i = 0; i < cage_.cells(); ++i)
      for (const CageTetrahedron& t : kCageTetrahedra) tryTetrahedron(nodes, i, t, o, r, larger, first);
    return first;
  }
  bool isSolid(const glm::ivec3& voxel) const {
    return glm::all(glm::greaterThanEqual(voxel, glm::ivec3(0))) &&
           glm::all(glm::lessThan(voxel, solid_.size)) && solid_.solid[solid_.index(voxel)] != 0;
  }

 private:
  // Of the level, that belong to the cell's piece.
  std::vector<glm::ivec3> voxelsOf(std::uint32_t cell) const {
    std::vector<glm::ivec3> voxels;
    const int side = cage_.side >> level_;
    const std::uint32_t mask = cage_.cell(cell)[1] == 0 ? 0 : cage_.maskAt(cell, level_);
    for (int i = 0; i < side * side * side; ++i) {
      const glm::ivec3 voxel =
          side * cage_.place(cell) + glm::ivec3(i % side, i / side % side, i / side / side);
      const bool is_piece =
          mask == 0 || (cage_.words[mask + static_cast<std::uint32_t>(i / 32)] >> (i % 32) & 1) != 0;
      if (is_piece && isSolid(voxel)) voxels.push_back(voxel);
    }
    return voxels;
  }

  void tryTetrahedron(std::span<const glm::vec3> nodes, std::uint32_t number, const CageTetrahedron& t,
                      const glm::dvec3& o, const glm::dvec3& r, double larger, Touch& first) const {
    const std::uint32_t* const cell = cage_.cell(number);
    glm::dvec3 now[4], rest[4];
    for (int k = 0; k < 4; ++k) {
      const int c = t.corners[k];
      now[k] = nodes[cageNode(cell, c)];
      rest[k] = double(cage_.side) * glm::dvec3(cage_.place(number) + glm::ivec3(c & 1, c >> 1 & 1, c >> 2));
    }
    const glm::dmat3 edges(now[1] - now[0], now[2] - now[0], now[3] - now[0]);
    const glm::dmat3 at_rest(rest[1] - rest[0], rest[2] - rest[0], rest[3] - rest[0]);
    if (!(glm::determinant(edges) * glm::determinant(at_rest) > 0)) return;
    const glm::dmat3 inverse = glm::inverse(edges);
    const glm::dvec3 f = inverse * (o - now[0]), df = inverse * r;
    Range in;
    // Shares of the corners 1, 2, 3 and 0. A ray in a face belongs to both sides.
    const double slack = std::max(larger / cage_.side, 1e-9);
    for (int k = 0; k < 3; ++k) in.clip(f[k] + slack, df[k]);
    in.clip(1 + slack - f.x - f.y - f.z, -df.x - df.y - df.z);
    if (in.empty() || in.from > first.s) return;
    const glm::dvec3 q = rest[0] + at_rest * f, dq = at_rest * df;
    for (const glm::ivec3& voxel : voxels_[number]) {
      Range range = in;
      const double size = 1 << level_;
      for (int axis = 0; axis < 3; ++axis) {
        range.clip(q[axis] - voxel[axis] * size + larger, dq[axis]);
        range.clip((voxel[axis] + 1) * size + larger - q[axis], -dq[axis]);
      }
      for (int axis = 0; axis < 3; ++axis) range.clip(asset_.volume.size[axis] + larger - q[axis], -dq[axis]);
      if (range.empty() || range.from >= first.s) continue;
      first = {range.from, voxel, q + range.from * dq};
    }
    // Into the inside, by a face of the cell. All around it is solid.
    const glm::dvec3 out = (q + in.to * dq) / double(cage_.side) - glm::dvec3(cage_.place(number));
    for (const int face : {2 * t.axes[0] + 1, 2 * t.axes[2]}) {
      if (cell[6 + face] != kCageInside || in.to >= first.s) continue;
      if (std::abs(out[face / 2] - face % 2) < 1e-6) first = {in.to, glm::ivec3(-1), q + in.to * dq};
    }
  }

  const CagedAsset& asset_;
  int level_;
  const Cage& cage_;
  fields::Occupancy solid_;  // of the level
  std::vector<std::vector<glm::ivec3>> voxels_;
};

struct Judged {
  int rays = 0, hits = 0, missed = 0, false_hits = 0;
  int elsewhere = 0;  // at another point of the model: where parts of it lie in one another
};

// Rays from all around at one part in a turned and scaled world.
Judged judge(const CagedAsset& asset, const Pose& pose, int level, int rays, unsigned seed) {
  const BruteCage truth(asset, level, level);
  const PosedCage posed = asset.posed(pose, level);
  Instance instance = asset.instance(pose);
  instance.to_world =
      glm::mat4(glm::vec4(0, 0, 2, 0), glm::vec4(0, 2, 0, 0), glm::vec4(2, 0, 0, 0), glm::vec4(3, -2, 1, 1));
  const glm::dmat4 to_world(partToWorld(instance, 0).value()), to_part = glm::inverse(to_world);
  std::mt19937 random(seed);
  const auto unit = [&] { return static_cast<double>(random()) / 4294967296.0; };
  Judged judged;
  for (; judged.rays < rays; ++judged.rays) {
    const glm::dvec3 share{unit(), unit(), unit()}, way{unit() - 0.5, unit() - 0.5, unit() - 0.5};
    const glm::dvec3 target = glm::mix(glm::dvec3(posed.bounds.min), glm::dvec3(posed.bounds.max), share);
    const glm::dvec3 from = target - 400.0 * glm::normalize(way);
    Ray ray;
    ray.origin = glm::vec3(to_world * glm::dvec4(from, 1));
    ray.direction = 0.01f * glm::vec3(to_world * glm::dvec4(way, 0));
    const glm::dvec3 o(to_part * glm::dvec4(ray.origin, 1)), d(to_part * glm::dvec4(ray.direction, 0));
    const double length = glm::length(d);
    const BruteCage::Touch certain = truth.first(posed.nodes, o, d / length, -0.01);
    const BruteCage::Touch possible = truth.first(posed.nodes, o, d / length, 0.01);
    const auto hit = raycast(instance, ray, level);
    if (certain.found() && !(hit && double{hit->t} * length <= certain.s + 0.03)) ++judged.missed;
    if (!hit) continue;
    ++judged.hits;
    if (!(possible.found() && double{hit->t} * length >= possible.s - 0.03)) ++judged.false_hits;
    EXPECT_TRUE(truth.isSolid(hit->voxel));
    EXPECT_EQ(hit->level, level);
    EXPECT_EQ(hit->part, 0);
    EXPECT_NEAR(glm::length(hit->normal), 1.0f, 1e-4f);
    if (std::abs(possible.s - double{hit->t} * length) < 0.05)
      judged.elsewhere += glm::distance(asset.toObject(glm::vec3(possible.rest)), hit->rest) >
                          0.5f * asset.part().to_object[1].y;
    Ray shorter = ray;
    shorter.t_max = 0.999f * hit->t;
    const auto none = raycast(instance, shorter, level);
    EXPECT_FALSE(none && none->t > shorter.t_max);
  }
  return judged;
}

TEST(CageRaycast, IsExactInEveryPose) {
  for (const Bend bend : {Bend::kShear, Bend::kSweep}) {
    for (const int cell : {4, 8}) {
      const CagedAsset asset(twoLegs({43, 60, 38}), cell, bend);
      for (const int how : {0, 1, 2, 3}) {
        Pose pose = asset.pose();
        if (how > 0) pose.setKnots(0, leaning()).value();
        if (how > 1) shakeNodes(pose.nodes(0), (how == 2 ? 0.15f : 0.5f) * static_cast<float>(cell), 7);
        for (int level = 0; level < asset.part().levels; ++level) {
          const Judged judged = judge(asset, pose, level, 400, static_cast<unsigned>(10 * how + level));
          EXPECT_EQ(judged.missed, 0) << cell << " " << how << " " << level;
          EXPECT_EQ(judged.false_hits, 0) << cell << " " << how << " " << level;
          EXPECT_LE(judged.elsewhere, how < 2 ? 0 : judged.hits / 20);
          EXPECT_GT(judged.hits, 40);
        }
      }
    }
  }
}

// A plain ball: the normal of the hit is that of the map, and the material is the voxel's.
TEST(CageRaycast, NormalsFollowTheNodes) {
  fields::Occupancy ball{glm::ivec3(40), std::vector<std::uint8_t>(64000)};
  for (int i = 0; i < 64000; ++i) {
    const glm::ivec3 v(i % 40, i / 40 % 40, i / 1600);
    ball.solid[ball.index(v)] = glm::distance(glm::vec3(v) + 0.5f, glm::vec3(20)) < 19;
  }
  const CagedAsset asset(ball, 8, Bend::kSweep);
  const PlainTwin plain(ball, Bend::kSweep, straight({0, 0.5f, 1}), straight({0, 0.5f, 1}));
  Pose pose = asset.pose();
  // Twice as wide, half as high.
  for (glm::vec3& node : pose.nodes(0)) node *= glm::vec3(2, 0.5f, 1);
  const Instance caged = asset.instance(pose), at_rest = plain.instance();
  int seen = 0;
  for (int i = 0; i < 400; ++i) {
    // Not between voxels.
    const float x = -0.487f + static_cast<float>(i % 20) / 20, y = 0.009f + static_cast<float>(i / 20) / 20;
    const auto hit = raycast(at_rest, {{x, y, 3}, {0, 0, -1}});
    const glm::vec3 voxels = glm::vec3(40 * x + 20, 40 * y, 0) * glm::vec3(2, 0.5f, 1);
    const glm::vec3 from = asset.toObject(voxels);
    const auto bent = raycast(caged, {{from.x, from.y, 3}, {0, 0, -1}});
    ASSERT_EQ(hit.has_value(), bent.has_value()) << i;
    if (!hit) continue;
    ++seen;
    EXPECT_NEAR(hit->t, bent->t, 0.01f / 40);  // a hundredth of a voxel
    EXPECT_LT(glm::distance(hit->rest, bent->rest), 0.01f / 40);
    EXPECT_EQ(hit->voxel, bent->voxel);
    EXPECT_EQ(hit->material, bent->material);
    const glm::vec3 turned = glm::normalize(hit->normal / glm::vec3(2, 0.5f, 1));
    EXPECT_LT(glm::distance(bent->normal, turned), 1e-3f);
  }
  EXPECT_GT(seen, 150);
}

// Rays that begin in the solid hit at once, in cells and where there are none.
TEST(CageRaycast, RaysFromWithinHitAtOnce) {
  fields::Occupancy block{glm::ivec3(48), std::vector<std::uint8_t>(48 * 48 * 48, 1)};
  const CagedAsset asset(block, 8, Bend::kSweep);
  Pose pose = asset.pose();
  pose.setKnots(0, std::vector<Knot>{{0, {0, 0, 0}, {0, 1, 0}},
                                     {0.5f, {0.01f, 0.5f, 0}, {0.04f, 1, 0}},
                                     {1, {0.04f, 1.1f, 0.02f}, {0.1f, 1.2f, 0.06f}}})
      .value();
  ASSERT_TRUE(pose.check());
  ASSERT_EQ(asset.part().cages[0].cells(), 6u * 6 * 6 - 4 * 4 * 4);
  const Instance instance = asset.instance(pose);
  std::mt19937 random(3);
  const auto unit = [&] { return static_cast<float>(random()) / 4294967296.0f; };
  for (int i = 0; i < 500; ++i) {
    const glm::vec3 rest{1 + 46 * unit(), 1 + 46 * unit(), 1 + 46 * unit()};
    const glm::vec3 from = toWorld(instance, 0, asset.toObject(rest)).value();
    const glm::vec3 way{unit() - 0.5f, unit() - 0.5f, unit() - 0.5f};
    const auto hit = raycast(instance, {from, way});
    EXPECT_TRUE(hit) << rest.x << ' ' << rest.y << ' ' << rest.z;
    EXPECT_EQ(hit ? hit->t : -1, 0);
  }
}

// A fold keeps no ray from hitting at once but those that may meet it; none hits at once from a hollow.
TEST(CageRaycast, RaysFromWithinWithAFoldElsewhere) {
  fields::Occupancy block{glm::ivec3(64), std::vector<std::uint8_t>(64 * 64 * 64, 1)};
  for (int i = 0; i < 16 * 16 * 16; ++i)
    block.solid[block.index(glm::ivec3(i % 16, i / 16 % 16, i / 256) + 40)] = 0;
  const CagedAsset asset(block, 8, Bend::kSweep);
  Pose pose = asset.pose();
  pose.nodes(0)[0] = glm::vec3(12);
  const PosedCage posed = asset.posed(pose);
  ASSERT_GT(posed.inverted_count, 0u);
  ASSERT_LE(posed.inverted.max.x, 12);
  const Instance instance = asset.instance(pose);
  std::mt19937 random(5);
  const auto unit = [&] { return static_cast<float>(random()) / 4294967296.0f; };
  int away = 0, in_hollow = 0;
  for (int i = 0; i < 1500; ++i) {
    const glm::vec3 from{12.5f + 51 * unit(), 12.5f + 51 * unit(), 12.5f + 51 * unit()};
    const glm::vec3 way{unit() - 0.5f, unit() - 0.5f, unit() - 0.5f};
    const bool solid = block.solid[block.index(glm::ivec3(from))] != 0;
    const auto hit = raycast(instance, {asset.toObject(from), way});
    const bool at_once = hit && hit->t == 0;
    const bool may_meet = way.x < 0 && way.y < 0 && way.z < 0;
    in_hollow += !solid;
    away += solid && !may_meet;
    EXPECT_FALSE(at_once && !solid) << i;
    EXPECT_TRUE(at_once || !solid || may_meet) << i;
  }
  EXPECT_GT(in_hollow, 20);
  EXPECT_GT(away, 1000);
}

// Plates of which each cell holds pieces: where bricks are missing, coarser ones of the same piece are hit.
TEST(CageRaycast, PiecesWithMissingBricks) {
  fields::Occupancy plates{glm::ivec3(80, 96, 72), std::vector<std::uint8_t>(80 * 96 * 72)};
  for (int i = 0; i < 80 * 96 * 72; ++i) {
    const glm::ivec3 v(i % 80, i / 80 % 96, i / 80 / 96);
    plates.solid[plates.index(v)] = v.x % 6 < 2 && v.z % 36 > 3;
  }
  const CagedAsset whole(plates, 8, Bend::kSweep);
  ASSERT_EQ(whole.part().cages[0].last_level, 1);
  Pose pose = whole.pose();
  shakeNodes(pose.nodes(0), 1, 4);
  const PosedCage posed = whole.posed(pose);
  const BruteCage fine(whole, 0, 0), coarse(whole, 1, 0);
  const std::unique_ptr<Asset> asset = Asset::open(whole.loaded.source.source()).value();
  const Instance instance{asset.get(), &pose};
  std::mt19937 random(6);
  const auto unit = [&] { return static_cast<double>(random()) / 4294967296.0; };
  const double scale = double{whole.part().to_object[1].y};
  int hits[2] = {}, mixed = 0;
  for (bool more = true; more;) {
    more = asset->pump().value();
    if (asset->residentLevel(0, 1).value_or(9) > 1) continue;  // the coarser cage is still in use
    int seen[2] = {};
    for (int i = 0; i < 12; ++i) {
      const glm::dvec3 r = glm::normalize(glm::dvec3(unit() - 0.5, unit() - 0.5, 2 * unit() - 1));
      const glm::dvec3 o = glm::dvec3(80, 96, 72) * glm::dvec3(unit(), unit(), unit()) - 200.0 * r;
      const auto hit = raycast(instance, {whole.toObject(glm::vec3(o)), glm::vec3(scale * r)});
      if (!hit || hit->level > 1) continue;
      ++seen[hit->level];
      const BruteCage& level = hit->level == 0 ? fine : coarse;
      EXPECT_TRUE(level.isSolid(hit->voxel));
      EXPECT_GE(double{hit->t}, coarse.first(posed.nodes, o, r, 0.01).s - 0.03);
      EXPECT_LE(double{hit->t}, fine.first(posed.nodes, o, r, -0.01).s + 0.03);
    }
    mixed += seen[0] > 0 && seen[1] > 0;
    for (const int level : {0, 1}) hits[level] += seen[level];
  }
  EXPECT_GT(mixed, 0);
  EXPECT_GT(hits[0], 5);
  EXPECT_GT(hits[1], 5);
}

// Each level is traced in its own cage, and falls back to coarser cages only as a whole.
TEST(CageRaycast, ComesWithTheLevelsThatAreThere) {
  const fields::Occupancy volume = twoLegs({90, 120, 80});
  const std::vector<std::byte> bytes =
      test::bytesOf(CagedAsset::packOf(volume, 4, Bend::kSweep, straight({0, 1})));
  const MemorySource source(bytes);
  const std::unique_ptr<Asset> asset = Asset::open(source.source()).value();
  const Ray ray{{0, 0.1f, 3}, {0, 0, -1}};
  const Instance instance{asset.get()};
  const Part& part = asset->pack().parts()[0];
  std::set<int> levels;
  EXPECT_FALSE(raycast(instance, ray));
  for (bool more = true; more;) {
    more = asset->pump().value();
    const auto hit = raycast(instance, ray);
    if (!hit) continue;
    levels.insert(hit->level);
    const Cage& cage = part.cages[static_cast<std::size_t>(hit->level)];
    EXPECT_LE(asset->residentLevel(0, cage.last_level).value(), cage.last_level);
    const auto deepest = raycast(instance, ray, part.levels - 1);
    EXPECT_EQ(deepest->level, part.levels - 1);
  }
  EXPECT_EQ(raycast(instance, ray)->level, 0);
  EXPECT_GE(levels.size(), 3u);
}

// The finest level that rays from all sides hit once everything that they ask for is there.
int levelWithin(const RawPack& pack, double share) {
  const Loaded whole(pack);
  AssetOptions options;
  options.memory_budget = static_cast<std::uint64_t>(share * static_cast<double>(whole.asset->memory()));
  const std::unique_ptr<Asset> asset = Asset::open(whole.source.source(), options).value();
  const Pose pose = Pose::create(*asset).value();
  const Instance instance{asset.get(), &pose};
  int finest = kMaxLevels;
  for (int round = 0; round < 60; ++round) {
    finest = kMaxLevels;
    for (int i = 0; i < 200; ++i) {
      const float angle = 0.1f * static_cast<float>(i);
      const glm::vec3 from{3 * std::sin(angle), 0.005f * static_cast<float>(i), 3 * std::cos(angle)};
      const auto hit = raycast(instance, {from, glm::vec3(0, from.y, 0) - from});
      if (hit) finest = std::min(finest, hit->level);
    }
    while (asset->pump().value()) {
    }
    EXPECT_LE(asset->memory(), options.memory_budget);
  }
  return finest;
}

TEST(CageRaycast, CagesDoNotCostALevelOfABudget) {
  const RawPack caged =
      CagedAsset::packOf(test::ballClump({150, 190, 150}, 12, 3), 8, Bend::kSweep, straight({0, 1}));
  RawPack plain = caged;
  plain.parts[0].cages.clear();
  plain.parts[0].cell = 0;
  for (const double share : {0.1, 0.15, 0.3, 0.6, 1.1}) {
    const int without = levelWithin(plain, share), with = levelWithin(caged, share);
    EXPECT_LE(with, without + 1) << share;
    EXPECT_TRUE(with == 0 || share < 1);
  }
}

TEST(CageRaycast, BoundsHoldTheHits) {
  const CagedAsset asset(twoLegs({43, 60, 38}), 8, Bend::kShear);
  Pose pose = asset.pose();
  for (glm::vec3& node : pose.nodes(0)) node = glm::vec3(3, -1, 2) * node + glm::vec3(500, 0, 0);
  const Instance instance = asset.instance(pose);
  EXPECT_FALSE(bounds(instance).empty());
  for (glm::vec3& node : pose.nodes(0)) node.y = -node.y;
  const Box box = bounds(instance);
  const PosedCage posed = asset.posed(pose);
  EXPECT_LT(glm::distance(box.min, asset.toObject(posed.bounds.min)), 1e-4f);
  EXPECT_LT(glm::distance(box.max, asset.toObject(posed.bounds.max)), 1e-4f);
  EXPECT_GT(box.min.x, 5);
  const glm::vec3 middle = 0.5f * (box.min + box.max);
  int hits = 0;
  for (int i = 0; i < 200; ++i) {
    const auto hit = raycast(
        instance, {{glm::mix(box.min.x, box.max.x, static_cast<float>(i) / 200), middle.y, 9}, {0, 0, -1}});
    if (!hit) continue;
    ++hits;
    EXPECT_GT(hit->position.z, box.min.z - 1e-4f);
    EXPECT_LT(hit->position.z, box.max.z + 1e-4f);
  }
  EXPECT_GT(hits, 20);
}

}  // namespace
}  // namespace kelp::runtime
