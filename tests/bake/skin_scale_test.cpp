// SPDX-License-Identifier: MIT
// Joints that clips scale, as the runtime poses their parts, in pictures beside the skinned triangles of a
// second reader.
#include <algorithm>
#include <cmath>

#include "baked_asset.h"
#include "gltf_truth.h"
#include "import_scratch.h"

namespace kelp::bake::test {
namespace {

// The silhouettes of the nodes at a moment of a clip, from two sides.
double pictured(const BakedAsset& baked, const GltfTruth& truth, const std::vector<int>& nodes, int clip,
                double time) {
  runtime::Pose pose = *runtime::Pose::create(baked.asset());
  EXPECT_TRUE(runtime::addClip(baked.asset(), clip, time, 1, pose));
  std::vector<glm::dvec3> wanted;
  for (const int node : nodes) {
    const std::vector<glm::dvec3> its = truth.worldCorners(node, clip, time);
    wanted.insert(wanted.end(), its.begin(), its.end());
  }
  return std::min(agreement(baked, wanted, 0, &pose), agreement(baked, wanted, 60, &pose));
}

// A bar of which both joints are three times as thick in a clip, on a floor.
TEST(SkinScale, ABarGrows) {
  const std::filesystem::path path = std::filesystem::path(KELP_HUNT) / "anim_scale.glb";
  const GltfTruth truth(path);
  const BakedAsset baked(path, {}, 96);
  ASSERT_GE(baked.pack().clips.size(), 1u);
  for (std::size_t clip = 0; clip < baked.pack().clips.size(); ++clip)
    for (const double time : {0.0, 0.5, 0.99})
      EXPECT_GT(pictured(baked, truth, {2, 3}, static_cast<int>(clip), time), 0.93)
          << baked.pack().clips[clip].name << " at " << time;
}

// Two boxes, one above the other, rigid. The upper joint turns and becomes twice as large, then nothing.
TEST(SkinScale, APartVanishes) {
  GltfMaker maker;
  maker.addBox();
  const auto [joints, weights] = maker.addBoxWeights({1, 0}, {1, 0});
  const auto [upper, upper_weights] = maker.addBoxWeights({0, 1}, {0, 1});
  std::vector<float> binds;
  for (const float y : {0.0f, -2.2f})
    binds.insert(binds.end(), {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, y, 0, 1});
  std::vector<float> raised;
  for (int i = 0; i < 8; ++i)
    raised.insert(raised.end(), {i & 1 ? 0.1f : -0.1f, i & 2 ? 4.2f : 2.2f, i & 4 ? 0.1f : -0.1f});
  const int above = maker.floats(raised, 3), bind = maker.add(bytesOf(binds), 5126, 2, "MAT4"),
            times = maker.floats({0, 1, 2, 3}, 1),
            sizes = maker.floats({1, 1, 1, 2, 2, 2, 0, 0, 0, 0, 0, 0}, 3),
            turns = maker.floats({0, 0, 0, 1, 0, 0, 0.5f, std::sqrt(0.75f), 0, 0, 0, 1, 0, 0, 0, 1}, 4);
  const auto number = [](int n) { return std::to_string(n); };
  const auto primitive = [&](int position, int joint, int weight) {
    return R"({"attributes":{"POSITION":)" + number(position) + R"(,"JOINTS_0":)" + number(joint) +
           R"(,"WEIGHTS_0":)" + number(weight) + R"(},"indices":1})";
  };
  const Scratch scratch;
  const auto path = scratch.write(
      "vanish.gltf",
      maker.text(R"("scene":0,"scenes":[{"nodes":[0,1]}],"nodes":[{"mesh":0,"skin":0},{"name":"low",)"
                 R"("children":[2]},{"name":"high","translation":[0,2.2,0]}],"skins":[{"joints":[1,2],)"
                 R"("inverseBindMatrices":)" +
                 number(bind) + R"(}],"meshes":[{"primitives":[)" + primitive(0, joints, weights) + "," +
                 primitive(above, upper, upper_weights) +
                 R"(]}],"animations":[{"name":"go","samplers":[)"
                 R"({"input":)" +
                 number(times) + R"(,"output":)" + number(sizes) + R"(},{"input":)" + number(times) +
                 R"(,"output":)" + number(turns) +
                 R"(}],"channels":[{"sampler":0,"target":{"node":2,"path":"scale"}},)"
                 R"({"sampler":1,"target":{"node":2,"path":"rotation"}}]}])"));
  const GltfTruth truth(path);
  const BakedAsset baked(path, {}, 256);
  for (const double time : {0.0, 0.6, 1.0, 1.5, 1.9, 2.5})
    EXPECT_GT(pictured(baked, truth, {0}, 0, time), 0.9) << time;
}

}  // namespace
}  // namespace kelp::bake::test
