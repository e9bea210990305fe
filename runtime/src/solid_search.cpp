// SPDX-License-Identifier: MIT
#include "solid_search.h"

#include <cmath>

namespace kelp::runtime {

SearchFrame::SearchFrame(const PosedSolid& solid, const glm::dvec3& from) : eye(from) {
  const glm::dmat3& m = solid.to_world;
  const glm::dvec3 x = glm::normalize(m[0]), y = glm::normalize(m[1]), z = glm::normalize(m[2]);
  constexpr double kPerpendicular = 1e-6;
  if (std::abs(glm::dot(x, y)) < kPerpendicular && std::abs(glm::dot(x, z)) < kPerpendicular &&
      std::abs(glm::dot(y, z)) < kPerpendicular) {
    // A rotation although the part may be mirrored, and exactly one although the matrix is rounded.
    const glm::dvec3 across = glm::normalize(glm::cross(x, y));
    from_world = glm::transpose(glm::dmat3(x, glm::cross(across, x), across));
    shears = false;
  }
  to_frame = from_world * m;
  for (int i = 0; i < 3; ++i) grow[i] = (1 + 1e-9) * glm::abs(to_frame[i]);
  offset = from_world * (solid.origin - eye);
}

}  // namespace kelp::runtime
