// SPDX-License-Identifier: MIT
// Files with morph targets (tests/cli/morph_files.py), baked at 128 voxels, beside their morphed and skinned
// meshes as a second reader has them.
#include <algorithm>
#include <set>

#include "import_scratch.h"
#include "kelp/runtime/asset.h"
#include "kelp/runtime/pose.h"
#include "morphed_pack.h"
#include "support/test_pack.h"

namespace kelp::bake::test {
namespace {

std::filesystem::path fileNamed(const std::string& name) {
  return std::filesystem::path(KELP_MORPH_FILES) / (name + ".gltf");
}

std::vector<std::string> morphsOf(const MorphedPack& baked) {
  std::vector<std::string> names;
  for (const RawMorph& morph : baked.body().morphs) names.push_back(baked.pack.parts.at(morph.part).name);
  return names;
}

// Parts and offsets as the format wants them; the report says how well each fits.
void expectSound(const MorphedPack& baked) {
  std::uint32_t last = 0;
  std::set<std::string> names;
  for (const RawPart& part : baked.pack.parts) EXPECT_TRUE(names.insert(part.name).second) << part.name;
  for (const RawMorph& morph : baked.body().morphs) {
    EXPECT_GT(morph.part, last);
    last = morph.part;
    const RawPart& part = baked.pack.parts.at(morph.part);
    EXPECT_EQ(part.parent, -1);
    EXPECT_EQ(part.size, glm::ivec3(1));
    EXPECT_TRUE(part.levels.empty());
    EXPECT_EQ(part.to_object, baked.body().to_object);
    ASSERT_GT(morph.step, 0);
    ASSERT_FALSE(morph.nodes.empty());
    ASSERT_EQ(morph.nodes.size(), morph.offsets.size());
    EXPECT_LT(morph.nodes.back(), baked.body().influences.size());
    for (std::size_t i = 0; i < morph.nodes.size(); ++i) {
      if (i > 0) {
        ASSERT_LT(morph.nodes[i - 1], morph.nodes[i]);
      }
      const glm::ivec3 by = glm::abs(morph.offsets[i]);
      ASSERT_LE(std::max({by.x, by.y, by.z}), 32767);
    }
    const Report::Part& line = baked.report.parts.at(morph.part);
    EXPECT_EQ(line.rig_origin, "morph target");
    EXPECT_FALSE(line.fit.joint.empty());
    EXPECT_LE(line.fit.mean, 0.3) << part.name;
    EXPECT_LE(line.fit.p95, 1) << part.name;
  }
}

// The morphed meshes in all clips: within 0.3 voxel in the mean of what moves.
void expectClips(const MorphedPack& baked, const std::vector<int>& nodes) {
  constexpr int kMoments = 16;
  for (std::size_t clip = 0; clip < baked.pack.clips.size(); ++clip) {
    const RawClip& playing = baked.pack.clips[clip];
    double mean = 0;
    for (int moment = 0; moment <= kMoments; ++moment) {
      const double time = static_cast<double>(playing.duration) * moment / kMoments;
      const double far = baked.farAt(nodes, static_cast<int>(clip), time);
      EXPECT_LE(far, 0.6) << playing.name << " at " << time;
      mean += far / (kMoments + 1);
    }
    EXPECT_LE(mean, 0.3) << playing.name;
    ::testing::Test::RecordProperty(playing.name, std::to_string(mean));
  }
}

// The runtime puts nodes where the pack's numbers say.
void expectPoses(const MorphedPack& baked) {
  const std::vector<std::byte> bytes = kelp::test::bytesOf(baked.pack);
  const MemorySource source(bytes);
  const auto asset = runtime::Asset::open(source.source());
  ASSERT_TRUE(asset) << asset.error().detail;
  const glm::dmat4 to_object(glm::dmat4x3(baked.body().to_object));
  const double voxel = glm::length(to_object[0]);
  for (int clip = 0; clip < static_cast<int>(baked.pack.clips.size()); ++clip)
    for (const double share : {0.2, 0.55, 0.9}) {
      const double time =
          share * static_cast<double>(baked.pack.clips[static_cast<std::size_t>(clip)].duration);
      runtime::Pose pose = *runtime::Pose::create(**asset);
      ASSERT_TRUE(runtime::addClip(**asset, clip, time, 1, pose));
      const std::vector<glm::dvec3> wanted = baked.nodesAt(clip, time);
      const std::span<const glm::vec3> nodes = std::as_const(pose).nodes(0);
      ASSERT_EQ(nodes.size(), wanted.size());
      for (std::size_t n = 0; n < wanted.size(); ++n)
        ASSERT_LT(glm::distance(glm::dvec3(to_object * glm::dvec4(nodes[n], 1)), wanted[n]), 0.01 * voxel)
            << clip << " at " << time;
    }
}

TEST(MorphFiles, Stress) {
  const MorphedPack baked(fileNamed("stress"));
  expectSound(baked);
  EXPECT_EQ(morphsOf(baked), (std::vector<std::string>{"Key 1", "Key 2", "Key 3", "Key 4", "Key 5", "Key 6",
                                                       "Key 7", "Key 8"}));
  ASSERT_EQ(baked.pack.clips.size(), 3u);
  EXPECT_EQ(baked.pack.clips[1].name, "TheWave");
  EXPECT_EQ(baked.pack.clips[1].duration, 4);
  expectClips(baked, {0});
  for (std::size_t k = 0; k < 8; ++k)
    EXPECT_LE(baked.farAlone({0}, baked.named("Key " + std::to_string(k + 1)), k, 8), 0.3) << k;
  EXPECT_TRUE(baked.report.notices.empty());
  expectPoses(baked);
}

TEST(MorphFiles, Skinned) {
  const MorphedPack baked(fileNamed("skinned"));
  expectSound(baked);
  EXPECT_EQ(morphsOf(baked), (std::vector<std::string>{"bulge", "lean"}));
  EXPECT_EQ(baked.pack.joints.size(), 4u);
  expectClips(baked, {0});
  expectPoses(baked);
}

TEST(MorphFiles, SparseOnesWithoutNamesOrClips) {
  const MorphedPack baked(fileNamed("sparse"));
  expectSound(baked);
  EXPECT_EQ(morphsOf(baked), (std::vector<std::string>{"mesh0.0", "mesh0.1"}));
  for (std::size_t k = 0; k < 2; ++k)
    EXPECT_LE(baked.farAlone({0}, baked.named("mesh0." + std::to_string(k)), k, 2), 0.3);
}

// Weights are counted from those at rest, which the voxels have.
TEST(MorphFiles, Resting) {
  const MorphedPack baked(fileNamed("resting"));
  expectSound(baked);
  expectClips(baked, {0});
  EXPECT_LE(baked.farAlone({0}, baked.named("shear"), 0, 2, {0.5, -0.25}), 0.3);
  EXPECT_TRUE(anyContains(baked.report.notices, "'shear' 0.5, 'swell' -0.25"));
}

// Lips that touch go apart: no cell holds both.
TEST(MorphFiles, SurfacesThatTouchGoApart) {
  const MorphedPack baked(fileNamed("jaws"));
  expectSound(baked);
  EXPECT_FALSE(baked.body().cages[0].split_points.empty());
  EXPECT_LE(baked.farAlone({0}, baked.named("open"), 0, 1), 0.3);
}

TEST(MorphFiles, ThoseOfOneNameThatMoveAlikeAreOne) {
  const MorphedPack baked(fileNamed("pair"));
  expectSound(baked);
  EXPECT_EQ(morphsOf(baked), (std::vector<std::string>{"smile", "blink", "blink.2"}));
  expectClips(baked, {0, 1});
  EXPECT_LE(baked.farAlone({0, 1}, baked.named("smile"), 0, 2), 0.3);
  EXPECT_LE(baked.farAlone({0}, baked.named("blink"), 1, 2), 0.3);
  EXPECT_LE(baked.farAlone({1}, baked.named("blink.2"), 1, 2), 0.3);
}

}  // namespace
}  // namespace kelp::bake::test
