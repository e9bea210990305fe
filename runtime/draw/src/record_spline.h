// SPDX-License-Identifier: MIT
// The splines of records: segments of sheared parts, arcs of swept ones, the farther away the fewer, now and
// in the frame before (shaders/instance.glsl).
#pragma once

#include <cstring>
#include <span>

#include <glm/gtc/type_precision.hpp>

#include "kelp/formats/sweep.h"
#include "kelp/runtime/instance.h"

namespace kelp::draw {

inline constexpr std::size_t kMotionTexels = 4;  // before the spline of the frame before

// Arcs and joints, as in the records.
inline std::size_t arcTexels(std::uint32_t arcs) { return 6 * std::size_t{arcs} + 2; }
inline void writeArcs(glm::uvec4* out, const ArcChain& chain) {
  const auto count = static_cast<std::size_t>(chain.count);
  std::memcpy(static_cast<void*>(out), chain.arcs, count * sizeof(Arc));
  std::memcpy(static_cast<void*>(out + 4 * count), chain.joints, (count + 1) * sizeof(ArcJoint));
}

// These return where the next texel is.
// As makeSegment. Writes one number too many, which the next write covers.
glm::uvec4* writeSegments(glm::uvec4* out, std::span<const Knot> knots, float height);
// Where a part was in the frame before: 4 texels as RecordHead::to_clip, and the segments; of a swept part,
// the number of its arcs, and these, made with `tolerance`; of one with cages, the nodes of the one with the
// number `cage`. `scratch`: for arcs.
glm::uvec4* writeMotion(const glm::mat4& previous_world_to_clip, const runtime::Instance& instance,
                        std::uint32_t part, float tolerance, int cage, ArcChain& scratch, glm::uvec4* out);

// About where a swept part is: enough to tell at which level it is drawn. Part space.
Box boxOfKnots(std::span<const Knot> knots, const glm::ivec3& size);

// Makes the arcs of a part that is drawn at about that level, which may be any number: within half a voxel of
// that level from the spline, and those of solids at level 0 as everywhere. `tolerance`: theirs, in heights
// of the part. Fails only where makeArcs() does with the finest tolerance too.
Result<void> makeDrawnArcs(std::span<const Knot> knots, PartKind kind, const glm::ivec3& size, float roll,
                           float level, ArcChain& chain, float& tolerance);

// The roll of a swept part; of a pose, or at rest.
inline float rollOf(const Part& part, const runtime::Pose* pose, int index) {
  return part.roll + (pose ? pose->motion(index)->roll : 0.0f);
}

}  // namespace kelp::draw
