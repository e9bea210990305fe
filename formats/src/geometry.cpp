// SPDX-License-Identifier: MIT
#include "kelp/formats/geometry.h"

#include "kelp/formats/lanes.h"

namespace kelp {

// Each corner is a sum of one of two vectors per axis, and the extremes of sums are the sums of extremes, rounding included (Arvo 1990).
Box transformed(const glm::mat4& matrix, const Box& box) {
  Box result;
  if (box.empty()) return result;
  Lanes low[3] = {0.0f, 0.0f, 0.0f}, high[3] = {0.0f, 0.0f, 0.0f};
  for (int axis = 0; axis < 3; ++axis) {
    const Lanes column = Lanes::load(&matrix[axis][0]), a = box.min[axis] * column, b = box.max[axis] * column;
    low[axis] = min(a, b);
    high[axis] = max(a, b);
  }
  const Lanes origin = Lanes::load(&matrix[3][0]);
  float least[4], most[4];
  ((low[0] + low[1]) + (low[2] + origin)).store(least);
  ((high[0] + high[1]) + (high[2] + origin)).store(most);
  result.min = glm::vec3(least[0], least[1], least[2]);
  result.max = glm::vec3(most[0], most[1], most[2]);
  return result;
}

}  // namespace kelp
