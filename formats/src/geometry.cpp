// SPDX-License-Identifier: MIT
#include "kelp/formats/geometry.h"

#include <glm/common.hpp>

namespace kelp {

// Each coordinate of a corner is a sum of one of two numbers per axis, so its extremes are sums of extremes,
// rounding included (Arvo 1990).
Box transformed(const glm::mat4& matrix, const Box& box) {
  Box result;
  if (box.empty()) return result;
  glm::vec3 low[3], high[3];
  for (int axis = 0; axis < 3; ++axis) {
    const glm::vec3 column(matrix[axis]), a = box.min[axis] * column, b = box.max[axis] * column;
    low[axis] = glm::min(a, b);
    high[axis] = glm::max(a, b);
  }
  const glm::vec3 origin(matrix[3]);
  result.min = (low[0] + low[1]) + (low[2] + origin);
  result.max = (high[0] + high[1]) + (high[2] + origin);
  return result;
}

}  // namespace kelp
