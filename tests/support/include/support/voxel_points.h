// SPDX-License-Identifier: MIT
// Points of an undeformed part in voxels, for tests that think in voxels.
#pragma once

#include <glm/matrix.hpp>

#include "kelp/runtime/instance.h"

namespace kelp::test {

inline glm::vec3 voxelToRest(const runtime::Instance& instance, int part, const glm::vec3& voxel) {
  return instance.asset->pack().parts()[static_cast<std::size_t>(part)].to_object * glm::vec4(voxel, 1);
}
inline glm::vec3 voxelToWorld(const runtime::Instance& instance, int part, const glm::vec3& voxel) {
  return toWorld(instance, part, voxelToRest(instance, part, voxel)).value();
}
inline glm::vec3 restToVoxel(const runtime::Instance& instance, int part, const glm::vec3& rest) {
  const glm::mat4 to_object(instance.asset->pack().parts()[static_cast<std::size_t>(part)].to_object);
  return glm::vec3(glm::inverse(to_object) * glm::vec4(rest, 1));
}

}  // namespace kelp::test
