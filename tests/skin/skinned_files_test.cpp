// SPDX-License-Identifier: MIT
// Files with skins, baked to packs.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "kelp/bake/bake.h"
#include "kelp/common/dense_index.h"
#include "support/assets.h"

namespace kelp::bake {
namespace {

struct Baked {
  Report report;
  RawPack pack;
  explicit Baked(const std::filesystem::path& path, const char* rig = nullptr) {
    Settings settings;
    if (rig) settings.rig_preset = rig;
    settings.threads = 1;
    pack = bake(path, settings, report);
  }
};

// Of the pack in a file.
std::size_t bytesOf(const RawPack& pack) {
  std::size_t bytes = 0;
  const Sink sink{[](void* user, std::span<const std::byte> piece) {
                    *static_cast<std::size_t*>(user) += piece.size();
                    return Result<void>();
                  },
                  &bytes};
  EXPECT_TRUE(writePack(pack, sink));
  return bytes;
}

bool isSwept(const Report::Part& part) { return part.swept; }

// Checks the fit of the worst clip at 128 voxels; `mean` and `p95` are in voxels.
void expectFit(const Baked& baked, double mean, double p95, std::size_t clips) {
  std::set<std::string> names;
  for (const Report::Clip& clip : baked.report.clips) {
    names.insert(clip.name);
    EXPECT_FALSE(clip.fit.joint.empty()) << clip.name;
    EXPECT_LE(clip.fit.mean, mean) << clip.name;
    EXPECT_LE(clip.fit.p95, p95) << clip.name;
    EXPECT_LE(clip.fit.p95, clip.fit.max) << clip.name;
    EXPECT_TRUE(clip.moves);
  }
  EXPECT_EQ(names.size(), clips);
  EXPECT_EQ(baked.pack.clips.size(), clips);
  // Clips that move knots bend.
  for (const Report::Clip& clip : baked.report.clips)
    EXPECT_EQ(clip.bends,
              std::any_of(baked.report.parts.begin(), baked.report.parts.end(),
                          [&](const auto& part) { return isSwept(part) && part.name == clip.part; }));
}

std::uint64_t solidVoxels(const Report& report) {
  std::uint64_t sum = 0;
  for (const Report::Part& part : report.parts) sum += part.solid_voxels;
  return sum;
}

TEST(SkinnedFiles, FoxFits) {
  KELP_ASSET(path, "gltf/draco_testdata/Fox/Fox.gltf");
  const Baked baked(path);
  expectFit(baked, 1.0, 3.3, 3);
  EXPECT_GE(baked.report.parts.size(), 15u);
  EXPECT_LE(baked.report.parts.size(), 44u);
  std::set<std::string> names;
  int roots = 0;
  for (const Report::Part& part : baked.report.parts) {
    EXPECT_TRUE(names.insert(part.name).second) << part.name;
    EXPECT_EQ(part.rig_origin, "skin");
    roots += part.parent.empty();
  }
  EXPECT_EQ(roots, 1);
  EXPECT_EQ(names.count("b_Head_05"), 1u);
  EXPECT_EQ(baked.report.parts[0].triangles, 576u);
  // The bytes that its clips take in a pack.
  RawPack still = baked.pack;
  still.clips.clear();
  EXPECT_LE(bytesOf(baked.pack) - bytesOf(still), 30000u);
  // The same voxels as in one part, and those that parts share.
  const Baked plain(path, "none");
  ASSERT_EQ(plain.report.parts.size(), 1u);
  EXPECT_GT(solidVoxels(baked.report), solidVoxels(plain.report));
  EXPECT_TRUE(plain.pack.clips.empty());
  EXPECT_TRUE(plain.report.clips.empty());
}

std::vector<std::string> sweptParts(const Report& report) {
  std::vector<std::string> names;
  for (const Report::Part& part : report.parts)
    if (isSwept(part)) names.push_back(part.name);
  return names;
}

// Its tail is one; the limbs stay rigid.
TEST(SkinnedFiles, FoxHasASweptTail) {
  KELP_ASSET(path, "gltf/draco_testdata/Fox/Fox.gltf");
  const std::vector<std::string> swept = sweptParts(Baked(path).report);
  EXPECT_EQ(std::count(swept.begin(), swept.end(), "b_Tail01_012"), 1);
  for (const std::string& name : swept) EXPECT_EQ(name.find("Leg"), std::string::npos) << name;
}

TEST(SkinnedFiles, CesiumManFits) {
  KELP_ASSET(path, "gltf/skinned/CesiumMan.glb");
  const Baked baked(path);
  expectFit(baked, 1.0, 3.3, 1);
  EXPECT_TRUE(std::any_of(baked.report.notices.begin(), baked.report.notices.end(), [](const auto& notice) {
    return notice.find("do not sum to one") != std::string::npos;
  }));
}

TEST(SkinnedFiles, GreenmanFits) {
  KELP_ASSET(path, "gltf/skinned/greenman.glb");
  const Baked baked(path);
  expectFit(baked, 2.3, 6.5, 4);
  // Its empty on the head follows that; two others, which the file moves far away in its clips, are reported.
  ASSERT_EQ(baked.pack.sockets.size(), 3u);
  for (const RawSocket& socket : baked.pack.sockets)
    if (socket.name == "hat") {
      EXPECT_EQ(baked.pack.parts[socket.part].name, "body_up");
    }
  EXPECT_EQ(std::count_if(baked.report.notices.begin(), baked.report.notices.end(),
                          [](const auto& notice) { return notice.rfind("socket '", 0) == 0; }),
            2);
}

TEST(SkinnedFiles, RiggedSimpleFits) {
  KELP_ASSET(path, "gltf/skinned/rigged_simple.gltf");
  const Baked baked(path);
  expectFit(baked, 0.5, 2.0, 1);
  // The same parts if the skin is asked for.
  const Baked asked(path, kSkinRig);
  ASSERT_EQ(asked.pack.parts.size(), baked.pack.parts.size());
  for (std::size_t p = 0; p < asked.pack.parts.size(); ++p)
    EXPECT_EQ(asked.pack.parts[p].levels[0].codes, baked.pack.parts[p].levels[0].codes);
}

}  // namespace
}  // namespace kelp::bake
