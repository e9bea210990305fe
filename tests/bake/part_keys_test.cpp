// SPDX-License-Identifier: MIT
// Keys that move parts, beyond what a pack can hold.
#include <cmath>

#include "import_scratch.h"
#include "support/test_pack.h"

namespace kelp::bake::test {
namespace {

// A node that is animated on one path, in keys 0 and 1 s.
std::string animated(const std::string& path, const std::vector<float>& values, int width,
                     const std::string& node = "") {
  GltfMaker maker;
  maker.addBox();
  const int times = maker.floats({0, 1}, 1), keys = maker.floats(values, width);
  return maker.text(
      GltfMaker::boxMesh() + R"(,"nodes":[{"name":"a","mesh":0)" + node +
      R"(}],"animations":[{"name":"go","samplers":[{"input":)" + std::to_string(times) + R"(,"output":)" +
      std::to_string(keys) +
      (values.size() == 6u * static_cast<std::size_t>(width) ? R"(,"interpolation":"CUBICSPLINE")" : "") +
      R"(}],"channels":[{"sampler":0,"target":{"node":0,"path":")" + path + R"("}}]}])");
}

TEST(PartKeys, TurnsOfAnyLengthAreUnitQuaternions) {
  const Scratch scratch;
  Settings settings;
  settings.parts = Parts::kNodes;
  settings.resolution = 8;
  const auto baked = [&](const std::vector<float>& turns) {
    Report report;
    RawPack pack = bake::bake(scratch.write("m.gltf", animated("rotation", turns, 4)), settings, report);
    EXPECT_FALSE(kelp::test::bytesOf(pack).empty());  // the writer takes it
    return pack;
  };
  const float half = std::sqrt(0.5f);
  for (const float length : {1e-20f, 3.0f, 1e30f}) {
    const RawPack linear = baked({0, 0, 0, 0, 0, length, 0, length});
    const RawPack cubic =
        baked({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, length, 0, 0, 0, length, 0, length, 0, length, 0, 0});
    for (const RawPack* pack : {&linear, &cubic}) {
      ASSERT_EQ(pack->clips.size(), 1u);
      const std::vector<Key>& keys = pack->clips[0].tracks.at(0).keys;
      ASSERT_EQ(keys.size(), 2u);
      EXPECT_EQ(keys[0].value, glm::vec4(0, 0, 0, 1));
      EXPECT_LT(glm::length(keys[1].value - glm::vec4(0, half, 0, half)), 1e-6f);
    }
    EXPECT_LT(glm::length(cubic.clips[0].tracks[0].keys[1].in - glm::vec4(0, half, 0, 0)), 1e-6f);
  }
}

TEST(PartKeys, MotionsBeyondFloatsAreRefused) {
  const Scratch scratch;
  Settings settings;
  settings.parts = Parts::kNodes;
  settings.resolution = 8;
  for (const std::vector<float>& scales :
       {std::vector<float>{1, 1, 1, 1, 3e38f, 1},
        std::vector<float>{0, 0, 0, 1, 1, 1, 0, 0, 0, 0, -3e38f, 0, 1, 1, 1, 0, 0, 0}}) {
    const std::filesystem::path path =
        scratch.write("m.gltf", animated("scale", scales, 3, R"(,"scale":[1,0.01,1])"));
    try {
      Report report;
      bake::bake(path, settings, report);
      ADD_FAILURE() << "baked";
    } catch (const ToolError& error) {
      EXPECT_EQ(error.exit, Exit::kInvalid);
      for (const char* word : {"m.gltf", "'a'", "clip 'go'", " 1 s "})
        EXPECT_TRUE(contains(error.what(), word)) << error.what();
    }
  }
}

}  // namespace
}  // namespace kelp::bake::test
