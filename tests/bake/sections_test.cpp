// SPDX-License-Identifier: MIT
// Widths and twists of a rig, from the file to the posed nodes of a cage.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include <fmt/format.h>

#include "baked_asset.h"
#include "import_scratch.h"
#include "kelp/rig/rig_file.h"

namespace kelp::bake::test {
namespace {

// 0.25 x 1 x 0.25 meters.
constexpr const char* kColumn =
    "v 0 0 0\nv .25 0 0\nv 0 1 0\nv .25 1 0\nv 0 0 .25\nv .25 0 .25\nv 0 1 .25\nv .25 1 .25\n"
    "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";

struct Sections : ::testing::Test {
  BakedAsset baked(const std::string& rig, const char* preset = nullptr) {
    Settings settings;
    if (preset)
      settings.rig_preset = preset;
    else
      settings.rig_file = scratch.write("column.json", rig);
    settings.cell = 4;
    return BakedAsset(scratch.write("column.obj", kColumn), settings, 128);
  }
  std::string refusalOf(const std::string& rig) {
    try {
      baked(rig);
    } catch (const ToolError& error) {
      return error.what();
    }
    return "";
  }
  // How wide a node is, and how far turned, over rest.
  template <class Expect>
  static void forNodes(const BakedAsset& asset, const runtime::Pose& pose, const Expect& expect) {
    const Part& part = asset.asset().pack().parts()[0];
    const glm::dvec3 middle(0.5 * part.size.x, 0, 0.5 * part.size.z);
    for (std::uint32_t i = 0; i < part.cages[0].nodes(); ++i) {
      const glm::dvec3 rest = glm::dvec3(part.cages[0].rest(i)) - middle,
                       now = glm::dvec3(pose.nodes(0)[i]) - middle;
      if (rest.x == 0 || rest.z == 0) continue;
      expect(rest, now, rest.y / part.size.y);
    }
  }
  const Scratch scratch;
};

TEST_F(Sections, AreAsTheRigSays) {
  const BakedAsset tower =
      baked(R"({"kelp": 1, "bend": "cage", "knots": [{"at": 0}, {"at": 0.5, "width": 1.2},
    {"at": 1, "twist": 60}], "clips": {"go": {"waves": [{"knot": 2, "width": [0.5, 0], "period": 4}]}}})");
  ASSERT_EQ(tower.pack().parts.size(), 2u);
  EXPECT_EQ(tower.pack().parts[1].name, tower.pack().parts[0].name + " sections");
  EXPECT_EQ(tower.pack().parts[0].sections, 1);
  runtime::Pose pose = *runtime::Pose::create(tower.asset());
  forNodes(tower, std::as_const(pose), [](const glm::dvec3& rest, const glm::dvec3& now, double h) {
    EXPECT_NEAR(std::hypot(now.x, now.z) / std::hypot(rest.x, rest.z), 1.2 - 0.4 * std::abs(h - 0.5), 0.002);
    const double turn = std::atan2(now.x, now.z) - std::atan2(rest.x, rest.z);
    EXPECT_NEAR(std::remainder(turn, 2 * M_PI), std::max(h - 0.5, 0.0) * 2 * M_PI / 3, 1e-3);
    EXPECT_NEAR(now.y, rest.y, 1e-3);
  });
  runtime::addClip(tower.asset(), *runtime::findClip(tower.asset(), "go"), 1, 1, pose).value();
  EXPECT_NEAR(pose.section(0, 2)->width.x, 1.5f, 1e-5f);
  EXPECT_NEAR(pose.section(0, 2)->width.y, 1, 1e-5f);
}

TEST_F(Sections, PresetsMoveThem) {
  for (const char* const preset : {"breathe", "twist"}) {
    const BakedAsset tower = baked("", preset);
    runtime::Pose pose = *runtime::Pose::create(tower.asset());
    runtime::addClip(tower.asset(), *runtime::findClip(tower.asset(), preset), 1, 1, pose).value();
    double widest = 0, farthest = 0;
    forNodes(tower, std::as_const(pose), [&](const glm::dvec3& rest, const glm::dvec3& now, double) {
      widest = std::max(widest, std::hypot(now.x, now.z) / std::hypot(rest.x, rest.z));
      farthest =
          std::max(farthest,
                   std::abs(std::remainder(std::atan2(now.x, now.z) - std::atan2(rest.x, rest.z), 2 * M_PI)));
    });
    EXPECT_NEAR(widest, preset[0] == 'b' ? 1.08 : 1, 0.01) << preset;
    EXPECT_NEAR(farthest, preset[0] == 'b' ? 0 : 1.57 * std::sin(M_PI / 3), 0.02) << preset;
  }
}

// The rig that kelp-dump prints bakes to the same pack.
TEST_F(Sections, ComeBackFromThePack) {
  const std::string rig = R"({"kelp": 1, "axis": "-y", "bend": "cage", "knots": [{"at": 0, "twist": 20},
    {"at": 0.5, "width": [1.2, 0.9], "keep_volume": true}, {"at": 1}],
    "clips": {"go": {"keys": [{"time": 0, "knot": 1, "width": 1}, {"time": 1, "knot": 1, "width": [1, 2]}]}}})";
  const BakedAsset first = baked(rig);
  const Pack& pack = first.asset().pack();
  const RiggedPack rigged(pack);
  EXPECT_FALSE(rigged.by_part);
  const RigFile file = describeParts(pack, rigged);
  ASSERT_EQ(file.parts.size(), 1u);
  const BakedAsset again = baked(printRig(file.parts[0].rig));
  RawPack packs[2] = {first.pack(), again.pack()};
  for (RawPack& raw : packs) raw.info_json.clear();  // it has the rig files' checksums
  EXPECT_EQ(kelp::test::bytesOf(packs[0]), kelp::test::bytesOf(packs[1]));
}

TEST_F(Sections, ThatMayCollapseAreNoted) {
  const auto notices = [&](const char* width) {
    return baked(
               fmt::format(R"({{"kelp": 1, "bend": "cage", "knots": [{{"at": 0}}, {{"at": 1, "width": 0.5}}],
      "clips": {{"go": {{"waves": [{{"knot": 1, "width": {}, "period": 2}}]}}}}}})",
                           width))
        .report.notices;
  };
  EXPECT_TRUE(notices("[0.4, -0.4]").empty());
  ASSERT_EQ(notices("[0.1, -0.5]").size(), 1u);
  EXPECT_NE(notices("[0.1, -0.5]")[0].find("knot 1 may collapse"), std::string::npos);
}

// Where nobody gives cells, they are small enough; where they cannot be, a notice says so.
TEST_F(Sections, ChooseTheirCells) {
  Settings settings;
  settings.rig_file = scratch.write(
      "column.json",
      R"({"kelp": 1, "bend": "cage", "knots": [{"at": 0}, {"at": 0.5, "width": 1.2}, {"at": 1}]})");
  const std::filesystem::path column = scratch.write("column.obj", kColumn);
  for (const int resolution : {60, 100, 128, 200}) {
    const BakedAsset baked(column, settings, resolution);
    EXPECT_TRUE(baked.report.notices.empty());
    const runtime::Pose pose = *runtime::Pose::create(baked.asset());
    double widest = 0;
    forNodes(baked, pose, [&](const glm::dvec3& rest, const glm::dvec3& now, double) {
      widest = std::max(widest, std::hypot(now.x, now.z) / std::hypot(rest.x, rest.z));
    });
    EXPECT_NEAR(widest, 1.2, 0.012) << resolution;
  }
  settings.rig_file = scratch.write(
      "turn.json", R"({"kelp": 1, "bend": "cage", "knots": [{"at": 0}, {"at": 1, "twist": 360}]})");
  EXPECT_TRUE(BakedAsset(column, settings, 128).report.notices.empty());
  const BakedAsset coarse(column, settings, 16);
  EXPECT_EQ(coarse.pack().parts[0].cell, 2);
  ASSERT_EQ(coarse.report.notices.size(), 1u);
  EXPECT_NE(coarse.report.notices[0].find("8 % narrower"), std::string::npos) << coarse.report.notices[0];
}

TEST_F(Sections, NeedACage) {
  EXPECT_NE(
      refusalOf(R"({"kelp": 1, "knots": [{"at": 0, "width": 2}, {"at": 1}]})").find("\"bend\": \"cage\""),
      std::string::npos);
}

}  // namespace
}  // namespace kelp::bake::test
