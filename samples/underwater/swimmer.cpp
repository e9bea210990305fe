// SPDX-License-Identifier: MIT
#include "swimmer.h"

namespace underwater {

Anatomy Anatomy::of(const kelp::Part& part) {
  Anatomy a;
  a.voxel_to_object = glm::mat4(part.to_object);
  a.size = glm::vec3(part.size);
  a.length = glm::length(part.to_object[1]) * a.size.y;
  a.radius =
      0.5f * glm::max(glm::length(part.to_object[0]) * a.size.x, glm::length(part.to_object[2]) * a.size.z);
  const glm::vec3 forward = -glm::normalize(part.to_object[1]),
                  right = glm::normalize(glm::cross(forward, glm::vec3(0, 1, 0)));
  a.object_to_swim = glm::transpose(glm::mat3(forward, glm::cross(right, forward), right));
  return a;
}

glm::mat4 swimFrame(const Anatomy& anatomy, const Lane& lane, float head, float scale, float bank) {
  const float middle = head - 0.5f * scale * anatomy.length;
  const glm::vec3 forward = lane.direction(middle),
                  level = glm::normalize(glm::cross(forward, glm::vec3(0, 1, 0)));
  const glm::vec3 right = glm::cos(bank) * level - glm::sin(bank) * glm::cross(level, forward);
  const glm::mat3 turned =
      scale * glm::mat3(forward, glm::cross(right, forward), right) * anatomy.object_to_swim;
  const glm::vec3 center = anatomy.voxel_to_object * glm::vec4(0.5f * anatomy.size, 1);
  glm::mat4 to_world(turned);
  to_world[3] = glm::vec4(lane.at(middle) - turned * center, 1);
  return to_world;
}

void layOnLane(const Anatomy& anatomy, const glm::mat4& to_world, const Lane& lane, float head, float scale,
               std::span<kelp::Knot> knots) {
  const glm::mat4 to_part = glm::inverse(to_world * anatomy.voxel_to_object);
  const float length = scale * anatomy.length;
  const glm::vec3 corner(0.5f * anatomy.size.x, 0,
                         // the spline runs along the box's edge, the lane through its middle
                         0.5f * anatomy.size.z);
  for (kelp::Knot& knot : knots) {
    const float s = head - knot.at * length;
    knot.position = (glm::vec3(to_part * glm::vec4(lane.at(s), 1)) - corner) / anatomy.size.y;
    knot.tangent = glm::mat3(to_part) * (-length * lane.direction(s)) / anatomy.size.y;
  }
}

}  // namespace underwater
