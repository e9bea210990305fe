// SPDX-License-Identifier: MIT
// A posed asset somewhere in the world, and questions to it that need no GPU: bounds, rays, points, frames.
// The rays run through shaders/trace.glsl compiled as C++: they hit what the GPU draws.
#pragma once

#include <optional>

#include "kelp/runtime/asset.h"
#include "kelp/runtime/pose.h"

namespace kelp::runtime {

// Nothing is owned; the pointers must be good during the call that gets the instance.
struct Instance {
  const Asset* asset = nullptr;
  const Pose* pose = nullptr;    // null: at rest
  glm::mat4 to_world{1};         // object -> world; affine, invertible; mirrored is fine
  glm::vec4 tint{1};             // multiplies the base colour, linear
  // For motion vectors: how the instance was in the frame before; null: as it is now.
  const Pose* previous_pose = nullptr;
  const glm::mat4* previous_to_world = nullptr;
};

// Level-0 voxels of a part -> world, with the part's motion and its ancestors'.
glm::mat4 partToWorld(const Instance& instance, int part);
// Contains the deformed instance; world. Empty for a null asset.
Box bounds(const Instance& instance);

struct Ray {
  glm::vec3 origin{0};     // world
  glm::vec3 direction{0, 0, -1};  // world; any length > 0
  float t_max = 1e30f;     // in lengths of `direction`
};

struct Hit {
  float t = 0;             // position = origin + t * direction
  glm::vec3 position{0};   // world
  glm::vec3 normal{0};     // world, unit, outward
  int part = 0;
  int level = 0;
  glm::ivec3 voxel{0};     // of that level
  glm::vec3 rest{0};       // where the point is in the undeformed part, level-0 voxels
  std::uint8_t material = 0;  // palette index
};

// The nearest hit of the ray with the instance's voxels, at `level` or, where its bricks are not in memory (they are asked for then, and the next
// pump() may bring them), at the finest coarser one whose are. nullopt: no hit, nothing resident, a zero or non-finite ray, or a pose that
// is not monotone.
std::optional<Hit> raycast(const Instance& instance, const Ray& ray, int level = 0);

// Rest point (level-0 voxels of the part) -> where the spline takes it, in the part's own space: partToWorld() takes it on from there.
glm::vec3 bend(const Instance& instance, int part, const glm::vec3& rest);
// Rest point (level-0 voxels of the part) -> world.
glm::vec3 toWorld(const Instance& instance, int part, const glm::vec3& rest);
// World -> rest point (level-0 voxels); nullopt where the point's height is beyond the spline's ends or the pose is not monotone.
std::optional<glm::vec3> toRest(const Instance& instance, int part, const glm::vec3& world);
// Frame at a rest point (level-0 voxels), for things attached to the model: origin and the world images of the part's x, y and z directions,
// y along the spline, made orthonormal (x kept, as far as y allows). Mirrored instances give a right-handed frame too.
glm::mat4 frameAt(const Instance& instance, int part, const glm::vec3& rest);

}  // namespace kelp::runtime
