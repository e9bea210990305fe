// SPDX-License-Identifier: MIT
// Which part follows which, and what it turns about.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "decompose.h"
#include "sweep.h"

namespace kelp::bake {

// Where samples of two parts are neighbors.
struct Seam {
  std::uint32_t a = 0, b = 0;  // parts, a < b
  double length = 0;
  glm::dvec3 middle{0};
  std::vector<std::uint32_t> edges;  // of the samples
};
// Ascending by a, then b.
std::vector<Seam> findSeams(const SkinSamples& samples, const SkinLabels& labels);

struct PartTree {
  std::vector<int> parents;        // of each part
  std::vector<glm::dvec3> pivots;  // in the bind pose
  std::vector<std::string> names;
  std::vector<std::optional<SkinSweep>> sweeps;  // of those that are swept
  std::vector<float> places;                     // on the spline of the parent, as Part::parent_at
  std::vector<std::uint32_t> part_of_joint;  // of each joint: the part that moves with it, or with one above
};

// The motion that a part with a parent has from it, when the parent is in such a pose: posed <- bind pose.
glm::dmat4x3 motionFromParent(const PartTree& tree, std::size_t part, const SkinPose& parent);

// Of each part: true if joints with kScaledShare of it are scaled by a clip. Then its motion has a scale.
std::vector<bool> scalingParts(const SkinSamples& samples, const SourceSkin& skin, const SkinLabels& labels);

// Sorts the parts so that parents come first. The largest part of a joint follows the joint above; further
// ones follow the part with which they share the longest seam. Joints without a part above them follow the
// largest of these within their skeleton. A swept part is that of all joints of its chain; what follows it
// hangs on its spline. One that would fold by now is rigid after all. No part follows one that scales: what
// would hangs higher up, and has all of its motion itself.
PartTree hangParts(const SkinSamples& samples, const SourceSkin& skin, const SkinSpace& space,
                   SkinLabels& labels);

}  // namespace kelp::bake
