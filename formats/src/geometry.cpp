// SPDX-License-Identifier: MIT
#include "kelp/formats/geometry.h"

namespace kelp {

Box transformed(const glm::mat4& matrix, const Box& box) {
  Box result;
  if (box.empty()) return result;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec4 p((corner & 1) ? box.max.x : box.min.x, (corner & 2) ? box.max.y : box.min.y,
                      (corner & 4) ? box.max.z : box.min.z, 1.0f);
    result.add(glm::vec3(matrix * p));
  }
  return result;
}

}  // namespace kelp
