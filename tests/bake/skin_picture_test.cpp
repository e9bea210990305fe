// SPDX-License-Identifier: MIT
// Skins whose cages clips move, as the runtime poses them, in pictures beside the skinned triangles of a
// second reader; and beside bakes of the same moments.
#include <algorithm>
#include <span>
#include <utility>

#include "baked_asset.h"
#include "gltf_truth.h"
#include "kelp/formats/cage.h"
#include "support/all_tests.h"
#include "support/assets.h"

namespace kelp::bake::test {
namespace {

struct Silhouettes {
  double sum = 0, worst = 1;
  int count = 0;
  void add(double agreement) {
    sum += agreement;
    worst = std::min(worst, agreement);
    ++count;
  }
  double mean() const { return sum / count; }
  std::string text() const { return std::to_string(mean()) + ", worst " + std::to_string(worst); }
};

// Silhouettes at moments of every clip from some sides; their agreement with the triangles' is at least
// `mean` and `least`, and in the mean at most `loss` less than that of voxels of the posed mesh (--at). All:
// twelve moments and three sides. Otherwise `moments`, and one side each, by turns, in small pictures: their
// edges weigh more, and a second passes with each of the Fox's large ones.
void expectPictures(const std::filesystem::path& path, int node, int moments, double mean, double least,
                    double loss) {
  const GltfTruth truth(path);
  const BakedAsset baked(path, {}, 128);
  const bool all = kelp::test::allTests();
  if (all) moments = 12;
  Silhouettes caged, bare;
  for (int clip = 0; clip < static_cast<int>(baked.pack().clips.size()); ++clip) {
    const RawClip& playing = baked.pack().clips[static_cast<std::size_t>(clip)];
    Silhouettes its;
    for (int moment = 0; moment < kelp::test::shareOf(moments); ++moment) {
      const double time = static_cast<double>(playing.duration) * (moment + 0.5) / moments;
      runtime::Pose pose = *runtime::Pose::create(baked.asset());
      ASSERT_TRUE(runtime::addClip(baked.asset(), clip, time, 1, pose));
      Settings at;
      at.at = {playing.name, time};
      const BakedAsset still(path, at, 128);
      const std::vector<glm::dvec3> wanted = truth.worldCorners(node, clip, time);
      for (int side = 0; side < 3; ++side) {
        if (!all && side != (clip + moment) % 3) continue;
        const int pixels = all ? 160 : 100;
        bare.add(agreement(still, wanted, 45.0 * side, nullptr, pixels));
        const double agreed = agreement(baked, wanted, 45.0 * side, &pose, pixels);
        its.add(agreed);
        caged.add(agreed);
      }
    }
    ::testing::Test::RecordProperty(playing.name, its.text());
  }
  EXPECT_GT(caged.mean(), mean);
  EXPECT_GT(caged.worst, least);
  EXPECT_GT(caged.mean(), bare.mean() - loss);
  ::testing::Test::RecordProperty("all", caged.text());
  ::testing::Test::RecordProperty("bare", bare.text());
}

TEST(SkinPictures, Fox) {
  KELP_ASSET(path, "gltf/draco_testdata/Fox/Fox.gltf");
  expectPictures(path, 1, 1, 0.93, 0.9, 0.02);
}

TEST(SkinPictures, CesiumMan) {
  KELP_ASSET(path, "gltf/skinned/CesiumMan.glb");
  expectPictures(path, 1, 3, 0.94, 0.93, 0.01);
}

// Two rings of a long tube: the triangles between them are flat where the cage bends.
TEST(SkinPictures, RiggedSimple) {
  KELP_ASSET(path, "gltf/skinned/rigged_simple.gltf");
  expectPictures(path, 2, 3, 0.87, 0.72, 0.1);
}

TEST(SkinPictures, Greenman) {
  KELP_ASSET(path, "gltf/skinned/greenman.glb");
  expectPictures(path, 12, 1, 0.97, 0.96, 0.01);
}

// The arm is up. The joints' motions, blended by the weights of the armpit, turn its surface over: cells
// under it that only followed these would be inverted, and so empty.
TEST(SkinPictures, GreenmansArmpitIsWhole) {
  KELP_ASSET(path, "gltf/skinned/greenman.glb");
  for (const int resolution : {128, 256}) {
    const BakedAsset baked(path, {}, resolution);
    const RawPart& body = baked.pack().parts[0];
    CageMemory memory;
    const Result<Cage> made =
        makeCage(body.cages[0].source(), body.size, static_cast<int>(body.levels.size()), body.cell, 0,
                 nullptr, 1u << 30, memory);
    ASSERT_TRUE(made);
    const Cage& cage = *made;
    runtime::Pose pose = *runtime::Pose::create(baked.asset());
    ASSERT_TRUE(runtime::addClip(baked.asset(), 3, 0.52, 1, pose));
    const std::span<const glm::vec3> nodes = std::as_const(pose).nodes(0);
    int inverted = 0;
    for (std::uint32_t cell = 0; cell < cage.cells(); ++cell)
      for (const CageTetrahedron& one : kCageTetrahedra) {
        glm::dmat3 rest, posed;
        for (int i = 0; i < 3; ++i) {
          const std::uint32_t from = cage.node(cell, one.corners[0]),
                              to = cage.node(cell, one.corners[i + 1]);
          rest[i] = glm::dvec3(cage.rest(to) - cage.rest(from));
          posed[i] = glm::dvec3(nodes[to] - nodes[from]);
        }
        inverted += glm::determinant(rest) * glm::determinant(posed) <= 0;
      }
    EXPECT_LT(inverted, 0.003 * 6 * cage.cells()) << resolution;
  }
}

}  // namespace
}  // namespace kelp::bake::test
