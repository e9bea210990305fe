// SPDX-License-Identifier: MIT
// Nodes of cages in poses, and the boxes that posedCage() makes of them.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <thread>
#include <utility>

#include "caged.h"
#include "kelp/runtime/distance.h"
#include "kelp/runtime/spring.h"
#include "support/short_memory.h"

namespace kelp::runtime {
namespace {

constexpr float kNoNumber = std::numeric_limits<float>::quiet_NaN(),
                kEndless = std::numeric_limits<float>::infinity();

std::vector<glm::vec3> copyOf(std::span<const glm::vec3> nodes) { return {nodes.begin(), nodes.end()}; }
std::vector<glm::vec3> readNodes(const Pose& pose) { return copyOf(pose.nodes(0)); }

TEST(CagePose, AtRestNodesAreTheLattice) {
  for (const Bend bend : {Bend::kShear, Bend::kSweep}) {
    for (const int cell : {2, 4, 8, 16}) {
      const CagedAsset asset(twoLegs({27, 60, 30}), cell, bend, straight({0, 0.3f, 1}));
      const Pose pose = asset.pose();
      ASSERT_EQ(pose.nodes(0).size(), asset.part().cages[0].nodes());
      for (std::size_t c = 0; c < asset.part().cages.size(); ++c) {
        const Cage& cage = asset.part().cages[c];
        const auto number = static_cast<int>(c);
        const Instance at_rest{&*asset};
        for (const PosedCage& posed : {asset.posed(pose, number), posedCage(at_rest, 0, number).value()}) {
          ASSERT_EQ(posed.nodes.size(), cage.nodes());
          for (std::uint32_t i = 0; i < cage.nodes(); ++i)
            ASSERT_EQ(posed.nodes[i], glm::vec3(cage.rest(i))) << cell << " " << i;
          EXPECT_EQ(posed.inverted_count, 0u);
          EXPECT_TRUE(posed.inverted.empty());
        }
      }
    }
  }
}

TEST(CagePose, NodesFollowTheSpline) {
  for (const Bend bend : {Bend::kShear, Bend::kSweep}) {
    const CagedAsset asset(twoLegs({27, 60, 30}), 4, bend);
    Pose pose = asset.pose();
    ASSERT_TRUE(pose.setKnots(0, leaning()));
    PlainTwin plain(asset.volume, bend, straight({0, 0.5f, 1}), leaning());
    Motion& kept = *pose.motion(0);
    for (const float roll : {0.0f, 0.7f, -2.0f}) {
      kept.roll = plain.pose.motion(0)->roll = roll;  // nobody tells the pose
      const PosedCage posed = asset.posed(pose);
      int inside = 0;
      glm::vec3 most(0);
      for (std::uint32_t i = 0; i < posed.nodes.size(); ++i) {
        const glm::vec3 rest(asset.part().cages[0].rest(i));
        if (rest.y > static_cast<float>(asset.part().size.y)) continue;
        const glm::vec3 there = toWorld(plain.instance(), 0, asset.toObject(rest)).value();
        most = glm::max(most, glm::abs(asset.toObject(posed.nodes[i]) - there) / asset.part().to_object[1].y);
        ++inside;
      }
      EXPECT_GT(inside, 100);
      EXPECT_LT(std::max({most.x, most.y, most.z}), 1e-3f) << roll;
    }
  }
}

// Results for one roll are not used for another.
TEST(CagePose, RollsThereAndBack) {
  const CagedAsset asset(twoLegs({27, 60, 30}), 4, Bend::kSweep);
  Pose pose = asset.pose(), fresh = asset.pose();
  for (const int cage : {0, 1}) {
    const PosedCage want = asset.posed(fresh, cage);
    pose.motion(0)->roll = 0;
    asset.posed(pose, cage);
    pose.motion(0)->roll = 1;
    readNodes(pose);
    pose.motion(0)->roll = 0;
    const PosedCage posed = asset.posed(pose, cage);
    EXPECT_EQ(copyOf(posed.nodes), copyOf(want.nodes));
    EXPECT_EQ(posed.bounds.min, want.bounds.min);
    pose.motion(0)->roll = 1;
    readNodes(pose);
    EXPECT_NE(copyOf(asset.posed(pose, cage).nodes), copyOf(want.nodes));
    EXPECT_NE(asset.posed(pose, cage).bounds.min, want.bounds.min);
  }
}

// A block on a circle around which nothing of it folds, though cells reach beyond its center.
TEST(CagePose, CellsBesideThePartDoNotFold) {
  const glm::ivec3 size(33, 100, 33);
  const fields::Occupancy block{size, std::vector<std::uint8_t>(33 * 100 * 33, 1)};
  const CagedAsset asset(block, 8, Bend::kSweep, straight({0, 0.2f, 0.4f, 0.6f, 0.8f, 1}));
  Pose pose = asset.pose();
  std::vector<Knot> knots;
  const float radius = 0.222f;
  for (const float at : {0.0f, 0.2f, 0.4f, 0.6f, 0.8f, 1.0f}) {
    const float angle = at / radius;
    knots.push_back({at,
                     {radius * (1 - std::cos(angle)), radius * std::sin(angle), 0},
                     {std::sin(angle), std::cos(angle), 0}});
  }
  ASSERT_TRUE(pose.setKnots(0, knots));
  ASSERT_TRUE(pose.check());
  const Instance instance = asset.instance(pose);
  EXPECT_EQ(asset.posed(pose).inverted_count, 0u);
  for (int i = 0; i < 200; ++i) {
    const glm::vec3 rest(10 + i % 14, 15 + 7 * (i % 10), 10 + i / 14);
    const glm::vec3 from = toWorld(instance, 0, asset.toObject(rest)).value();
    const auto hit = raycast(instance, {from, {0.3f, -0.2f, 0.1f * static_cast<float>(i % 7) - 0.3f}});
    EXPECT_TRUE(hit && hit->t == 0) << i;
  }
}

// The top of the lattice is above the part: voxels between must not be where a kink would put them.
TEST(CagePose, AboveThePartTheMapGoesOnStraight) {
  for (const Bend bend : {Bend::kShear, Bend::kSweep}) {
    const CagedAsset asset(twoLegs({27, 59, 30}), 8, bend);
    const Cage& cage = asset.part().cages[0];
    Pose pose = asset.pose();
    ASSERT_TRUE(pose.setKnots(0, leaning()));
    const PlainTwin plain(asset.volume, bend, straight({0, 0.5f, 1}), leaning());
    const std::span<const glm::vec3> nodes = asset.posed(pose).nodes;
    int seen = 0;
    for (std::uint32_t i = 0; i < cage.cells(); ++i) {
      if (8 * cage.place(i).y != 56) continue;
      ++seen;
      const glm::vec3 at = glm::mix(nodes[cage.node(i, 0)], nodes[cage.node(i, 2)], 3.0f / 8);
      const glm::vec3 rest = glm::vec3(8 * cage.place(i)) + glm::vec3(0, 3, 0);
      const glm::vec3 there = toWorld(plain.instance(), 0, asset.toObject(rest)).value();
      EXPECT_LT(glm::distance(asset.toObject(at), there) / asset.part().to_object[1].y,
                bend == Bend::kShear ? 1e-3f : 0.5f);
    }
    EXPECT_GT(seen, 0);
  }
}

TEST(CagePose, EveryChangeOfTheKnotsMovesNodes) {
  const CagedAsset asset(twoLegs({27, 60, 30}), 8, Bend::kSweep);
  Pose pose = asset.pose(), bent = asset.pose();
  ASSERT_TRUE(bent.setKnots(0, leaning()));
  Spring spring = Spring::create(*asset).value();
  spring.push(0, {2, 0, 0}).value();
  spring.step(0.1f).value();
  const std::vector<glm::vec3> rest = readNodes(pose);
  const auto moves = [&](const char* name, const auto& change) {
    pose.reset();
    EXPECT_EQ(readNodes(pose), rest) << name;
    const std::vector<glm::vec3> before = copyOf(asset.posed(pose, 1).nodes);
    change();
    EXPECT_NE(readNodes(pose), rest) << name;
    EXPECT_NE(copyOf(asset.posed(pose, 1).nodes), before) << name;
  };
  moves("move", [&] { pose.move(0, 2, {0.1f, 0, 0}).value(); });
  moves("setTangent", [&] { pose.setTangent(0, 1, {0.3f, 1, 0}).value(); });
  moves("setKnots", [&] { pose.setKnots(0, leaning()).value(); });
  moves("assign", [&] { pose.assign(bent).value(); });
  moves("blend", [&] { pose.blend(bent, 0.5f).value(); });
  moves("spring", [&] { spring.addTo(pose).value(); });
  moves("clamp", [&] {
    pose.setKnots(0, std::vector<Knot>{{0, {0, 0, 0}, {0, 1, 0}},
                                       {0.5f, {0, 0.1f, 0}, {1, 0, 0}},
                                       {1, {0.1f, 0, 0}, {0, -1, 0}}})
        .value();
    ASSERT_FALSE(pose.check());
    EXPECT_FALSE(posedCage(asset.instance(pose), 0, 1));
    EXPECT_EQ(readNodes(pose), rest) << "it takes no point anywhere";
    pose.clamp();
  });
}

TEST(CagePose, WrittenNodesStayUntilReset) {
  const CagedAsset asset(twoLegs({27, 60, 30}), 8, Bend::kSweep);
  Pose pose = asset.pose();
  ASSERT_TRUE(pose.setKnots(0, leaning()));
  const std::vector<glm::vec3> bent = readNodes(pose);
  const std::span<glm::vec3> nodes = pose.nodes(0);
  EXPECT_EQ(copyOf(nodes), bent) << "the first call fills them in";
  shakeNodes(nodes, 3, 1);
  const std::vector<glm::vec3> shaken = copyOf(nodes);
  pose.move(0, 2, {0.2f, 0, 0}).value();
  pose.motion(0)->roll = 1;
  EXPECT_EQ(copyOf(asset.posed(pose).nodes), shaken);
  const std::vector<glm::vec3> coarse = copyOf(asset.posed(pose, 1).nodes);
  ASSERT_EQ(pose.nodes(0).data(), nodes.data());
  nodes[0] += 5.0f;
  for (glm::vec3& node : nodes) node.x += 2;
  EXPECT_EQ(asset.posed(pose).nodes[0], shaken[0] + glm::vec3(7, 5, 5));
  EXPECT_NE(copyOf(asset.posed(pose, 1).nodes), coarse);
  pose.reset();
  for (std::uint32_t i = 0; i < nodes.size(); ++i)
    ASSERT_EQ(asset.posed(pose).nodes[i], glm::vec3(asset.part().cages[0].rest(i)));
  EXPECT_TRUE(pose.nodes(1).empty());
  EXPECT_TRUE(pose.nodes(-1).empty());
  EXPECT_TRUE(std::as_const(pose).nodes(1).empty());
}

// Where an affine map takes the finest nodes, it takes those of the coarser cages.
TEST(CagePose, CoarserNodesFollow) {
  const CagedAsset asset(twoLegs({70, 90, 60}), 2, Bend::kShear);
  ASSERT_GE(asset.part().cages.size(), 4u);
  Pose pose = asset.pose();
  const glm::mat4x3 map({1.5f, 0.25f, 0}, {-0.5f, 1, 0.5f}, {0, 0.125f, -2}, {10, -20, 30});
  for (glm::vec3& node : pose.nodes(0)) node = map * glm::vec4(node, 1);
  for (std::size_t c = 0; c < asset.part().cages.size(); ++c) {
    const PosedCage posed = asset.posed(pose, static_cast<int>(c));
    for (std::uint32_t i = 0; i < posed.nodes.size(); ++i)
      ASSERT_LT(glm::distance(posed.nodes[i], map * glm::vec4(glm::vec3(posed.cage->rest(i)), 1)), 1e-3f);
    EXPECT_EQ(posed.inverted_count, 6 * posed.cage->cells()) << "mirrored";
  }
}

// Of a thin solid, coarse nodes are many finer cells beside it: errors of one tetrahedron must not grow
// there.
TEST(CagePose, CoarseNodesOfATwistedStickStayNearIt) {
  const glm::ivec3 size(100, 200, 100);
  fields::Occupancy stick{size, std::vector<std::uint8_t>(100 * 200 * 100)};
  for (int i = 0; i < 6 * 6 * 200; ++i) stick.solid[stick.index({47 + i % 6, i / 36, 47 + i / 6 % 6})] = 1;
  const CagedAsset asset(stick, 8, Bend::kSweep);
  ASSERT_GE(asset.part().cages.size(), 3u);
  Pose pose = asset.pose();
  for (glm::vec3& node : pose.nodes(0)) {
    const float angle = node.y / 200 * 6.2831853f, x = node.x - 50, z = node.z - 50;
    node.x = 50 + std::cos(angle) * x + std::sin(angle) * z;
    node.z = 50 - std::sin(angle) * x + std::cos(angle) * z;
  }
  for (std::size_t c = 1; c < asset.part().cages.size(); ++c) {
    const PosedCage posed = asset.posed(pose, static_cast<int>(c));
    double off = 0;
    for (std::uint32_t i = 0; i < posed.cage->cells(); ++i) {
      // The stick's axis, in the cell's middle, may move by what the cell cannot follow.
      const glm::vec3 low(posed.cage->side * posed.cage->place(i)),
          f = (glm::vec3(50, low.y, 50) - low) / static_cast<float>(posed.cage->side);
      glm::vec3 at(0);
      for (int k = 0; k < 8; ++k)
        at += ((k & 1) != 0 ? f.x : 1 - f.x) * ((k & 2) != 0 ? 0 : 1) * (k > 3 ? f.z : 1 - f.z) *
              posed.nodes[posed.cage->node(i, k)];
      off += glm::distance(at, glm::vec3(50, low.y, 50)) / posed.cage->cells();
    }
    EXPECT_LT(off, 0.25 * posed.cage->side) << c;
  }
}

TEST(CagePose, AssignAndBlend) {
  const CagedAsset asset(twoLegs({27, 60, 30}), 8, Bend::kSweep);
  Pose rest = asset.pose(), bent = asset.pose(), written = asset.pose(), pose = asset.pose();
  ASSERT_TRUE(bent.setKnots(0, leaning()));
  shakeNodes(written.nodes(0), 4, 2);
  const std::vector<glm::vec3> at_rest = readNodes(rest), on_spline = readNodes(bent),
                               shaken = readNodes(written);
  ASSERT_TRUE(pose.assign(written));
  EXPECT_EQ(readNodes(pose), shaken);
  pose.nodes(0)[0] += 1.0f;
  EXPECT_EQ(readNodes(written), shaken);
  ASSERT_TRUE(pose.assign(bent));
  EXPECT_EQ(readNodes(pose), on_spline);

  const auto expectMixed = [&](const Pose& from, const Pose& to, float weight) {
    const std::vector<glm::vec3> a = readNodes(from), b = readNodes(to);
    pose.assign(from).value();
    pose.blend(to, weight).value();
    const std::vector<glm::vec3> mixed = readNodes(pose);
    for (std::size_t i = 0; i < a.size(); ++i)
      ASSERT_LT(glm::distance(mixed[i], glm::mix(a[i], b[i], weight)), 1e-4f);
  };
  for (const float weight : {0.0f, 0.25f, 1.0f}) {
    expectMixed(bent, written, weight);
    expectMixed(written, bent, weight);
    expectMixed(written, written, weight);
  }
  ASSERT_TRUE(pose.assign(written));
  ASSERT_TRUE(pose.blend(bent, 1));
  pose.setKnots(0, rest.knots(0)).value();
  EXPECT_EQ(readNodes(pose), at_rest) << "weight 1 makes it the other, which follows its spline";
  ASSERT_TRUE(pose.assign(bent));
  const float none[] = {0};
  ASSERT_TRUE(pose.blend(written, 1, none));
  EXPECT_EQ(readNodes(pose), on_spline);
  // A blend of two that follow their splines follows its own.
  ASSERT_TRUE(pose.blend(rest, 0.5f));
  const std::vector<glm::vec3> between = readNodes(pose);
  ASSERT_TRUE(bent.setKnots(0, pose.knots(0)));
  EXPECT_EQ(between, readNodes(bent));
}

TEST(CagePose, PosesOfOtherCagesAreRefused) {
  const CagedAsset fine(twoLegs({27, 60, 30}), 4, Bend::kSweep),
      coarse(twoLegs({27, 60, 30}), 8, Bend::kSweep);
  RawPack plain = CagedAsset::packOf(twoLegs({27, 60, 30}), 8, Bend::kSweep, straight({0, 0.5f, 1}));
  plain.parts[0].cell = 0;
  plain.parts[0].cages.clear();
  const Loaded uncaged(plain);
  Pose a = fine.pose(), b = coarse.pose(), c = Pose::create(*uncaged.asset).value();
  EXPECT_TRUE(a.fits(*fine));
  for (Pose* const pose : {&a, &c}) {
    EXPECT_FALSE(pose->fits(*coarse));
    EXPECT_EQ(posedCage(coarse.instance(*pose), 0, 0).error().code, ErrorCode::kMisuse);
    EXPECT_FALSE(raycast(coarse.instance(*pose), {{0, 0.5f, 2}, {0, 0, -1}}));
    EXPECT_TRUE(bounds(coarse.instance(*pose)).empty());
    EXPECT_FALSE(pose->assign(b));
    EXPECT_FALSE(b.assign(*pose));
    EXPECT_FALSE(pose->blend(b, 0.5f));
  }
  EXPECT_FALSE(b.fits(*uncaged.asset));
  EXPECT_TRUE(c.nodes(0).empty());
  const Instance instance = coarse.instance(b);
  for (const int part : {-1, 1}) EXPECT_EQ(posedCage(instance, part, 0).error().code, ErrorCode::kMisuse);
  for (const int cage : {-1, 9}) EXPECT_EQ(posedCage(instance, 0, cage).error().code, ErrorCode::kMisuse);
}

TEST(CagePose, BadNodesAreNamed) {
  const CagedAsset asset(twoLegs({27, 60, 30}), 4, Bend::kShear);
  Pose pose = asset.pose();
  const float most = 0x1p20f * 60;
  const std::size_t last = asset.part().cages[0].nodes() - 1;
  for (const float bad : {kNoNumber, kEndless, -kEndless, 1.001f * most, -2 * most}) {
    for (const std::size_t node : {std::size_t{0}, std::size_t{7}, last}) {
      for (int axis = 0; axis < 3; ++axis) {
        pose.reset();
        std::span<glm::vec3> nodes = pose.nodes(0);
        nodes[node][axis] = bad;
        const Instance instance = asset.instance(pose);
        const Result<void> checked = pose.check();
        ASSERT_FALSE(checked);
        EXPECT_EQ(checked.error().code, ErrorCode::kMisuse);
        EXPECT_EQ(checked.error().unit, Error::Unit::kPart);
        EXPECT_EQ(checked.error().offset, 0u);
        for (const int cage : {1, 0, 0}) {
          const Result<PosedCage> posed = posedCage(instance, 0, cage);
          ASSERT_FALSE(posed);
          EXPECT_EQ(posed.error().code, ErrorCode::kMisuse);
          EXPECT_EQ(posed.error().unit, Error::Unit::kNode);
          EXPECT_EQ(posed.error().offset, node);
        }
        EXPECT_FALSE(raycast(instance, {{0, 0.5f, 2}, {0, 0, -1}}));
        EXPECT_TRUE(bounds(instance).empty());
        nodes = pose.nodes(0);
        nodes[node][axis] = std::copysign(most, bad);
        EXPECT_TRUE(pose.check()) << "that far is allowed";
        nodes = pose.nodes(0);
        nodes[node][axis] = bad;
        nodes[1].x = 3;
        pose.clamp();
        EXPECT_TRUE(pose.check());
        EXPECT_EQ(readNodes(pose)[node][axis],
                  static_cast<float>(asset.part().cages[0].rest(static_cast<std::uint32_t>(node))[axis]));
        EXPECT_EQ(readNodes(pose)[1].x, 3) << "a good one stays";
        EXPECT_TRUE(posedCage(instance, 0, 0));
      }
    }
  }
  // Its spline does not count as long as the nodes are the host's.
  pose.reset();
  pose.setTangent(0, 1, {0, -5, 0}).value();
  EXPECT_FALSE(pose.check());
  pose.nodes(0);
  EXPECT_TRUE(pose.check());
}

// No crash and no hang; a box holds every tetrahedron that is inverted.
TEST(CagePose, DegenerateNodes) {
  const CagedAsset asset(twoLegs({27, 60, 30}), 4, Bend::kSweep);
  Pose pose = asset.pose();
  const auto all = [&](const auto& place) {
    pose.reset();
    for (glm::vec3& node : pose.nodes(0)) node = place(node);
    const Instance instance = asset.instance(pose);
    ASSERT_TRUE(pose.check());
    for (std::size_t c = 0; c < asset.part().cages.size(); ++c) {
      const PosedCage posed = asset.posed(pose, static_cast<int>(c));
      EXPECT_EQ(posed.inverted_count, 6 * posed.cage->cells());
    }
    for (float x = -0.5f; x < 0.5f; x += 0.1f) {
      EXPECT_FALSE(raycast(instance, {{x, 0.5f, 2}, {0, 0, -1}}));
      EXPECT_FALSE(raycast(instance, {{x, 0.5f, 0}, {0, 1, 0}}));
    }
    pose.clamp();
    EXPECT_TRUE(pose.check());
  };
  all([](const glm::vec3&) { return glm::vec3(10, 20, 10); });
  all([](const glm::vec3& at) { return glm::vec3(10, at.y, 10); });
  all([](const glm::vec3& at) { return glm::vec3(at.x, 3, at.z); });
  all([](const glm::vec3& at) { return glm::vec3(27 - at.x, at.y, at.z); });
  pose.reset();
  unsigned i = 0;
  for (glm::vec3& node : pose.nodes(0)) node = 1e9f * glm::vec3(i % 2, i / 2 % 2, i / 4 % 2), ++i;
  EXPECT_FALSE(pose.check()) << "a billion is beyond 2^20 times 60";
  for (glm::vec3& node : pose.nodes(0)) node *= 0.06f;
  EXPECT_TRUE(pose.check());
  EXPECT_GT(asset.posed(pose).inverted_count, 0u);
  for (float x = -1; x < 1; x += 0.01f) raycast(asset.instance(pose), {{x, 0.5f, 2}, {0, 0, -1}});
}

// In double precision, all of them.
TEST(CagePose, BoxesHoldTheirCells) {
  for (const float far : {0.0f, 1.0f, 2.0f, 4.0f, 20.0f}) {
    const CagedAsset asset(twoLegs({61, 64, 42}), 4, Bend::kSweep);
    Pose pose = asset.pose();
    if (far > 0) shakeNodes(pose.nodes(0), far, 5);
    std::uint32_t inverted_in_all = 0;
    for (std::size_t c = 0; c < asset.part().cages.size(); ++c) {
      const PosedCage posed = asset.posed(pose, static_cast<int>(c));
      const Cage& cage = *posed.cage;
      ASSERT_EQ(posed.tree.size(), 2 * posed.leaves);
      ASSERT_EQ(cage.leaves.size(), posed.leaves * kLeafCells);
      const auto holds = [](const Box& box, const glm::vec3& p) {
        return glm::all(glm::lessThanEqual(box.min, p)) && glm::all(glm::lessThanEqual(p, box.max));
      };
      std::vector<bool> used(posed.tree.size());
      std::uint32_t inverted = 0;
      std::vector<bool> seen(cage.cells());
      for (std::size_t i = 0; i < cage.leaves.size(); ++i) {
        const std::uint32_t cell = cage.leaves[i];
        if (cell == kCageOutside) continue;
        ASSERT_LT(cell, cage.cells());
        ASSERT_FALSE(seen[cell]);
        seen[cell] = true;
        std::uint32_t corners[8];
        for (int k = 0; k < 8; ++k) corners[k] = cage.node(cell, k);
        for (std::size_t box = posed.leaves + i / kLeafCells; box > 0; box /= 2) {
          used[box] = true;
          for (int k = 0; k < 8; ++k) ASSERT_TRUE(holds(posed.tree[box], posed.nodes[corners[k]]));
        }
        for (const CageTetrahedron& t : kCageTetrahedra) {
          glm::dvec3 p[4], r[4];
          for (int k = 0; k < 4; ++k) {
            p[k] = posed.nodes[corners[t.corners[k]]];
            r[k] = glm::dvec3(t.corners[k] & 1, t.corners[k] >> 1 & 1, t.corners[k] >> 2);
          }
          const double now = glm::determinant(glm::dmat3(p[1] - p[0], p[2] - p[0], p[3] - p[0]));
          const double rest = glm::determinant(glm::dmat3(r[1] - r[0], r[2] - r[0], r[3] - r[0]));
          if (now * rest > 0) continue;
          ++inverted;
          for (const glm::dvec3& corner : p) ASSERT_TRUE(holds(posed.inverted, glm::vec3(corner)));
        }
      }
      ASSERT_EQ(std::count(seen.begin(), seen.end(), false), 0);
      for (std::size_t box = 1; box < used.size(); ++box)
        ASSERT_EQ(posed.tree[box].min == glm::vec3(kNowhere), !used[box]);
      EXPECT_EQ(posed.bounds.min, posed.tree[1].min);
      EXPECT_EQ(posed.bounds.max, posed.tree[1].max);
      EXPECT_EQ(posed.inverted_count, inverted) << "nothing is too near to tell here";
      inverted_in_all += inverted;
    }
    EXPECT_EQ(inverted_in_all > 0, far >= 2.0f) << far;
  }
}

TEST(CagePose, ThreadsAskAtOnce) {
  const CagedAsset asset(twoLegs({27, 60, 30}), 4, Bend::kSweep);
  Pose pose = asset.pose();
  const int cages = static_cast<int>(asset.part().cages.size());
  for (int round = 0; round < 100; ++round) {
    pose.reset();
    if (round % 3 == 0) shakeNodes(pose.nodes(0), 2, static_cast<unsigned>(round));
    if (round % 3 == 1) pose.setKnots(0, leaning()).value();
    if (round % 3 == 2) pose.motion(0)->roll = static_cast<float>(round);
    const Instance instance = asset.instance(pose);
    std::vector<std::vector<glm::vec3>> seen(8);
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < seen.size(); ++t) {
      threads.emplace_back([&, t] {
        const auto first = static_cast<int>(t);
        for (int c = 0; c < cages; ++c) {
          const PosedCage posed = posedCage(instance, 0, (first + c) % cages, CageUse::kTree).value();
          EXPECT_FALSE(posed.tree[1].empty());
        }
        seen[t] = readNodes(pose);
        raycast(instance, {{0, 0.5f, 2}, {0, 0, -1}});
        posedCage({&*asset}, 0, first % cages).value();
      });
    }
    for (std::thread& thread : threads) thread.join();
    for (const std::vector<glm::vec3>& nodes : seen) ASSERT_EQ(nodes, seen[0]);
  }
}

// The pose of instances without one is made at its first use.
TEST(CagePose, TheAssetMakesItsPoseWhenItIsUsed) {
  const std::vector<std::byte> bytes =
      test::bytesOf(CagedAsset::packOf(twoLegs({27, 60, 30}), 4, Bend::kSweep, straight({0, 0.5f, 1})));
  const MemorySource source(bytes);
  test::ShortMemory memory;
  AssetOptions options;
  options.allocator = memory.allocator();
  const std::unique_ptr<Asset> asset = Asset::open(source.source(), options).value();
  const std::uint64_t before = asset->memory();
  memory.and_on = false;
  memory.refuse_at = memory.requests;
  EXPECT_EQ(posedCage({asset.get()}, 0, 0).error().code, ErrorCode::kOutOfMemory);
  EXPECT_EQ(asset->memory(), before);
  const PosedCage posed = posedCage({asset.get()}, 0, 0, CageUse::kTree).value();
  EXPECT_GT(asset->memory(), before + posed.nodes.size_bytes() + posed.tree.size_bytes());
  const std::size_t requests = memory.requests;
  EXPECT_EQ(posedCage({asset.get()}, 0, 0)->nodes.data(), posed.nodes.data());
  EXPECT_EQ(memory.requests, requests);
}

TEST(CagePose, OnlyCreateAllocates) {
  const CagedAsset asset(twoLegs({27, 60, 30}), 4, Bend::kSweep);
  test::ShortMemory memory;
  std::size_t requests = 0;
  {
    Pose pose = Pose::create(*asset, memory.allocator()).value();
    requests = memory.requests;
    EXPECT_EQ(requests, 2u);
    const Pose other = asset.pose();
    shakeNodes(pose.nodes(0), 2, 3);
    for (std::size_t c = 0; c < asset.part().cages.size(); ++c) asset.posed(pose, static_cast<int>(c));
    pose.blend(other, 0.5f).value();
    pose.assign(other).value();
    raycast(asset.instance(pose), {{0, 0.5f, 2}, {0, 0, -1}});
    const std::span<glm::vec3> nodes = pose.nodes(0);
    const Pose moved = std::move(pose);
    EXPECT_EQ(moved.nodes(0).data(), nodes.data());
    EXPECT_TRUE(std::as_const(pose).nodes(0).empty());
    EXPECT_EQ(memory.requests, requests);
  }
  EXPECT_EQ(memory.live, 0u);
  for (std::size_t i = 0; i < requests; ++i) {
    test::ShortMemory less;
    less.refuse_at = i;
    EXPECT_EQ(Pose::create(*asset, less.allocator()).error().code, ErrorCode::kOutOfMemory);
    EXPECT_EQ(less.live, 0u);
  }
  // A part without cages costs nothing more.
  const Loaded plain(reed({0, 1}));
  test::ShortMemory one;
  const Pose pose = Pose::create(*plain.asset, one.allocator()).value();
  EXPECT_EQ(one.requests, 1u);
}

}  // namespace
}  // namespace kelp::runtime
