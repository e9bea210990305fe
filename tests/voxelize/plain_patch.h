// SPDX-License-Identifier: MIT
// A patch as lists of points and triangles.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "patch.h"

namespace kelp::bake {

struct PlainPatch {
  std::vector<glm::dvec3> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::uint32_t rim = 0;

  explicit PlainPatch(const Patch& patch) : rim(patch.rim) {
    for (const OpenMesh::VertexHandle v : patch.mesh.vertices()) points.push_back(pointOf(patch.mesh, v));
    for (const OpenMesh::SmartFaceHandle face : patch.mesh.faces()) {
      std::array<std::uint32_t, 3>& t = triangles.emplace_back();
      std::size_t k = 0;
      for (const OpenMesh::VertexHandle v : face.vertices()) t[k++] = static_cast<std::uint32_t>(v.idx());
    }
  }
};

}  // namespace kelp::bake
