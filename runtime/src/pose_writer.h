// SPDX-License-Identifier: MIT
// Access to the knots of a pose for what evaluates clips and springs.
#pragma once

#include "kelp/runtime/pose.h"

namespace kelp::runtime {

struct PoseWriter {
  static std::span<Knot> knots(Pose& pose, int part) {
    pose.moved(part);
    return pose.writableKnots(part);
  }
  // The knots of all parts, one part after the other.
  static std::span<Knot> allKnots(Pose& pose) {
    for (int part = 0; part < pose.parts() && pose.cages(); ++part) pose.moved(part);
    return {pose.knotData(), pose.knots_};
  }
  static std::uint64_t bytes(const Pose& pose) { return pose.memory_.size() + pose.cages_.size(); }
  static Result<Pose> create(std::span<const Part> parts, bool joints, const Allocator& allocator) {
    return Pose::create(parts, joints, allocator);
  }
};

// Moves a knot; automatic tangents follow.
inline void moveKnot(std::span<Knot> knots, std::size_t knot, const glm::vec3& offset, const Follow& follow) {
  knots[knot].position += offset;
  knots[knot].tangent += follow.self * offset;
  if (knot > 0) knots[knot - 1].tangent += follow.before * offset;
  if (knot + 1 < knots.size()) knots[knot + 1].tangent += follow.after * offset;
}

}  // namespace kelp::runtime
