// SPDX-License-Identifier: MIT
// The sand as triangles.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace underwater {

// A height field: rings about the middle, closer together near it.
struct FloorMesh {
  struct Vertex {
    glm::vec3 position, normal;
  };
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;  // triangles, anticlockwise from above
};
FloorMesh makeFloorMesh(float radius, int rings, int spokes);

}  // namespace underwater
