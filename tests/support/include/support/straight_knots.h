// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "kelp/formats/spline.h"

namespace kelp::test {

// The straight rig of a volume of `size` voxels: two knots.
inline std::vector<Knot> straightKnots() {
  const glm::vec3 top(0, 1, 0);
  return {{0, glm::vec3(0), top}, {1, top, top}};
}

}  // namespace kelp::test
