// SPDX-License-Identifier: MIT
// The voxels that the two halves of a tube share: as many as their seam opens.
#include "share.h"

#include <cmath>

#include <gtest/gtest.h>

#include "kelp/common/dense_index.h"
#include "kelp/fields/fields.h"
#include "skin_shapes.h"

namespace kelp::bake {
namespace {

// Two joints, and a part for each; the upper one moves by `upper` at the end of the only clip.
struct Halves {
  test::SkinnedShape shape;
  SkinSpace space;
  SkinSamples samples;
  SkinLabels labels;
  PartTree tree;
  std::vector<SeamSteps> seams;
  VoxelOwners owners;
  std::vector<VoxelGrid> grids;

  explicit Halves(const glm::dmat4& upper) : shape(test::tube(2)), space(skinSpace(shape.frame)) {
    shape.voxelizeWhole();
    SourceSkin::Clip clip{"move", 1, {0, 1}, {}};
    for (const glm::dmat4& motion : {glm::dmat4(1), glm::dmat4(1), glm::dmat4(1), upper})
      clip.motions.emplace_back(motion);
    shape.skin().clips = {clip};
    samples = makeSkinSamples(shape.soup(), shape.skin(), space);
    const SkinMoments moments = judgedMoments(shape.skin(), samples, space, 1);
    labels.joints = {0, 1};
    labels.chains.resize(2);
    for (const glm::dvec3& at : samples.positions) labels.parts.push_back(at.y > 64);
    tree = hangParts(samples, shape.skin(), space, labels);
    seams = stepsAtSeams(samples, moments, space, labels, tree);
    owners = shareVoxels(samples, space, labels, shape.whole, 1);
    grids = cutGrids(space, tree, seams, owners, shape.whole, nullptr, 1);
  }
  double widestOpening() const {
    double widest = 0;
    for (const SeamSteps::Place& place : seams.at(0).places)
      widest = std::max(widest, seams[0].opening(place, place.at));
    return widest;
  }
  // The other part's voxels that a part has, in the whole.
  std::vector<glm::ivec3> sharedBy(std::size_t part) const {
    const VoxelGrid& grid = grids[part];
    const glm::ivec3 low(
        glm::round((grid.to_node[3] - shape.whole.to_node[3]) / glm::length(grid.to_node[0])));
    std::vector<glm::ivec3> voxels;
    for (std::size_t i = 0; i < grid.solid.size(); ++i) {
      const glm::ivec3 at = voxelAt(grid.size, i) + low;
      if (grid.solid[i] && owners.owner[denseIndex(shape.whole.size, at)] != part) voxels.push_back(at);
    }
    return voxels;
  }
  // How many columns of voxels the tube has, and in how many of them the part has those of the other.
  std::pair<std::size_t, std::size_t> columns(std::size_t part) const {
    const glm::ivec3 size = shape.whole.size;
    std::vector<bool> shared(static_cast<std::size_t>(size.x * size.z), false);
    for (const glm::ivec3& at : sharedBy(part)) shared[static_cast<std::size_t>(at.x + size.x * at.z)] = true;
    std::size_t all = 0;
    for (int z = 0; z < size.z; ++z)
      for (int x = 0; x < size.x; ++x) all += shape.whole.solid[denseIndex(size, {x, size.y / 2, z})] != 0;
    return {all, static_cast<std::size_t>(std::count(shared.begin(), shared.end(), true))};
  }
};

glm::dmat4 moved(const glm::dvec3& by) { return glm::translate(glm::dmat4(1), by); }

// 10 voxels a unit. Apart, a part has its neighbor's voxels as far as half the opening, and one more.
TEST(SkinShare, ClosesWhatOpens) {
  const Halves apart(moved({0, 1, 0})), together(moved({0, -1, 0}));
  ASSERT_EQ(apart.seams.size(), 1u);
  for (const SeamSteps::Place& place : apart.seams[0].places) {
    EXPECT_GT(place.across.y, 0.99);
    EXPECT_NEAR(place.at.y - 64, 0, 4);
  }
  // The halves of a tube that is stretched evenly move apart by less than its ends do.
  EXPECT_GT(apart.widestOpening(), 3);
  EXPECT_LT(apart.widestOpening(), 10);
  EXPECT_EQ(together.widestOpening(), 0);
  for (const std::size_t part : {0, 1}) {
    const double layers =
        static_cast<double>(apart.sharedBy(part).size()) / static_cast<double>(apart.columns(part).first);
    EXPECT_NEAR(layers, 0.5 * apart.widestOpening() + 0.5, 0.6);
    EXPECT_EQ(together.sharedBy(part).size(), together.columns(part).first);  // one layer
  }
}

// Where a part's edge itself stands out, what closes a gap may as well; but no more than that.
TEST(SkinShare, GapsBesideStepsAreClosed) {
  const Halves both(moved({0.6, 0.8, 0})), aside(moved({0.6, 0, 0}));
  EXPECT_GT(both.widestOpening(), 2);
  EXPECT_LT(aside.widestOpening(), 0.5);
  for (const std::size_t part : {0, 1}) {
    EXPECT_EQ(both.columns(part).second, both.columns(part).first);
    EXPECT_LT(aside.columns(part).second, aside.columns(part).first);
  }
}

// Where the halves bend, none of what they share stands out of the other farther than their own edges do.
TEST(SkinShare, NothingStandsOut) {
  const glm::dvec3 hinge(0, test::kTubeHeight / 2, 0);
  const Halves bent(moved(hinge) * glm::rotate(glm::dmat4(1), 1.0, glm::dvec3(0, 0, 1)) * moved(-hinge));
  EXPECT_GT(bent.widestOpening(), 3);
  const VoxelGrid& whole = bent.shape.whole;
  std::vector<std::uint32_t> outside(whole.solid.size());
  fields::squaredDistance(whole.solid, whole.size, outside, 1);
  const SeamSteps& seam = bent.seams[0];
  for (const std::size_t part : {0, 1}) {
    const auto farthest = [&](const glm::ivec3& at) {
      const glm::dvec3 center = glm::dvec3(at) + 0.5;
      double most = 0;
      for (const glm::dmat4x3& step :
           (part == 0 ? seam.steps : seam.back_steps)[seam.nearest(center).motion]) {
        const glm::ivec3 to(glm::floor(step * glm::dvec4(center, 1)));
        most = std::max(most,
                        std::sqrt(static_cast<double>(
                            outside[denseIndex(whole.size, glm::clamp(to, glm::ivec3(0), whole.size - 1))])));
      }
      return most;
    };
    double own = 0;
    for (std::size_t i = 0; i < bent.owners.owner.size(); ++i) {
      const glm::ivec3 at = voxelAt(whole.size, i);
      if (bent.owners.owner[i] == part && std::abs(at.y + 0.5 - seam.places[0].at.y) < 3)
        own = std::max(own, farthest(at));
    }
    const std::vector<glm::ivec3> shared = bent.sharedBy(part);
    EXPECT_GT(shared.size(), 400u);
    for (const glm::ivec3& at : shared) EXPECT_LE(farthest(at), own) << at.x << ' ' << at.y << ' ' << at.z;
  }
}

}  // namespace
}  // namespace kelp::bake
