// SPDX-License-Identifier: MIT
// Morph targets that are damaged, too many or of no use: an error or a notice.
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "import_scratch.h"
#include "kelp/bake/bake.h"

namespace kelp::bake {
namespace {

using namespace test;

// A box whose upper corners target 0 moves along x; the clip "move" has its weights.
struct BoxMorph {
  float along = 0.2f;
  std::size_t corners = 8;  // that the target has
  std::vector<float> weights{0, 1};
  std::string path = R"("path":"weights")";
  std::string names = R"("rise")";
  int copies = 1;      // targets, the same accessor again and again
  std::string second;  // animations
  bool animated = true;

  std::string text() const {
    GltfMaker maker;
    maker.addBox();
    std::vector<float> offsets;
    for (std::size_t corner = 0; corner < corners; ++corner)
      offsets.insert(offsets.end(), {corner & 2 ? along : 0, 0, 0});
    maker.floats(offsets, 3);
    maker.floats({0, 1}, 1);
    maker.floats(weights, 1);
    std::string targets;
    for (int i = 0; i < copies; ++i) targets += (i > 0 ? "," : "") + std::string(R"({"POSITION":2})");
    const std::string move =
        R"({"name":"move","samplers":[{"input":3,"output":4}],"channels":[{"sampler":0,"target":{"node":0,)" +
        path + "}}]}";
    return maker.text(
        R"("meshes":[{"name":"box","primitives":[{"attributes":{"POSITION":0},"indices":1,"targets":[)" +
        targets + R"(]}],"extras":{"targetNames":[)" + names + R"(]}}],"nodes":[{"name":"body","mesh":0}])" +
        (animated ? R"(,"animations":[)" + move + second + "]" : ""));
  }
};

class BadMorphs : public ::testing::Test {
 protected:
  RawPack baked(const BoxMorph& file, const std::function<void(Settings&)>& change = {}) {
    report = {};
    Settings settings;
    settings.resolution = 32;
    settings.resolution_given = true;
    settings.threads = 1;
    if (change) change(settings);
    RawPack pack = bake(scratch.write("m.gltf", file.text()), settings, report);
    std::vector<std::byte> bytes;
    const Result<void> written = writePack(pack, Sink::into(bytes));
    EXPECT_TRUE(written) << written.error().detail;
    return pack;
  }
  std::string refused(const BoxMorph& file) {
    return refusal(scratch.write("m.gltf", file.text()), Exit::kInvalid);
  }
  bool noted(const std::string& words) const { return anyContains(report.notices, words); }

  Scratch scratch;
  Report report;
};

TEST_F(BadMorphs, ASoundOneIsAPart) {
  const RawPack pack = baked({});
  ASSERT_EQ(pack.parts.size(), 3u);
  EXPECT_EQ(pack.parts[1].name, "scene");
  EXPECT_EQ(pack.parts[2].name, "rise");
  ASSERT_EQ(pack.parts[0].morphs.size(), 1u);
  EXPECT_EQ(pack.parts[0].morphs[0].part, 2u);
  ASSERT_EQ(pack.clips.size(), 1u);
  EXPECT_TRUE(report.notices.empty()) << report.notices[0];
  bool moves = false;
  for (const RawTrack& track : pack.clips[0].tracks) {
    EXPECT_EQ(track.part, 2u);
    moves = true;
    EXPECT_EQ(track.target, Target::kPartTranslation);
    EXPECT_NEAR(track.keys.front().value.x, 0, 2e-3);
    EXPECT_NEAR(track.keys.back().value.x, 1, 2e-3);
    EXPECT_EQ(track.keys.back().value.y, 0);
  }
  EXPECT_TRUE(moves);
}

TEST_F(BadMorphs, OtherSizesThanTheMesh) {
  BoxMorph file;
  file.corners = 7;
  EXPECT_TRUE(contains(refused(file), "morph target has 7 values for 8 vertices"));
}

TEST_F(BadMorphs, NumbersThatAreNone) {
  BoxMorph file;
  for (const float number :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    file.along = number;
    EXPECT_TRUE(contains(refused(file), "morph target that moves vertex 2 to no finite place"));
  }
}

TEST_F(BadMorphs, WeightsThatDoNotMatchTheTargets) {
  BoxMorph file;
  file.weights = {0, 1, 0};
  EXPECT_TRUE(baked(file).clips.empty());
  EXPECT_TRUE(noted("weights that do not match the mesh's morph targets"));
}

TEST_F(BadMorphs, ThoseThatMoveNothing) {
  BoxMorph file;
  for (const float along : {0.0f, 1e-4f, 1e30f}) {
    file.along = along;
    const RawPack pack = baked(file);
    EXPECT_EQ(pack.parts.size(), 2u) << along;
    EXPECT_EQ(pack.clips.size(), 1u) << along;  // it still is one
    EXPECT_TRUE(noted("are left out: 'rise'")) << along;
  }
}

TEST_F(BadMorphs, MoreThanAPackHolds) {
  BoxMorph file;
  file.copies = 4100;
  file.animated = false;
  const RawPack pack = baked(file);
  EXPECT_EQ(pack.parts.size(), 4001u);
  EXPECT_EQ(pack.parts[0].morphs.size(), 3999u);
  EXPECT_TRUE(noted("the file has 4100 morph targets, and a pack holds 3999"));
}

TEST_F(BadMorphs, NamesAreToldApartAndShortened) {
  BoxMorph file;
  file.copies = 4;
  file.weights = {0, 0, 0, 0, 1, 0.5f, 0, 0};
  file.names = R"("scene","m",5,")" + std::string(200, 'x') + "\"";
  const RawPack pack = baked(file);
  ASSERT_EQ(pack.parts.size(), 6u);
  EXPECT_EQ(pack.parts[0].name, "m");
  EXPECT_EQ(pack.parts[2].name, "scene.2");
  EXPECT_EQ(pack.parts[3].name, "m.2");
  EXPECT_EQ(pack.parts[4].name, "box.2");
  EXPECT_LE(pack.parts[5].name.size(), 83u);
}

TEST_F(BadMorphs, AnotherRigLeavesThemAsTheyRest) {
  const auto preset = [](Settings& s) { s.rig_preset = "none"; };
  EXPECT_EQ(baked({}, preset).parts.size(), 1u);
  EXPECT_TRUE(noted("morph targets, which are parts only without another rig"));
  EXPECT_EQ(baked({}, [](Settings& s) { s.parts = Parts::kNodes; }).parts.size(), 1u);
  EXPECT_TRUE(noted("morph targets, which are parts only without another rig"));
  const RawPack moment = baked({}, [](Settings& s) { s.at = {"move", 1}; });
  EXPECT_EQ(moment.parts.size(), 1u);
  EXPECT_GT(moment.parts[0].size.x, 2 * moment.parts[0].size.z - 2);  // as it is when the weight is 1
  EXPECT_TRUE(report.notices.empty());
}

// Two animations of one name that move the same weights are two clips.
TEST_F(BadMorphs, ClipsOfOneName) {
  BoxMorph file;
  file.second =
      R"(,{"name":"move","samplers":[{"input":3,"output":4}],"channels":[{"sampler":0,"target":{"node":0,"path":"weights"}}]})";
  const RawPack pack = baked(file);
  ASSERT_EQ(pack.clips.size(), 2u);
  EXPECT_EQ(pack.clips[1].name, "move.2");
}

}  // namespace
}  // namespace kelp::bake
