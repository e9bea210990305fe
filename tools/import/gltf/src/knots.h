// SPDX-License-Identifier: MIT
// What the rest rig (knots.cpp) and the clips (clips.cpp) of a part have in common.
#pragma once

#include "gltf_model.h"
#include "kelp/import/core/source_model.h"

namespace kelp::bake {

// The mesh along the axis of its rig, and how its empties are read.
struct KnotExtent {
  glm::dvec3 axis{0, 1, 0};
  double low = 0, length = 1;
  // the part is swept, and +Y of knot.0 lies along the axis: all empties were turned to be tangents, whatever
  // way they point
  bool any_way = false;
};
KnotExtent extentAlong(const GltfModel& model, const std::vector<int>& knots, const TriangleSoup& soup,
                       const RigDescription& rig);

// The direction in an empty's own frame that stands for its tangent: +Y. An empty whose +Y points away from
// the axis was never turned to be a tangent: then it is the direction that lies along the axis at rest.
// `turned`, which may be null, says which.
glm::dvec3 tangentHandle(const GltfTransform& rest, const KnotExtent& extent, bool* turned = nullptr);
glm::dvec3 tangentOf(const GltfTransform& transform, const glm::dvec3& handle);

}  // namespace kelp::bake
