// SPDX-License-Identifier: MIT
// Skins as parts that clips move, as the runtime poses them, in pictures beside the skinned triangles of a
// second reader.
#include <algorithm>

#include "baked_asset.h"
#include "gltf_truth.h"
#include "support/all_tests.h"
#include "support/assets.h"

namespace kelp::bake::test {
namespace {

// Silhouettes at moments of every clip from some sides. All: twelve moments and three sides. Otherwise
// `moments`, and one side each, by turns, in small pictures: their edges weigh more, and a second passes with
// each of the Fox's large ones.
void expectPictures(const std::filesystem::path& path, int node, int moments, double mean, double least) {
  const GltfTruth truth(path);
  const BakedAsset baked(path, {}, 128);
  const bool all = kelp::test::allTests();
  if (all) moments = 12;
  double sum = 0, worst = 1;
  int pictures = 0;
  for (int clip = 0; clip < static_cast<int>(baked.pack().clips.size()); ++clip) {
    const RawClip& playing = baked.pack().clips[static_cast<std::size_t>(clip)];
    double clip_sum = 0, clip_worst = 1;
    int clip_pictures = 0;
    for (int moment = 0; moment < kelp::test::shareOf(moments); ++moment) {
      const double time = static_cast<double>(playing.duration) * (moment + 0.5) / moments;
      runtime::Pose pose = *runtime::Pose::create(baked.asset());
      ASSERT_TRUE(runtime::addClip(baked.asset(), clip, time, 1, pose));
      const std::vector<glm::dvec3> wanted = truth.worldCorners(node, clip, time);
      for (int side = 0; side < 3; ++side) {
        if (!all && side != (clip + moment) % 3) continue;
        const double its = agreement(baked, wanted, 45.0 * side, &pose, all ? 160 : 100);
        clip_sum += its;
        clip_worst = std::min(clip_worst, its);
        ++clip_pictures;
      }
    }
    sum += clip_sum;
    worst = std::min(worst, clip_worst);
    pictures += clip_pictures;
    ::testing::Test::RecordProperty(
        playing.name, std::to_string(clip_sum / clip_pictures) + ", worst " + std::to_string(clip_worst));
  }
  EXPECT_GT(sum / pictures, mean);
  EXPECT_GT(worst, least);
  ::testing::Test::RecordProperty("all", std::to_string(sum / pictures) + ", worst " + std::to_string(worst));
}

TEST(SkinPictures, Fox) {
  KELP_ASSET(path, "gltf/draco_testdata/Fox/Fox.gltf");
  expectPictures(path, 1, 1, 0.92, 0.85);
}

TEST(SkinPictures, CesiumMan) {
  KELP_ASSET(path, "gltf/skinned/CesiumMan.glb");
  expectPictures(path, 1, 3, 0.92, 0.85);
}

TEST(SkinPictures, RiggedSimple) {
  KELP_ASSET(path, "gltf/skinned/rigged_simple.gltf");
  expectPictures(path, 2, 3, 0.92, 0.85);
}

// Its arms stretch like rubber, which rigid parts cannot.
TEST(SkinPictures, Greenman) {
  KELP_ASSET(path, "gltf/skinned/greenman.glb");
  expectPictures(path, 12, 1, 0.85, 0.75);
}

}  // namespace
}  // namespace kelp::bake::test
