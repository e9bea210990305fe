// SPDX-License-Identifier: MIT
#include "floor_mesh.h"

#include "terrain.h"

namespace underwater {

FloorMesh makeFloorMesh(float radius, int rings, int spokes) {
  FloorMesh mesh;
  const auto add = [&mesh](const glm::vec2& at) {
    mesh.vertices.push_back({{at.x, sandHeight(at), at.y}, sandNormal(at)});
  };
  add(glm::vec2(0));
  for (int ring = 1; ring <= rings; ++ring) {
    const float share = static_cast<float>(ring) / static_cast<float>(rings),
                distance = radius * share * (0.4f + 0.6f * share);
    for (int spoke = 0; spoke < spokes; ++spoke) {
      const float angle = 6.2831853f * static_cast<float>(spoke) / static_cast<float>(spokes);
      add(distance * glm::vec2(glm::cos(angle), glm::sin(angle)));
    }
  }
  const auto index = [spokes](int ring, int spoke) {
    return ring == 0 ? 0u : static_cast<std::uint32_t>(1 + (ring - 1) * spokes + spoke % spokes);
  };
  for (int ring = 0; ring < rings; ++ring) {
    for (int spoke = 0; spoke < spokes; ++spoke) {
      const std::uint32_t a = index(ring, spoke), b = index(ring, spoke + 1), c = index(ring + 1, spoke),
                          d = index(ring + 1, spoke + 1);
      mesh.indices.insert(mesh.indices.end(), {a, d, c});
      if (ring > 0) mesh.indices.insert(mesh.indices.end(), {a, b, d});
    }
  }
  return mesh;
}

}  // namespace underwater
