// SPDX-License-Identifier: MIT
#include "part_size.h"

#include <algorithm>

namespace kelp::bake {

PartSize partSize(const SourcePart& part, const Frame& frame, const glm::ivec3& pad) {
  PartSize result;
  if (part.grid) {
    result.size = part.grid->size + 2 * pad;
    result.surface_voxels = static_cast<double>(part.grid->surface.size());
    return result;
  }
  if (part.fog) {
    result.size = part.fog->size + 2 * pad;
    result.fog_channels = part.fog->heat.empty() ? 1 : 2;
    return result;
  }
  result.size = frame.size;
  result.triangles = part.soup.triangles.size();
  result.vertices = part.soup.positions.size();
  const glm::dmat3 turn(frame.node_to_voxel);
  for (const TriangleSoup::Triangle& triangle : part.soup.triangles) {
    glm::dvec3 corner[3];
    for (std::size_t i = 0; i < 3; ++i)
      corner[i] = turn * glm::dvec3(part.soup.positions[triangle.vertex[i]]);
    const glm::dvec3 area = 0.5 * glm::abs(glm::cross(corner[1] - corner[0], corner[2] - corner[0]));
    // A triangle narrower than a voxel touches voxels along its length, which it shares with a neighbour.
    const glm::dvec3 extent = glm::max(glm::max(corner[0], corner[1]), corner[2]) -
                              glm::min(glm::min(corner[0], corner[1]), corner[2]);
    const glm::dvec3 touched = area + 0.5 * glm::max(extent - 1.0, glm::dvec3(0));
    result.crossings += area;
    result.surface_voxels += touched.x + touched.y + touched.z;
  }
  result.surface_voxels = std::min(result.surface_voxels, result.voxels());
  return result;
}

bool isPile(const PartSize& part) {
  constexpr double kOverEachOther = 2048, kLong = 1e7;
  for (int axis = 0; axis < 3; ++axis)
    if (part.crossings[axis] > kLong &&
        part.crossings[axis] > kOverEachOther * part.voxels() / part.size[axis])
      return true;
  return false;
}

}  // namespace kelp::bake
