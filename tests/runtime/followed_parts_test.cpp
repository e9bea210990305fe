// SPDX-License-Identifier: MIT
// Nodes of cages that follow parts, and joints that the host moves.
#include <gtest/gtest.h>

#include <array>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <optional>
#include <thread>

#include "caged.h"
#include "kelp/runtime/spring.h"
#include "support/naive_cages.h"
#include "support/short_memory.h"

namespace kelp::runtime {
namespace {

constexpr float kNotANumber = std::numeric_limits<float>::quiet_NaN();

glm::dmat4 asDouble(const glm::mat4x3& m) { return glm::dmat4(glm::dmat4x3(m)); }

// A body, part 2, whose nodes follow five empty parts around it: 0, 1, 3, 4, 5; and a lantern on part 4.
// Parts 6 and 7 are morph targets.
struct Puppet {
  explicit Puppet(int cell, std::vector<Knot> knots_of_4 = straight({0, 1}), Bend bend_of_4 = Bend::kShear)
      : loaded(packOf(cell, std::move(knots_of_4), bend_of_4)), pose(Pose::create(*loaded.asset).value()) {}

  static RawPack packOf(int cell, std::vector<Knot> knots_of_4, Bend bend_of_4) {
    RawPack pack = CagedAsset::packOf(twoLegs({27, 60, 30}), cell, Bend::kShear, straight({0, 1}));
    std::mt19937 random(7);
    const auto number = [&random] { return static_cast<float>(random()) / 2147483648.0f - 1.0f; };
    pack.parts[0].to_object = glm::mat4x3(glm::rotate(glm::mat4(0.02f), 0.7f, glm::vec3(1, 2, 3)));
    pack.parts[0].to_object[3] = {0.3f, -0.2f, 0.1f};
    RawPart joint;
    joint.size = {9, 20, 9};
    joint.knots = straight({0, 1});
    std::vector<RawPart> parts(6, joint);
    constexpr int kParents[6] = {-1, 0, -1, 1, 0, 4};
    for (std::size_t i = 0; i < 6; ++i) {
      parts[i].name = "joint " + std::to_string(i);
      parts[i].parent = kParents[i];
      for (int column = 0; column < 4; ++column)
        parts[i].pivot[column] =
            glm::vec3(column < 3) * 2.0f * glm::vec3(column == 0, column == 1, column == 2) +
            0.4f * glm::vec3{number(), number(), number()};
      parts[i].to_object = pack.parts[0].to_object;
      parts[i].to_object[3] += 0.2f * glm::vec3{number(), number(), number()};
    }
    parts[2] = pack.parts[0];
    parts[4].knots = std::move(knots_of_4);
    parts[4].bend = bend_of_4;
    test::addInfluences(parts[2], 2, 6, 5);
    parts.insert(parts.end(), 2, joint);
    parts[6].name = "smile";
    parts[7].name = "frown";
    test::addMorphs(parts[2], {6, 7}, 8);
    pack.parts = std::move(parts);
    pack.sockets = {{"lantern", 4, 0.5f, {0.3f, 0.1f}, {1, 0, 0, 0}}};
    for (const std::uint32_t part : {0u, 1u, 4u, 5u})
      pack.joints.push_back({"j", -1, glm::mat4x3(1), {part}});
    return pack;
  }

  const Asset& asset() const { return *loaded.asset; }
  const Part& body() const { return asset().pack().parts()[2]; }
  Instance instance() const { return {loaded.asset.get(), &pose}; }

  void move(std::uint32_t seed, float far = 1) {
    std::mt19937 random(seed);
    const auto number = [&random] { return static_cast<float>(random()) / 2147483648.0f - 1.0f; };
    for (int part = 0; part < 6; ++part) {
      if (part == 2) continue;
      Motion& motion = *pose.motion(part);
      motion.translation = 0.3f * far * glm::vec3{number(), number(), number()};
      motion.rotation = glm::normalize(glm::quat{1, far * number(), far * number(), far * number()});
      motion.scale = glm::vec3(1) + 0.4f * far * glm::vec3{number(), number(), number()};
    }
    pose.setMorph(asset(), "smile", far * number()).value();
    pose.motion(7)->translation.x = far * number();
  }

  glm::dvec3 restOf(const Cage& cage, std::uint32_t node) const {
    glm::dvec3 rest(cage.rest(node));
    for (const Morph& morph : cage.morphs)
      for (const MovedNode& moved : morph.moved)
        if (moved.node == node)
          rest += static_cast<double>(pose.motion(static_cast<int>(morph.part))->translation.x) *
                  glm::dvec3(moved.offset);
    return rest;
  }

  // Object at rest -> object now.
  glm::dmat4 motionOf(int part) const {
    const std::span<const Part> parts = asset().pack().parts();
    glm::dmat4 all(1);
    for (int i = part; i >= 0; i = parts[static_cast<std::size_t>(i)].parent) {
      if (const auto& joint = driven[static_cast<std::size_t>(i)]) return *joint * all;
      const Motion& motion = *pose.motion(i);
      const glm::dmat4 pivot = asDouble(parts[static_cast<std::size_t>(i)].pivot);
      const glm::dmat4 own = glm::translate(glm::dmat4(1), glm::dvec3(motion.translation)) *
                             glm::mat4_cast(glm::dquat(motion.rotation)) *
                             glm::scale(glm::dmat4(1), glm::dvec3(motion.scale));
      all = pivot * own * glm::inverse(pivot) * all;
    }
    return all;
  }

  // Compares the nodes of all cages with the truth, and the bounds.
  void expectPlaced() const {
    const glm::dmat4 to_object = asDouble(body().to_object);
    std::vector<Influences> influences(body().cages[0].influences.begin(), body().cages[0].influences.end());
    const PosedCage bounded = posedCage(instance(), 2, 0, CageUse::kBounds).value();
    for (std::size_t c = 0; c < body().cages.size(); ++c) {
      const Cage& cage = body().cages[c];
      if (c > 0) influences = test::coarserInfluences(cage, body().cages[c - 1], influences);
      const PosedCage posed = posedCage(instance(), 2, static_cast<int>(c), CageUse::kTree).value();
      ASSERT_EQ(posed.nodes.size(), influences.size());
      for (std::uint32_t i = 0; i < cage.nodes(); ++i) {
        const glm::dvec4 rest = to_object * glm::dvec4(restOf(cage, i), 1);
        glm::dvec4 truth(0);
        for (int k = 0; k < 4; ++k)
          truth += influences[i].weights[k] / 255.0 * (motionOf(influences[i].parts[k]) * rest);
        truth = glm::inverse(to_object) * truth;
        ASSERT_LT(glm::distance(glm::dvec3(truth), glm::dvec3(posed.nodes[i])), 2e-3) << c << " " << i;
        for (int axis = 0; axis < 3 && c == 0; ++axis) {
          EXPECT_GE(posed.nodes[i][axis], bounded.bounds.min[axis] - 1e-3f);
          EXPECT_LE(posed.nodes[i][axis], bounded.bounds.max[axis] + 1e-3f);
        }
      }
    }
  }

  Loaded loaded;
  Pose pose;
  std::optional<glm::dmat4> driven[6];
};

std::vector<glm::mat4> someMatrices(std::uint32_t seed, std::size_t count = 4) {
  std::mt19937 random(seed);
  std::vector<glm::mat4> matrices(count, glm::mat4(1));
  for (glm::mat4& matrix : matrices)
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 3; ++row)
        matrix[column][row] += 0.5f * (static_cast<float>(random()) / 2147483648.0f - 1.0f);
  return matrices;
}
constexpr int kDrivenParts[] = {0, 1, 4, 5};

TEST(FollowedParts, TakeTheNodesOfAllCages) {
  for (const int cell : {2, 4, 16}) {
    Puppet puppet(cell);
    puppet.expectPlaced();
    for (const std::uint32_t seed : {1u, 2u, 3u}) {
      puppet.move(seed);
      puppet.expectPlaced();
    }
    puppet.pose.reset();
    puppet.expectPlaced();
  }
}

TEST(FollowedParts, AMotionThatTheHostKeepsIsNoticed) {
  Puppet puppet(4);
  Motion& kept = *puppet.pose.motion(4);
  puppet.expectPlaced();
  for (const float lift : {0.1f, 0.2f, 0.1f}) {
    kept.translation.y = lift;
    puppet.expectPlaced();
  }
}

TEST(FollowedParts, TheBodyMovesOn) {
  Puppet puppet(4);
  puppet.move(4);
  const glm::vec3 rest = puppet.body().to_object * glm::vec4(10, 10, 10, 1);
  const glm::vec3 before = toWorld(puppet.instance(), 2, rest).value();
  const std::vector<glm::vec3> nodes(puppet.pose.nodes(2).begin(), puppet.pose.nodes(2).end());
  puppet.pose.reset();
  puppet.move(4);
  puppet.pose.motion(2)->translation = {0, 1, 0};
  const glm::vec3 up = puppet.body().pivot * glm::vec4(0, 1, 0, 0);
  EXPECT_LT(glm::distance(toWorld(puppet.instance(), 2, rest).value(), before + up), 1e-5f);
  const std::span<const glm::vec3> now = std::as_const(puppet.pose).nodes(2);
  EXPECT_TRUE(std::equal(now.begin(), now.end(), nodes.begin()));
}

TEST(FollowedParts, JointsOfTheHostTakeThem) {
  Puppet puppet(4);
  puppet.move(1);
  for (const std::uint32_t seed : {1u, 2u}) {
    const std::vector<glm::mat4> matrices = someMatrices(seed);
    ASSERT_TRUE(puppet.pose.setJoints(puppet.asset(), matrices));
    for (std::size_t i = 0; i < 4; ++i) puppet.driven[kDrivenParts[i]] = glm::dmat4(matrices[i]);
    puppet.expectPlaced();  // part 3 goes on by its own motion
    const glm::mat4 part = partToWorld(puppet.instance(), 4).value();
    const glm::dmat4 truth = *puppet.driven[4] * asDouble(puppet.asset().pack().parts()[4].to_object);
    for (int column = 0; column < 4; ++column)
      EXPECT_LT(glm::distance(glm::dvec4(part[column]), truth[column]), 1e-5);
    const glm::dvec3 lantern = truth * glm::dvec4(4.5 + 0.3 * 20, 10, 4.5 + 0.1 * 20, 1);
    EXPECT_LT(glm::distance(glm::dvec3(socketToWorld(puppet.instance(), 0).value()[3]), lantern), 1e-5);
  }
  Pose copy = Pose::create(puppet.asset()).value();
  copy.assign(puppet.pose).value();
  const std::span<const glm::vec3> there = std::as_const(copy).nodes(2),
                                   here = std::as_const(puppet.pose).nodes(2);
  EXPECT_TRUE(std::equal(here.begin(), here.end(), there.begin()));
  puppet.pose.reset();
  for (auto& joint : puppet.driven) joint.reset();
  puppet.expectPlaced();
}

TEST(FollowedParts, WrongJointsAreRefused) {
  Puppet puppet(4);
  std::vector<glm::mat4> matrices = someMatrices(1);
  ASSERT_TRUE(puppet.pose.setJoints(puppet.asset(), matrices));
  const std::vector<glm::vec3> before(std::as_const(puppet.pose).nodes(2).begin(),
                                      std::as_const(puppet.pose).nodes(2).end());
  const auto refused = [&](std::span<const glm::mat4> wrong) {
    const Result<void> set = puppet.pose.setJoints(puppet.asset(), wrong);
    const std::span<const glm::vec3> now = std::as_const(puppet.pose).nodes(2);
    EXPECT_TRUE(std::equal(now.begin(), now.end(), before.begin()));
    EXPECT_TRUE(!set);
    return set ? Error{} : set.error();
  };
  for (const std::size_t count : {0u, 3u})
    EXPECT_EQ(refused(std::span(matrices).first(count)).code, ErrorCode::kMisuse);
  matrices[2][3].y = kNotANumber;
  const Error error = refused(matrices);
  EXPECT_EQ(error.code, ErrorCode::kMisuse);
  EXPECT_EQ(error.offset, 2u);
  EXPECT_EQ(error.unit, Error::Unit::kJoint);
  matrices = someMatrices(1);
  matrices[3][1].w = 0.5f;
  EXPECT_EQ(refused(matrices).offset, 3u);
  Puppet other(8);
  EXPECT_EQ(other.pose.setJoints(puppet.asset(), someMatrices(1)).error().code, ErrorCode::kMisuse);
  // Flat, mirrored and all on one point: as the host wants it.
  for (const float scale : {0.0f, -1.0f}) {
    std::vector<glm::mat4> odd(4, glm::mat4(scale));
    for (glm::mat4& matrix : odd) matrix[3].w = 1;
    ASSERT_TRUE(puppet.pose.setJoints(puppet.asset(), odd));
    for (std::size_t i = 0; i < 4; ++i) puppet.driven[kDrivenParts[i]] = glm::dmat4(odd[i]);
    puppet.expectPlaced();
  }
}

TEST(FollowedParts, BlendsMixJoints) {
  Puppet puppet(4);
  puppet.move(1, 0.3f);
  Pose to = Pose::create(puppet.asset()).value();
  const std::vector<glm::mat4> matrices = someMatrices(3);
  to.setJoints(puppet.asset(), matrices).value();
  std::optional<glm::dmat4> mixed[6];
  for (std::size_t i = 0; i < 4; ++i) {
    const int part = kDrivenParts[i];
    const glm::dmat4 from = puppet.motionOf(part);
    mixed[part] = from + 0.25 * (glm::dmat4(matrices[i]) - from);
  }
  puppet.pose.blend(to, 0.25f).value();
  std::copy(std::begin(mixed), std::end(mixed), puppet.driven);
  puppet.expectPlaced();
}

TEST(FollowedParts, BlendsLetJointsGo) {
  Puppet puppet(4);
  puppet.pose.setJoints(puppet.asset(), someMatrices(3)).value();
  puppet.pose.assign(puppet.pose).value();
  for (std::size_t i = 0; i < 4; ++i) puppet.driven[kDrivenParts[i]] = glm::dmat4(someMatrices(3)[i]);
  puppet.expectPlaced();
  const Pose rest = Pose::create(puppet.asset()).value();
  puppet.pose.blend(rest, 1).value();
  for (auto& joint : puppet.driven) joint.reset();
  puppet.move(2);
  puppet.expectPlaced();
}

// Of each part that nodes follow a pose has a map: not of all parts for each body.
TEST(FollowedParts, PosesOfManyBodiesAreSmall) {
  constexpr std::size_t kBodies = 300;
  RawPack pack = CagedAsset::packOf(fields::Occupancy{{4, 4, 4}, std::vector<std::uint8_t>(64, 1)}, 4,
                                    Bend::kShear, straight({0, 1}));
  pack.parts.assign(kBodies, pack.parts[0]);
  for (std::size_t i = 0; i < kBodies; ++i) {
    const auto next = static_cast<std::uint16_t>((i + 1) % kBodies);
    pack.parts[i].influences.assign(8, Influences{{next}, {255}});
  }
  const Loaded loaded(pack);
  test::ShortMemory memory;
  const Pose pose = Pose::create(*loaded.asset, memory.allocator()).value();
  EXPECT_LT(memory.peak_bytes, 2'000 * kBodies);
}

TEST(FollowedParts, WrittenNodesStay) {
  Puppet puppet(4);
  puppet.move(1);
  const std::span<glm::vec3> nodes = puppet.pose.nodes(2);
  nodes[5] += 3.0f;
  const std::vector<glm::vec3> written(nodes.begin(), nodes.end());
  puppet.move(2);
  EXPECT_TRUE(std::equal(nodes.begin(), nodes.end(), posedCage(puppet.instance(), 2, 0)->nodes.begin()));
  EXPECT_EQ(nodes[5], written[5]);
  for (std::size_t c = 1; c < puppet.body().cages.size(); ++c) {
    const PosedCage finer = posedCage(puppet.instance(), 2, static_cast<int>(c) - 1).value(),
                    posed = posedCage(puppet.instance(), 2, static_cast<int>(c)).value();
    for (std::uint32_t i = 0; i < posed.cage->nodes(); ++i)
      if (const std::uint32_t word = posed.cage->follows[i]; !(word & kFollowsAll)) {
        EXPECT_EQ(posed.nodes[i], finer.nodes[word]);
      }
  }
  puppet.pose.reset();
  puppet.move(2);
  puppet.expectPlaced();
}

// Within its box a bent part takes a point where toWorld() does; beyond its ends straight on.
TEST(FollowedParts, BendAroundTheirSpline) {
  for (const Bend bend : {Bend::kShear, Bend::kSweep}) {
    Puppet puppet(4, straight({0, 0.5f, 1}), bend);
    puppet.pose.setKnots(4, leaning()).value();
    puppet.pose.setMorph(puppet.asset(), "smile", 0.25f).value();
    const Part& bent = puppet.asset().pack().parts()[4];
    const glm::mat4 to_part = glm::inverse(glm::mat4(asDouble(bent.to_object)));
    const glm::mat4 to_body = glm::inverse(glm::mat4(asDouble(puppet.body().to_object)));
    const auto height = static_cast<float>(bent.size.y);
    const auto placed = [&](glm::vec3 at) {
      const auto inside = [&](const glm::vec3& p) {
        return toWorld(puppet.instance(), 4, bent.to_object * glm::vec4(p, 1)).value();
      };
      const float end = glm::clamp(at.y, 0.0f, height), inward = end > 0.5f * height ? -0.5f : 0.5f;
      // The slope at the end, from there and two points before. Of a swept part each point of a section goes
      // on along the spline.
      const glm::vec3 on = bend == Bend::kSweep ? glm::vec3(4.5f, end, 4.5f) : glm::vec3(at.x, end, at.z);
      const glm::vec3 step(0, inward, 0);
      const glm::vec3 along =
          (4.0f * inside(on + step) - inside(on + 2.0f * step) - 3.0f * inside(on)) / 2.0f;
      return glm::dvec3(inside({at.x, end, at.z}) + (at.y - end) / inward * along);
    };
    int beyond = 0;
    const Cage& cage = puppet.body().cages[0];
    const std::span<const glm::vec3> nodes = std::as_const(puppet.pose).nodes(2);
    for (std::uint32_t i = 0; i < cage.nodes(); ++i) {
      const Influences& its = cage.influences[i];
      const glm::vec3 rest = puppet.body().to_object * glm::vec4(glm::vec3(puppet.restOf(cage, i)), 1);
      const glm::vec3 in_part = to_part * glm::vec4(rest, 1);
      glm::dvec3 truth(0);
      for (int k = 0; k < 4; ++k)
        truth += its.weights[k] / 255.0 * (its.parts[k] == 4 ? placed(in_part) : glm::dvec3(rest));
      truth = glm::dvec3(to_body * glm::vec4(glm::vec3(truth), 1));
      const float off = std::max(-in_part.y, in_part.y - height);
      beyond += off > 0;
      ASSERT_LT(glm::distance(truth, glm::dvec3(nodes[i])), 0.01 + 0.01 * std::max(off, 0.0f)) << i;
    }
    EXPECT_GT(beyond, 10);
    const PosedCage bounded = posedCage(puppet.instance(), 2, 0, CageUse::kBounds).value();
    for (const glm::vec3& node : nodes)
      EXPECT_TRUE(glm::all(glm::lessThanEqual(bounded.bounds.min, node)) &&
                  glm::all(glm::lessThanEqual(node, bounded.bounds.max)));
  }
}

// Weights of clips and of blended poses add up as any motion does.
TEST(FollowedParts, MorphTargetsPlay) {
  RawPack pack = Puppet::packOf(4, straight({0, 1}), Bend::kShear);
  RawTrack track{6, 0, Target::kPartTranslation, Interpolation::kLinear, {}};
  track.keys = {{0, glm::vec4(0), {}, {}}, {1, {2, 0, 0, 0}, {}, {}}};
  pack.clips = {{"talk", 1, {}, {track}}};
  const Loaded loaded(pack);
  Pose pose = Pose::create(*loaded.asset).value(), other = Pose::create(*loaded.asset).value();
  addClip(*loaded.asset, 0, 0.25, 0.5f, pose).value();
  EXPECT_FLOAT_EQ(pose.motion(6)->translation.x, 0.25f);
  other.setMorph(*loaded.asset, "smile", 1).value();
  pose.blend(other, 0.5f).value();
  EXPECT_FLOAT_EQ(pose.motion(6)->translation.x, 0.625f);
  const Cage& cage = loaded.asset->pack().parts()[2].cages[0];
  const Pose still = Pose::create(*loaded.asset).value();
  for (const MovedNode& moved : cage.morphs[0].moved) {
    const glm::vec3 by = pose.nodes(2)[moved.node] - still.nodes(2)[moved.node];
    EXPECT_LT(glm::distance(by, 0.625f * moved.offset), 1e-3f);
  }
  EXPECT_FALSE(pose.setMorph(*loaded.asset, "grin", 1));
  EXPECT_FALSE(pose.setMorph(*loaded.asset, "joint 0", 1));
  EXPECT_FALSE(pose.setMorph(*loaded.asset, "smile", kNotANumber));
  EXPECT_FALSE(Pose().setMorph(*loaded.asset, "smile", 1));
}

TEST(FollowedParts, MotionsThatAreNoNumbersAreRefused) {
  for (int i = 0; i < 6; ++i) {
    const float bad = std::array{kNotANumber, std::numeric_limits<float>::infinity(),
                                 1e30f}[static_cast<std::size_t>(i % 3)];
    Puppet puppet(4);
    puppet.pose.motion(i < 3 ? 1 : 7)->translation.x = bad;
    const Result<void> sound = puppet.pose.check();
    ASSERT_FALSE(sound);
    EXPECT_EQ(sound.error().offset, 2u);
    for (const CageUse use : {CageUse::kBounds, CageUse::kTree})
      EXPECT_EQ(posedCage(puppet.instance(), 2, 1, use).error().code, ErrorCode::kMisuse);
    EXPECT_FALSE(raycast(puppet.instance(), {{0, 0.5f, 5}, {0, 0, -1}}));
    puppet.pose.clamp();
    EXPECT_TRUE(puppet.pose.check());
    EXPECT_EQ(std::as_const(puppet.pose).nodes(2)[0], glm::vec3(puppet.body().cages[0].rest(0)));
    puppet.pose.reset();
    puppet.expectPlaced();
  }
}

// A sphere that a spring meets pushes nodes away from where the parts take them.
TEST(FollowedParts, SpringsPushTheNodes) {
  Puppet puppet(4);
  puppet.move(1, 0.1f);
  puppet.pose.setMorph(puppet.asset(), "smile", 0).value();
  puppet.pose.setMorph(puppet.asset(), "frown", 0).value();
  const Box box = bounds(puppet.instance());
  const glm::vec3 from(0.5f * (box.min.x + box.max.x), 0.5f * (box.min.y + box.max.y), box.max.z + 1);
  const auto hit = raycast(puppet.instance(), {from, {0, 0, -1}});
  ASSERT_TRUE(hit);
  const std::vector<glm::vec3> before(std::as_const(puppet.pose).nodes(2).begin(),
                                      std::as_const(puppet.pose).nodes(2).end());
  Spring spring = Spring::create(puppet.asset()).value();
  spring.pushAway(puppet.instance(), hit->position, 0.05f).value();
  spring.addTo(puppet.pose).value();
  const std::span<const glm::vec3> after = std::as_const(puppet.pose).nodes(2);
  std::size_t moved = 0;
  for (std::size_t i = 0; i < before.size(); ++i) moved += before[i] != after[i];
  EXPECT_GT(moved, 10u);
  EXPECT_LT(moved, before.size());
  const auto now = raycast(puppet.instance(), {from, {0, 0, -1}});
  EXPECT_TRUE(!now || now->t > hit->t + 0.04f);
}

TEST(FollowedParts, ThreadsAskAtOnce) {
  Puppet puppet(4);
  for (std::uint32_t round = 0; round < 60; ++round) {
    puppet.move(round);
    if (round % 3 == 0) puppet.pose.setJoints(puppet.asset(), someMatrices(round)).value();
    std::vector<std::vector<glm::vec3>> seen(6);
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < seen.size(); ++t)
      threads.emplace_back([&, t] {
        const int cages = static_cast<int>(puppet.body().cages.size());
        for (int c = 0; c < cages; ++c)
          posedCage(puppet.instance(), 2, (static_cast<int>(t) + c) % cages, CageUse::kTree).value();
        const std::span<const glm::vec3> nodes = std::as_const(puppet.pose).nodes(2);
        seen[t].assign(nodes.begin(), nodes.end());
      });
    for (std::thread& thread : threads) thread.join();
    for (const std::vector<glm::vec3>& nodes : seen) ASSERT_EQ(nodes, seen[0]);
  }
}

TEST(FollowedParts, OnlyCreateAllocates) {
  const Puppet puppet(4);
  test::ShortMemory memory;
  Pose pose = Pose::create(puppet.asset(), memory.allocator()).value();
  const std::size_t requests = memory.requests;
  pose.setJoints(puppet.asset(), someMatrices(1)).value();
  pose.blend(puppet.pose, 0.5f).value();
  posedCage({&puppet.asset(), &pose}, 2, 1, CageUse::kTree).value();
  pose.assign(puppet.pose).value();
  EXPECT_EQ(memory.requests, requests);
}

}  // namespace
}  // namespace kelp::runtime
