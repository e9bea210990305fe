// SPDX-License-Identifier: MIT
// Meshes whose volume, surface and normals are known.
#pragma once

#include <functional>
#include <string>

#include "kelp/bake/bake.h"

namespace kelp::test {

// A model of one part with one white material.
bake::SourceModel makeModel(bake::TriangleSoup soup, const std::string& name = "shape");

// Triangles appended to `soup`.
void addTriangle(bake::TriangleSoup& soup, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c);
// A box wound outward; `skip` leaves out its -x, +x, -y, +y, -z or +z face (0 .. 5).
void addBox(bake::TriangleSoup& soup, const glm::vec3& low, const glm::vec3& high, int skip = -1);
// A latitude-longitude sphere, poles on y; keep(latitude in radians) says which bands of triangles to make.
void addSphere(bake::TriangleSoup& soup, const glm::vec3& center, float radius, int rings,
               const std::function<bool(float)>& keep = {});
// A torus around y.
void addTorus(bake::TriangleSoup& soup, float major, float minor, int steps);
// A rod with a round section from a to b, closed.
void addRod(bake::TriangleSoup& soup, const glm::vec3& a, const glm::vec3& b, float radius);
// Turns every triangle inside out.
void turnInsideOut(bake::TriangleSoup& soup);

// Voxelizes the single part of a model with voxels of one unit and no margin.
struct Baked {
  bake::Frame frame;
  bake::VoxelizeResult result;
  std::uint64_t solid = 0;
  const bake::VoxelGrid& grid() const { return result.grid; }
  bool at(int x, int y, int z) const;
};
Baked voxelizeUnit(const bake::SourceModel& model, bake::Fill fill = bake::Fill::kAuto, int threads = 2);

}  // namespace kelp::test
