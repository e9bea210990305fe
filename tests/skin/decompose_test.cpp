// SPDX-License-Identifier: MIT
// Parts of tubes.
#include "decompose.h"

#include <cmath>

#include <gtest/gtest.h>

#include "collapse.h"
#include "skin_shapes.h"
#include "tree.h"

namespace kelp::bake {
namespace {

double wave(int j, double t) { return 0.5 * std::sin(3.1 * t + 0.8 * j); }

struct Divided {
  test::SkinnedShape shape;
  SkinSpace space;
  SkinSamples samples;
  SkinMoments moments;
  SkinLabels labels;

  Divided(int joints, const std::vector<SourceSkin::Clip>& clips, int threads = 1)
      : shape(test::tube(joints)), space(skinSpace(shape.frame)) {
    shape.skin().clips = clips;
    samples = makeSkinSamples(shape.soup(), shape.skin(), space);
    moments = judgedMoments(shape.skin(), samples, space, threads);
    labels = decompose(samples, moments, threads, [](double) {});
  }
  // The mean distance from the drawn surface, over all moments, by direct sums.
  double meanDistance(const SkinLabels& of) const {
    double sum = 0, area = 0;
    const auto members = of.members();
    for (std::size_t p = 0; p < members.size(); ++p) {
      const std::vector<glm::dmat4x3> motions = fitMotions(samples, moments, members[p], of.joints[p]);
      for (const std::uint32_t i : members[p])
        for (std::size_t t = 0; t < moments.size(); ++t) {
          sum += samples.areas[i] * glm::distance(motions[t] * glm::dvec4(samples.positions[i], 1),
                                                  skinnedPoint(samples, i, moments, t));
          area += samples.areas[i];
        }
    }
    return sum / area;
  }
};

SkinLabels byHeaviest(const Divided& divided) {
  SkinLabels labels;
  for (std::uint32_t j = 0; j < divided.shape.skin().joints.size(); ++j) labels.joints.push_back(j);
  for (std::size_t i = 0; i < divided.samples.size(); ++i)
    labels.parts.push_back(divided.samples.heaviestJoint(i));
  return labels;
}

SourceSkin::Clip waving(int joints, const std::string& name = "wave") {
  return test::turningClip(test::tube(joints).skin(), name, 2, 121, wave);
}

TEST(SkinDecompose, PartsAreConnectedAndFewAndBetterThanJoints) {
  const Divided divided(4, {waving(4)});
  const std::size_t parts = divided.labels.joints.size();
  EXPECT_GT(parts, 4u);
  EXPECT_LE(parts, 8u);
  const auto members = divided.labels.members();
  for (std::size_t p = 0; p < parts; ++p) {
    ASSERT_FALSE(members[p].empty());
    std::vector<bool> seen(divided.samples.size(), false);
    std::vector<std::uint32_t> reached{members[p].front()};
    seen[reached.front()] = true;
    for (std::size_t k = 0; k < reached.size(); ++k)
      for (std::size_t n = divided.samples.first_neighbor[reached[k]];
           n < divided.samples.first_neighbor[reached[k] + 1]; ++n) {
        const std::uint32_t other = divided.samples.neighbors[n].sample;
        if (seen[other] || divided.labels.parts[other] != p) continue;
        seen[other] = true;
        reached.push_back(other);
      }
    EXPECT_EQ(reached.size(), members[p].size()) << p;
  }
  EXPECT_LT(divided.meanDistance(divided.labels), 0.7 * divided.meanDistance(byHeaviest(divided)));
}

// A clip that stands still is no reason to be content with less in the others.
TEST(SkinDecompose, StillClipsDoNotCount) {
  const auto rest = [](const std::string& name, double bend) {
    return test::turningClip(test::tube(4).skin(), name, 3, 181, [bend](int, double) { return bend; });
  };
  const Divided one(4, {waving(4)}), with(4, {rest("rest", 0), waving(4), rest("also", 0)});
  EXPECT_EQ(one.moments.size(), with.moments.size());
  EXPECT_EQ(one.labels.parts, with.labels.parts);
  const Divided held(4, {rest("held", 0.3)});
  EXPECT_EQ(held.moments.size(), 1u);
}

TEST(SkinDecompose, WithoutMomentsEachJointHasItsOwn) {
  const Divided divided(3, {});
  EXPECT_EQ(divided.moments.size(), 0u);
  EXPECT_EQ(divided.labels.parts, byHeaviest(divided).parts);
}

TEST(SkinTree, FollowsTheJoints) {
  Divided divided(4, {waving(4)});
  const PartTree tree = hangParts(divided.samples, divided.shape.skin(), divided.space, divided.labels);
  ASSERT_EQ(tree.parents.size(), divided.labels.joints.size());
  int roots = 0;
  std::vector<bool> main(4, false);
  for (std::size_t p = 0; p < tree.parents.size(); ++p) {
    roots += tree.parents[p] < 0;
    EXPECT_LT(tree.parents[p], static_cast<int>(p));
    const std::uint32_t joint = divided.labels.joints[p];
    const bool split = tree.names[p] != "bone" + std::to_string(joint);
    if (split) {
      EXPECT_EQ(tree.names[p].rfind("bone" + std::to_string(joint) + ".", 0), 0u) << tree.names[p];
      continue;
    }
    main[joint] = true;
    // 10 units a length; the joint's origin
    EXPECT_NEAR(tree.pivots[p].y, 10 * divided.shape.skin().joints[joint].origin.y, 1e-3);
    if (joint > 0) {
      EXPECT_EQ(divided.labels.joints[static_cast<std::size_t>(tree.parents[p])], joint - 1);
    }
  }
  EXPECT_EQ(roots, 1);
  EXPECT_EQ(main, std::vector<bool>(4, true));
}

}  // namespace
}  // namespace kelp::bake
