// SPDX-License-Identifier: MIT
#include "volume_grid.h"

namespace kelp::bake {

double VolumeSampler::between(const glm::dvec3& point) const {
  if (!onLattice(point)) return grid_->background;
  // On a voxel's centre, up to rounding: its own value, so that one equal to the isovalue stays so.
  const glm::dvec3 nearest = glm::round(point);
  const glm::dvec3 place =
      glm::mix(point, nearest, glm::lessThan(glm::abs(point - nearest), glm::dvec3(1e-6)));
  const glm::dvec3 floor = glm::floor(place), f = place - floor;
  const glm::ivec3 low(floor);
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 step(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
    const double weight = (step.x ? f.x : 1 - f.x) * (step.y ? f.y : 1 - f.y) * (step.z ? f.z : 1 - f.z);
    if (weight > 0) sum += weight * at(low + step);
  }
  return sum;
}

}  // namespace kelp::bake
