// SPDX-License-Identifier: MIT
// Poses and springs move in C as in C++.
#include <limits>
#include <utility>

#include "both.h"

namespace kelp::test {
namespace {

TEST(CPose, MovesAsInCpp) {
  const BothAssets assets(packFile("distance"));
  BothPoses poses(assets), others(assets);
  Dice dice;
  poses.expectEqual();
  kelp_bool fits = 0;
  ASSERT_KELP(kelp_pose_fits(poses.c, assets.c, &fits));
  EXPECT_EQ(1u, fits);
  const BothAssets fog(packFile("fog"), -1);
  ASSERT_KELP(kelp_pose_fits(poses.c, fog.c, &fits));
  EXPECT_EQ(0u, fits);

  for (int i = 0; i < 8; ++i) {
    const int part = i % 2, knot = i / 2 % (part == 0 ? 3 : 2);
    const glm::vec3 offset = dice.vec3(0.05f), tangent = glm::vec3(0, 1, 0) + dice.vec3(0.3f);
    ASSERT_KELP(kelp_pose_move(poses.c, part, knot, &offset.x));
    poses.cpp.move(part, knot, offset).value();
    if (i % 3 == 0) {
      ASSERT_KELP(kelp_pose_set_tangent(poses.c, part, knot, &tangent.x));
      poses.cpp.setTangent(part, knot, tangent).value();
    }
    const double seconds = dice.in(-3, 9);
    ASSERT_KELP(kelp_pose_add_clip(poses.c, assets.c, 0, seconds, 0.5f, i % 2));
    addClip(*assets.cpp, 0, seconds, 0.5f, poses.cpp, static_cast<runtime::Play>(i % 2)).value();
    poses.expectEqual();
  }

  const kelp_motion motion = {{1, 2, 3}, {0.6f, 0, 0, 0.8f}, {1, 2, 1}, 0.25f};
  ASSERT_KELP(kelp_pose_set_motion(others.c, 1, &motion));
  *others.cpp.motion(1) = {{1, 2, 3}, glm::quat(0.8f, 0.6f, 0, 0), {1, 2, 1}, 0.25f};
  others.expectEqual();
  for (const std::vector<float>& mask : {std::vector<float>{}, std::vector<float>{0.25f, 1}}) {
    ASSERT_KELP(
        kelp_pose_blend(poses.c, others.c, 0.4f, mask.data(), static_cast<std::uint32_t>(mask.size())));
    poses.cpp.blend(others.cpp, 0.4f, mask).value();
    poses.expectEqual();
  }

  ASSERT_KELP(kelp_pose_assign(others.c, poses.c));
  ASSERT_TRUE(others.cpp.assign(poses.cpp));
  others.expectEqual();
  ASSERT_KELP(kelp_pose_reset(poses.c));
  poses.cpp.reset();
  poses.expectEqual();
  BothPoses foreign(fog);
  EXPECT_KELP(KELP_ERROR_MISUSE, kelp_pose_assign(poses.c, foreign.c));
}

TEST(CPose, NodesAreReadAndWritten) {
  constexpr int kComb = 2;
  const BothAssets assets(packFile("cage"));
  BothPoses poses(assets), others(assets);
  const std::span<const glm::vec3> rest = std::as_const(others.cpp).nodes(kComb);
  std::vector<glm::vec3> read(rest.size() + 1, glm::vec3(-7));
  std::uint32_t count = 0;
  ASSERT_KELP(kelp_pose_get_nodes(poses.c, kComb, nullptr, 0, &count));
  ASSERT_EQ(rest.size(), count);
  ASSERT_KELP(kelp_pose_get_nodes(poses.c, kComb, &read[0].x, count - 1, &count));
  EXPECT_EQ(read[count - 1], glm::vec3(-7)) << "more was written than there is room for";
  ASSERT_KELP(kelp_pose_get_nodes(poses.c, kComb, &read[0].x, count, &count));
  EXPECT_TRUE(std::equal(rest.begin(), rest.end(), read.begin()));
  float* nodes = nullptr;
  ASSERT_KELP(kelp_pose_write_nodes(poses.c, kComb, &nodes, &count));
  ASSERT_EQ(rest.size(), count);
  EXPECT_TRUE(std::equal(rest.begin(), rest.end(), reinterpret_cast<const glm::vec3*>(nodes)));
  nodes[3] = 100;
  ASSERT_KELP(kelp_pose_get_nodes(poses.c, kComb, &read[0].x, count, &count));
  EXPECT_EQ(read[1].x, 100);
  ASSERT_KELP(kelp_pose_check(poses.c));
  nodes[5] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_KELP(KELP_ERROR_MISUSE, kelp_pose_check(poses.c));
  EXPECT_EQ(kelp_unit{KELP_UNIT_PART}, lastError().unit);
  ASSERT_KELP(kelp_pose_clamp(poses.c));
  ASSERT_KELP(kelp_pose_check(poses.c));
  ASSERT_KELP(kelp_pose_reset(poses.c));
  EXPECT_EQ(nodes[3], rest[1].x) << "the pointer stays valid";
  for (const std::int32_t part : {-1, 9}) {
    EXPECT_KELP(KELP_ERROR_MISUSE, kelp_pose_get_nodes(poses.c, part, nullptr, 0, &count));
    EXPECT_KELP(KELP_ERROR_MISUSE, kelp_pose_write_nodes(poses.c, part, &nodes, &count));
  }
  EXPECT_KELP(KELP_ERROR_NULL, kelp_pose_get_nodes(poses.c, kComb, nullptr, 1, &count));
  EXPECT_KELP(KELP_ERROR_NULL, kelp_pose_get_nodes(poses.c, kComb, nullptr, 0, nullptr));
  EXPECT_KELP(KELP_ERROR_NULL, kelp_pose_write_nodes(poses.c, kComb, nullptr, &count));
  EXPECT_KELP(KELP_ERROR_NULL, kelp_pose_write_nodes(poses.c, kComb, &nodes, nullptr));
  const BothAssets plain(packFile("distance"));
  BothPoses uncaged(plain);
  ASSERT_KELP(kelp_pose_get_nodes(uncaged.c, 0, nullptr, 0, &count));
  EXPECT_EQ(count, 0u);
  ASSERT_KELP(kelp_pose_write_nodes(uncaged.c, 0, &nodes, &count));
  EXPECT_EQ(nodes, nullptr);
}

TEST(CPose, JointsAreSet) {
  const BothAssets assets(packFile("distance"));
  const std::size_t count = assets.cpp->pack().joints().size();
  ASSERT_GT(count, 1u);
  BothPoses poses(assets);
  Dice dice;
  std::vector<glm::mat4> matrices;
  for (std::size_t i = 0; i < count; ++i)
    matrices.push_back(glm::translate(glm::mat4(dice.in(0.5f, 2)), dice.vec3(3)));
  for (glm::mat4& matrix : matrices) matrix[3].w = 1;
  const auto set = [&](kelp_asset asset, std::size_t number) {
    return kelp_pose_set_joints(poses.c, asset, &matrices[0][0].x, static_cast<std::uint32_t>(number));
  };
  ASSERT_KELP(set(assets.c, count));
  poses.cpp.setJoints(*assets.cpp, matrices).value();
  const kelp_instance instance = instanceOf(assets.c, poses.c);
  const int part = static_cast<int>(assets.cpp->pack().joints()[count - 1].parts[0]);
  glm::mat4 there(0);
  ASSERT_KELP(kelp_instance_part_to_world(&instance, part, &there[0].x));
  EXPECT_EQ(there, runtime::partToWorld({assets.cpp.get(), &poses.cpp}, part).value());
  const auto& to_object = assets.cpp->pack().parts()[static_cast<std::size_t>(part)].to_object;
  EXPECT_LT(glm::distance(there[3], matrices[count - 1] * glm::vec4(to_object[3], 1)), 1e-4f);
  EXPECT_KELP(KELP_ERROR_MISUSE, set(assets.c, count - 1));
  EXPECT_KELP(KELP_ERROR_NULL, kelp_pose_set_joints(poses.c, assets.c, nullptr, 1));
  EXPECT_KELP(KELP_ERROR_HANDLE, set({}, count));
  matrices[1][2].y = std::numeric_limits<float>::infinity();
  EXPECT_KELP(KELP_ERROR_MISUSE, set(assets.c, count));
  EXPECT_EQ(kelp_unit{KELP_UNIT_JOINT}, lastError().unit);
  EXPECT_EQ(1u, lastError().offset);
}

TEST(CPose, MorphsAreSet) {
  const BothAssets assets(packFile("morphs"));
  BothPoses poses(assets);
  std::uint32_t count = 0;
  std::int32_t morphs[3] = {-1, -1, -1};
  ASSERT_KELP(kelp_asset_get_morphs(assets.c, 2, morphs, 1, &count));
  EXPECT_EQ(count, 2u);
  EXPECT_EQ(morphs[1], -1);
  ASSERT_KELP(kelp_asset_get_morphs(assets.c, 2, morphs, 3, &count));
  EXPECT_TRUE(morphs[0] == 3 && morphs[1] == 4 && morphs[2] == -1);
  ASSERT_KELP(kelp_asset_get_morphs(assets.c, 0, nullptr, 0, &count));
  EXPECT_EQ(count, 0u);
  EXPECT_KELP(KELP_ERROR_NULL, kelp_asset_get_morphs(assets.c, 2, nullptr, 1, &count));
  EXPECT_KELP(KELP_ERROR_MISUSE, kelp_asset_get_morphs(assets.c, 6, morphs, 3, &count));
  ASSERT_KELP(kelp_pose_set_morph(poses.c, assets.c, "smile", 0.75f));
  poses.cpp.setMorph(*assets.cpp, "smile", 0.75f).value();
  const std::span<const glm::vec3> want = std::as_const(poses.cpp).nodes(2);
  std::vector<glm::vec3> nodes(want.size());
  ASSERT_KELP(kelp_pose_get_nodes(poses.c, 2, &nodes[0].x, static_cast<std::uint32_t>(nodes.size()), &count));
  EXPECT_TRUE(std::equal(want.begin(), want.end(), nodes.begin(), nodes.end()));
  const float width[2] = {1.5f, 0.5f};
  ASSERT_KELP(kelp_pose_set_section(poses.c, 5, 1, width, 0.25f, 1));
  ASSERT_KELP(kelp_pose_set_section(poses.c, 5, 0, nullptr, -1, 0));
  poses.cpp.setSection(5, 1, {{1.5f, 0.5f}, 0.25f, 1}).value();
  poses.cpp.setSection(5, 0, {{1, 1}, -1, 0}).value();
  const std::span<const glm::vec3> wide = std::as_const(poses.cpp).nodes(5);
  nodes.resize(wide.size());
  ASSERT_KELP(kelp_pose_get_nodes(poses.c, 5, &nodes[0].x, static_cast<std::uint32_t>(nodes.size()), &count));
  EXPECT_TRUE(std::equal(wide.begin(), wide.end(), nodes.begin(), nodes.end()));
  EXPECT_KELP(KELP_ERROR_MISUSE, kelp_pose_set_section(poses.c, 2, 0, width, 0, 0));
  EXPECT_KELP(KELP_ERROR_MISUSE, kelp_pose_set_morph(poses.c, assets.c, "grin", 1));
  EXPECT_KELP(KELP_ERROR_NULL, kelp_pose_set_morph(poses.c, assets.c, nullptr, 1));
  EXPECT_KELP(KELP_ERROR_HANDLE, kelp_pose_set_morph(poses.c, {}, "smile", 1));
}

TEST(CPose, KnotsAreSetCheckedAndClamped) {
  const BothAssets assets(packFile("distance"));
  BothPoses poses(assets);
  std::array<kelp_knot, 3> knots = {};
  std::uint32_t count = 0;
  ASSERT_KELP(kelp_pose_get_knots(poses.c, 0, nullptr, 0, &count));
  EXPECT_EQ(3u, count);
  ASSERT_KELP(kelp_pose_get_knots(poses.c, 0, knots.data(), 2, &count));
  EXPECT_EQ(3u, count);
  EXPECT_EQ(0, knots[2].at) << "more was written than there is room for";
  ASSERT_KELP(kelp_pose_get_knots(poses.c, 0, knots.data(), 3, &count));
  ASSERT_KELP(kelp_pose_check(poses.c));
  knots[1].tangent[1] = -30;  // turns back
  ASSERT_KELP(kelp_pose_set_knots(poses.c, 0, knots.data(), 3));
  EXPECT_KELP(KELP_ERROR_NOT_MONOTONE, kelp_pose_check(poses.c));
  const kelp_error error = lastError();
  std::vector<Knot> same(poses.cpp.knots(0).begin(), poses.cpp.knots(0).end());
  same[1].tangent.y = -30;
  poses.cpp.setKnots(0, same).value();
  const auto checked = poses.cpp.check();
  EXPECT_STREQ(checked.error().detail, error.text);
  EXPECT_EQ(checked.error().offset, error.offset);
  EXPECT_EQ(kelp_unit{KELP_UNIT_PART}, error.unit);
  ASSERT_KELP(kelp_pose_clamp(poses.c));
  poses.cpp.clamp();
  poses.expectEqual();
  ASSERT_KELP(kelp_pose_check(poses.c));
  EXPECT_KELP(KELP_ERROR_MISUSE, kelp_pose_set_knots(poses.c, 0, knots.data(), 2));
}

class BothSprings {
 public:
  BothSprings(const BothAssets& assets, const runtime::SpringOptions& settings)
      : cpp(std::move(runtime::Spring::create(*assets.cpp, settings)).value()) {
    auto same = sized<kelp_spring_options>();
    EXPECT_KELP(KELP_OK, kelp_spring_options_defaults(&same));
    const runtime::SpringOptions defaults;
    EXPECT_EQ(defaults.damping, same.damping);
    EXPECT_EQ(defaults.reach, same.reach);
    EXPECT_EQ(defaults.frequency, same.frequency);
    EXPECT_EQ(defaults.rooted, same.rooted != 0);
    same.frequency = settings.frequency;
    same.rooted = settings.rooted;
    EXPECT_KELP(KELP_OK, kelp_spring_create(assets.c, &same, nullptr, &c));
  }
  ~BothSprings() { EXPECT_KELP(KELP_OK, kelp_spring_destroy(c)); }

  void expectEqual() const {
    std::int32_t parts = 0;
    EXPECT_KELP(KELP_OK, kelp_spring_get_parts(c, &parts));
    ASSERT_EQ(cpp.parts(), parts);
    for (int part = 0; part < parts; ++part) {
      std::array<kelp_swing, 64> swings = {};
      std::uint32_t count = 0;
      EXPECT_KELP(KELP_OK, kelp_spring_get_swings(c, part, swings.data(), 64, &count));
      ASSERT_EQ(cpp.knots(part).size(), count);
      for (std::size_t k = 0; k < count; ++k) {
        expectSame(swings[k].offset, cpp.knots(part)[k].offset, "offset");
        expectSame(swings[k].velocity, cpp.knots(part)[k].velocity, "velocity");
      }
    }
  }

  kelp_spring c = {};
  runtime::Spring cpp;
};

TEST(CSpring, SwingsAsInCpp) {
  const BothAssets assets(packFile("distance"));
  const BothInstances instances(assets);
  for (const bool rooted : {true, false}) {
    BothSprings springs(assets, {.frequency = 2, .rooted = rooted});
    BothPoses poses(assets);
    const kelp_instance& in = instances.c[1];
    const runtime::Instance& same = instances.cpp[1];
    const glm::vec3 a(0.3f, 0, 0.2f), b(2, 0, -3);
    ASSERT_KELP(kelp_spring_push(springs.c, 0, &a.x));
    springs.cpp.push(0, a).value();
    ASSERT_KELP(kelp_spring_push_in_world(springs.c, &in, 1, &b.x));
    springs.cpp.pushInWorld(same, 1, b).value();
    ASSERT_KELP(kelp_spring_set_wind(springs.c, 1, &a.x));
    springs.cpp.setWind(1, a).value();
    ASSERT_KELP(kelp_spring_set_wind_in_world(springs.c, &in, 0, &b.x));
    springs.cpp.setWindInWorld(same, 0, b).value();
    springs.expectEqual();
    ASSERT_KELP(kelp_spring_step(springs.c, 0.1f));
    springs.cpp.step(0.1f).value();
    const glm::vec3 player = toWorld(same, 0, {1, 20, 1}).value();
    ASSERT_KELP(kelp_spring_push_away(springs.c, &in, &player.x, 3));
    springs.cpp.pushAway(same, player, 3).value();
    springs.expectEqual();
    std::array<kelp_swing, 1> moved = {};
    std::uint32_t count = 0;
    ASSERT_KELP(kelp_spring_get_swings(springs.c, 0, moved.data(), 1, &count));
    EXPECT_EQ(3u, count);
    ASSERT_KELP(kelp_spring_add_to(springs.c, poses.c));
    springs.cpp.addTo(poses.cpp).value();
    poses.expectEqual();
    ASSERT_KELP(kelp_spring_reset(springs.c));
    springs.cpp.reset();
    springs.expectEqual();
  }
}

// At rest a cell is a cube.
TEST(CPose, CellsAreCubesOfNodes) {
  const BothAssets assets(packFile("cage"));
  const BothPoses poses(assets);
  for (int part = 0; part < 3; ++part) {
    SCOPED_TRACE(part);
    std::uint32_t count = 0, nodes = 0;
    ASSERT_KELP(kelp_asset_get_cage_cells(assets.c, part, nullptr, 0, &count));
    ASSERT_KELP(kelp_pose_get_nodes(poses.c, part, nullptr, 0, &nodes));
    ASSERT_EQ(count == 0, nodes == 0);
    if (count == 0) continue;
    std::vector<glm::vec3> rest(nodes);
    ASSERT_KELP(kelp_pose_get_nodes(poses.c, part, &rest[0].x, nodes, &nodes));
    std::vector<std::uint32_t> cells(std::size_t{8} * count + 1, 77);
    ASSERT_KELP(kelp_asset_get_cage_cells(assets.c, part, cells.data(), count, &count));
    EXPECT_EQ(cells.back(), 77u);
    const float side = rest[cells[1]].x - rest[cells[0]].x;
    EXPECT_GE(side, 2);
    for (std::size_t i = 0; i < std::size_t{8} * count; ++i) {
      const glm::vec3 corner(i & 1, i >> 1 & 1, i >> 2 & 1);
      EXPECT_LT(glm::distance(rest[cells[i]], rest[cells[i & ~std::size_t{7}]] + side * corner), 1e-3f) << i;
    }
    EXPECT_KELP(KELP_ERROR_NULL, kelp_asset_get_cage_cells(assets.c, part, nullptr, 1, &count));
    EXPECT_KELP(KELP_ERROR_NULL, kelp_asset_get_cage_cells(assets.c, part, nullptr, 0, nullptr));
  }
  std::uint32_t count = 0;
  for (const std::int32_t part : {-1, 9})
    EXPECT_KELP(KELP_ERROR_MISUSE, kelp_asset_get_cage_cells(assets.c, part, nullptr, 0, &count));
}

TEST(CPose, VolumesAndEdgesOfNodesAreThoseOfCpp) {
  const BothAssets assets(packFile("cage"));
  int caged = 0;
  for (int part = 0; part < 3; ++part) {
    SCOPED_TRACE(part);
    const auto& cages = assets.cpp->pack().parts()[static_cast<std::size_t>(part)].cages;
    std::vector<float> expected(cages.empty() ? 0 : cages[0].nodes()), volumes(expected.size() + 1, -7.0f);
    runtime::nodeVolumes(*assets.cpp, part, expected).value();
    std::uint32_t count = 0;
    ASSERT_KELP(kelp_asset_get_node_volumes(assets.c, part, nullptr, 0, &count));
    ASSERT_EQ(expected.size(), count);
    ASSERT_KELP(kelp_asset_get_node_volumes(assets.c, part, volumes.data(), count, &count));
    EXPECT_EQ(volumes.back(), -7);
    volumes.pop_back();
    EXPECT_EQ(volumes, expected);
    const Buffer<runtime::NodeEdge> edges = runtime::nodeEdges(*assets.cpp, part).value();
    std::vector<std::uint32_t> pairs(2 * edges.size() + 1, 77);
    ASSERT_KELP(kelp_asset_get_node_edges(assets.c, part, pairs.data(), 0, &count));
    ASSERT_EQ(edges.size(), count);
    ASSERT_KELP(kelp_asset_get_node_edges(assets.c, part, pairs.data(), count, &count));
    EXPECT_EQ(pairs.back(), 77u);
    for (std::size_t i = 0; i < edges.size(); ++i) {
      EXPECT_EQ(pairs[2 * i], edges[i].a);
      EXPECT_EQ(pairs[2 * i + 1], edges[i].b);
    }
    if (!cages.empty()) {
      ++caged;
      volumes.assign(volumes.size(), -7);
      ASSERT_KELP(kelp_asset_get_node_volumes(assets.c, part, volumes.data(), 1, &count));
      EXPECT_EQ(volumes[0], expected[0]);
      EXPECT_EQ(volumes[1], -7);
    }
    EXPECT_KELP(KELP_ERROR_NULL, kelp_asset_get_node_volumes(assets.c, part, nullptr, 1, &count));
    EXPECT_KELP(KELP_ERROR_NULL, kelp_asset_get_node_volumes(assets.c, part, nullptr, 0, nullptr));
    EXPECT_KELP(KELP_ERROR_NULL, kelp_asset_get_node_edges(assets.c, part, nullptr, 1, &count));
    EXPECT_KELP(KELP_ERROR_NULL, kelp_asset_get_node_edges(assets.c, part, nullptr, 0, nullptr));
  }
  EXPECT_GT(caged, 0);
  std::uint32_t count = 0;
  for (const std::int32_t part : {-1, 9}) {
    EXPECT_KELP(KELP_ERROR_MISUSE, kelp_asset_get_node_volumes(assets.c, part, nullptr, 0, &count));
    EXPECT_KELP(KELP_ERROR_MISUSE, kelp_asset_get_node_edges(assets.c, part, nullptr, 0, &count));
  }
  kelp_asset unread = {};
  ASSERT_KELP(kelp_asset_open_file(packFile("cage").c_str(), nullptr, &unread));
  float volume = 0;
  EXPECT_KELP(KELP_ERROR_NOT_YET, kelp_asset_get_node_volumes(unread, 2, &volume, 1, &count));
  EXPECT_KELP(KELP_OK, kelp_asset_destroy(unread));
}

TEST(CSpring, OnlyListedPartsGiveWay) {
  constexpr std::uint32_t kFirstSize = 20;
  const BothAssets assets(packFile("distance"));
  const BothInstances instances(assets);
  const glm::vec3 player = toWorld(instances.cpp[1], 0, {1, 20, 1}).value();
  for (const std::vector<std::int32_t>& list : {std::vector<std::int32_t>{0}, {1}, {1, 0}}) {
    auto options = sized<kelp_spring_options>();
    ASSERT_KELP(kelp_spring_options_defaults(&options));
    EXPECT_EQ(options.parts, nullptr);
    EXPECT_EQ(options.part_count, 0u);
    options.parts = list.data();
    options.part_count = static_cast<std::uint32_t>(list.size());
    kelp_spring spring = {};
    ASSERT_KELP(kelp_spring_create(assets.c, &options, nullptr, &spring));
    runtime::SpringOptions same;
    same.parts = list;
    runtime::Spring cpp = runtime::Spring::create(*assets.cpp, same).value();
    ASSERT_KELP(kelp_spring_push_away(spring, &instances.c[1], &player.x, 3));
    cpp.pushAway(instances.cpp[1], player, 3).value();
    for (int part = 0; part < 2; ++part) {
      std::array<kelp_swing, 64> swings = {};
      std::uint32_t count = 0;
      ASSERT_KELP(kelp_spring_get_swings(spring, part, swings.data(), 64, &count));
      for (std::size_t k = 0; k < count; ++k)
        expectSame(swings[k].offset, cpp.knots(part)[k].offset, "offset");
    }
    EXPECT_EQ(glm::length(cpp.knots(0)[2].offset) > 0, list != std::vector<std::int32_t>{1});
    EXPECT_KELP(KELP_OK, kelp_spring_destroy(spring));
    options.part_count = 0;
    EXPECT_KELP(KELP_ERROR_MISUSE, kelp_spring_create(assets.c, &options, nullptr, &spring));
    const std::int32_t absent[] = {0, 9};
    options.parts = absent;
    options.part_count = 2;
    EXPECT_KELP(KELP_ERROR_MISUSE, kelp_spring_create(assets.c, &options, nullptr, &spring));
    EXPECT_EQ(lastError().offset, 1u);
    options.parts = nullptr;
    EXPECT_KELP(KELP_ERROR_NULL, kelp_spring_create(assets.c, &options, nullptr, &spring));
    options.struct_size = kFirstSize;  // of the first version
    ASSERT_KELP(kelp_spring_create(assets.c, &options, nullptr, &spring));
    EXPECT_KELP(KELP_OK, kelp_spring_destroy(spring));
  }
}

TEST(CSpring, PushesNodesAsInCpp) {
  constexpr int kComb = 2;
  const BothAssets assets(packFile("cage"));
  BothSprings springs(assets, {.frequency = 2});
  BothPoses poses(assets);
  const kelp_instance in = instanceOf(assets.c, poses.c);
  const runtime::Instance same{&*assets.cpp, &poses.cpp};
  const glm::vec3 player = 0.5f * (runtime::bounds(same).min + runtime::bounds(same).max);
  ASSERT_KELP(kelp_spring_push_away(springs.c, &in, &player.x, 0.4f));
  springs.cpp.pushAway(same, player, 0.4f).value();
  const std::span<const runtime::Swing> expected = springs.cpp.nodes(kComb);
  std::vector<kelp_swing> swings(expected.size());
  std::uint32_t count = 0;
  ASSERT_KELP(kelp_spring_get_node_swings(springs.c, kComb, nullptr, 0, &count));
  ASSERT_EQ(expected.size(), count);
  ASSERT_KELP(kelp_spring_get_node_swings(springs.c, kComb, swings.data(), count, &count));
  EXPECT_EQ(std::memcmp(swings.data(), expected.data(), expected.size_bytes()), 0);
  EXPECT_TRUE(std::any_of(expected.begin(), expected.end(),
                          [](const runtime::Swing& swing) { return swing.offset != glm::vec3(0); }));
  ASSERT_KELP(kelp_spring_add_to(springs.c, poses.c));
  springs.cpp.addTo(poses.cpp).value();
  std::vector<glm::vec3> nodes(expected.size());
  ASSERT_KELP(kelp_pose_get_nodes(poses.c, kComb, &nodes[0].x, count, &count));
  const std::span<const glm::vec3> moved = std::as_const(poses.cpp).nodes(kComb);
  EXPECT_TRUE(std::equal(nodes.begin(), nodes.end(), moved.begin(), moved.end()));
  for (const std::int32_t part : {-1, 9})
    EXPECT_KELP(KELP_ERROR_MISUSE, kelp_spring_get_node_swings(springs.c, part, nullptr, 0, &count));
  EXPECT_KELP(KELP_ERROR_NULL, kelp_spring_get_node_swings(springs.c, kComb, nullptr, 1, &count));
  const BothAssets plain(packFile("distance"));
  const BothSprings uncaged(plain, {});
  ASSERT_KELP(kelp_spring_get_node_swings(uncaged.c, 0, nullptr, 0, &count));
  EXPECT_EQ(count, 0u);
  EXPECT_KELP(KELP_ERROR_NULL, kelp_spring_get_node_swings(uncaged.c, 0, nullptr, 1, &count));
}

}  // namespace
}  // namespace kelp::test
