// SPDX-License-Identifier: MIT
// Files with skins, baked to packs: how well their cages fit, at 128 voxels and at 48.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "kelp/bake/bake.h"
#include "kelp/fields/fields.h"
#include "support/assets.h"

namespace kelp::bake {
namespace {

struct Baked {
  Report report;
  RawPack pack;
  explicit Baked(const std::filesystem::path& path, int resolution = 128, const char* rig = nullptr) {
    Settings settings;
    settings.resolution = resolution;
    settings.resolution_given = true;
    if (rig) settings.rig_preset = rig;
    settings.threads = 1;
    pack = bake(path, settings, report);
  }
  const RawPart& body() const { return pack.parts.at(0); }
};

std::size_t bytesOf(const RawPack& pack) {
  std::vector<std::byte> bytes;
  EXPECT_TRUE(writePack(pack, Sink::into(bytes)));
  return bytes.size();
}

void expectFits(const Baked& baked, std::size_t clips, double mean, double p95) {
  std::set<std::string> names;
  for (const Report::Clip& clip : baked.report.clips) {
    names.insert(clip.name);
    EXPECT_FALSE(clip.fit.joint.empty()) << clip.name;
    EXPECT_LE(clip.fit.mean, mean) << clip.name;
    EXPECT_LE(clip.fit.p95, p95) << clip.name;
    EXPECT_LE(clip.fit.p95, clip.fit.max) << clip.name;
    EXPECT_TRUE(clip.moves);
    EXPECT_FALSE(clip.bends);
  }
  EXPECT_EQ(names.size(), clips);
  EXPECT_EQ(baked.pack.clips.size(), clips);
}

// The voxels of one part, and an empty part for each joint.
void expectBody(const Baked& baked, const Baked& plain, std::size_t joints) {
  ASSERT_EQ(plain.pack.parts.size(), 1u);
  ASSERT_EQ(baked.pack.parts.size(), 1 + joints);
  ASSERT_EQ(baked.pack.joints.size(), joints);
  const RawPart &body = baked.body(), &same = plain.body();
  // These files rest in their bind poses, to float precision.
  EXPECT_EQ(body.size, same.size);
  for (int column = 0; column < 4; ++column)
    EXPECT_LT(glm::distance(body.to_object[column], same.to_object[column]),
              1e-4f * glm::length(same.to_object[0]) * static_cast<float>(same.size.y));
  ASSERT_EQ(body.levels.size(), same.levels.size());
  const std::vector<std::uint8_t> solid = fields::occupancyOf(body.levels[0], body.size).solid,
                                  wanted = fields::occupancyOf(same.levels[0], same.size).solid;
  std::size_t differ = 0, count = 0;
  for (std::size_t i = 0; i < solid.size(); ++i) {
    differ += solid[i] != wanted[i];
    count += wanted[i];
  }
  EXPECT_LE(differ, count / 1000);
  EXPECT_EQ(body.cages.size(), body.levels.size());
  EXPECT_EQ(baked.report.parts[0].cell, body.cell);
  std::set<std::string> names;
  for (std::size_t p = 0; p < baked.pack.parts.size(); ++p) {
    EXPECT_TRUE(names.insert(baked.pack.parts[p].name).second) << baked.pack.parts[p].name;
    EXPECT_EQ(baked.pack.parts[p].levels.empty(), p > 0);
    EXPECT_EQ(baked.report.parts[p].empty, p > 0);
    EXPECT_EQ(baked.report.parts[p].rig_origin, "skin");
    EXPECT_LT(baked.pack.parts[p].parent, static_cast<int>(p));
    EXPECT_NE(baked.pack.parts[p].parent, 0);
    if (p > 0) {
      EXPECT_EQ(baked.pack.joints[p - 1].parts, std::vector<std::uint32_t>{static_cast<std::uint32_t>(p)});
    }
  }
  for (const Influences& node : body.influences)
    for (int i = 0; i < 4; ++i) {
      if (node.weights[i] == 0) continue;
      ASSERT_GE(node.parts[i], 1);
      ASSERT_LE(node.parts[i], joints);
    }
}

void expectSkin(const std::filesystem::path& path, std::size_t joints, std::size_t clips) {
  for (const int resolution : {128, 48}) {
    SCOPED_TRACE(resolution);
    const Baked baked(path, resolution);
    expectBody(baked, Baked(path, resolution, "none"), joints);
    if (resolution == 128)
      expectFits(baked, clips, 0.3, 1.0);
    else
      expectFits(baked, clips, 0.4, 1.5);
  }
}

TEST(SkinnedFiles, Fox) {
  KELP_ASSET(path, "gltf/draco_testdata/Fox/Fox.gltf");
  expectSkin(path, 24, 3);
  EXPECT_LE(bytesOf(Baked(path).pack), 60000u);
}

TEST(SkinnedFiles, CesiumMan) {
  KELP_ASSET(path, "gltf/skinned/CesiumMan.glb");
  expectSkin(path, 19, 1);
  const Baked baked(path);
  EXPECT_TRUE(std::any_of(baked.report.notices.begin(), baked.report.notices.end(), [](const auto& notice) {
    return notice.find("do not sum to one") != std::string::npos;
  }));
}

TEST(SkinnedFiles, Greenman) {
  KELP_ASSET(path, "gltf/skinned/greenman.glb");
  expectSkin(path, 12, 4);
  const Baked baked(path);
  ASSERT_EQ(baked.pack.sockets.size(), 3u);
  for (const RawSocket& socket : baked.pack.sockets)
    if (socket.name == "hat") {
      EXPECT_EQ(baked.pack.parts[socket.part].name, "socket_hat");
    }
}

TEST(SkinnedFiles, RiggedSimple) {
  KELP_ASSET(path, "gltf/skinned/rigged_simple.gltf");
  expectSkin(path, 2, 1);
  // The same if the skin is asked for.
  const Baked asked(path, 128, kSkinRig), baked(path);
  EXPECT_EQ(asked.body().influences, baked.body().influences);
}

TEST(SkinnedFiles, CellsMayBeChosen) {
  KELP_ASSET(path, "gltf/skinned/rigged_simple.gltf");
  Settings settings;
  settings.resolution = 64;
  settings.cell = 4;
  Report report;
  EXPECT_EQ(bake(path, settings, report).parts[0].cell, 4);
  settings.caged = true;
  settings.bend = Bend::kSweep;
  settings.cell.reset();
  EXPECT_EQ(bake(path, settings, report).parts[0].cell, 16);
}

}  // namespace
}  // namespace kelp::bake
