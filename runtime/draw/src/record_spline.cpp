// SPDX-License-Identifier: MIT
#include "record_spline.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "placing.h"
#include "record_cage.h"

namespace kelp::draw {
namespace {

// Coarse arcs may fold where fine ones do not.
bool makeChain(const Part& part, const runtime::Pose* pose, int index, float tolerance, ArcChain& chain) {
  const std::span<const Knot> knots = pose ? pose->knots(index) : part.knots;
  const float roll = rollOf(part, pose, index);
  return makeArcs(knots, part.size, roll, tolerance, chain) ||
         (tolerance > kArcTolerance && makeArcs(knots, part.size, roll, kArcTolerance, chain));
}

}  // namespace

glm::uvec4* writeSegments(glm::uvec4* out, std::span<const Knot> knots, float height) {
  static_assert(sizeof(Segment) == 3 * sizeof *out && offsetof(Segment, m0) == 12 &&
                offsetof(Segment, p1) == 24 && offsetof(Segment, m1) == 36);
  static_assert(offsetof(Knot, position) == 4 && offsetof(Knot, tangent) == 16);
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    const Knot& k0 = knots[i];
    const Knot& k1 = knots[i + 1];
    const float share = height * (k1.at - k0.at);
    const auto tangentOf = [share](const Knot& knot) {
      return share * Lanes::load(&knot.position.z).rotated();
    };
    float* const numbers = reinterpret_cast<float*>(out);
    (height * Lanes::load(&k0.position.x)).store(numbers);
    tangentOf(k0).store(numbers + 3);
    (height * Lanes::load(&k1.position.x)).store(numbers + 6);
    tangentOf(k1).store(numbers + 9);
    out += 3;
  }
  return out;
}

glm::uvec4* writeMotion(const glm::mat4& previous_world_to_clip, const runtime::Instance& instance,
                        std::uint32_t part, float tolerance, int cage, ArcChain& scratch, glm::uvec4* out) {
  const int index = static_cast<int>(part);
  const Part& packed = instance.asset->pack().parts()[part];
  const bool caged = !packed.cages.empty(), swept = !caged && packed.bend == Bend::kSweep;
  runtime::Instance before = instance;
  // A pose that could not be drawn was not seen in the frame before: then the part stands still.
  if (instance.previous_pose) {
    before.pose = instance.previous_pose;
    const bool good = caged   ? bool(runtime::posedCage(before, index, cage))
                      : swept ? makeChain(packed, before.pose, index, tolerance, scratch)
                              : bool(checkKnots(before.pose->knots(index)));
    if (!good) before.pose = instance.pose;
  }
  if (swept && before.pose == instance.pose)
    (void)makeChain(packed, instance.pose, index, tolerance, scratch);
  if (instance.previous_to_world) before.to_world = *instance.previous_to_world;
  const glm::mat4 rows(
      glm::transpose(glm::dmat4(previous_world_to_clip) * glm::dmat4(*runtime::partToWorld(before, index))));
  std::memcpy(static_cast<void*>(out), &rows, sizeof rows);
  out += kMotionTexels;
  if (caged) {
    const auto posed = runtime::posedCage(before, index, cage);
    return writeNodes(posed ? posed->nodes : std::span<const glm::vec3>(), out);
  }
  if (swept) {
    *out++ = glm::uvec4(static_cast<std::uint32_t>(scratch.count), 0, 0, 0);
    writeArcs(out, scratch);
    return out + arcTexels(static_cast<std::uint32_t>(scratch.count));
  }
  return writeSegments(out, before.pose ? before.pose->knots(index) : packed.knots,
                       static_cast<float>(packed.size.y));
}

Box boxOfKnots(std::span<const Knot> knots, const glm::ivec3& size) {
  // The hull of the cubics, and a section's corner around it.
  Box box;
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    const Knot &k0 = knots[i], &k1 = knots[i + 1];
    const float third = (k1.at - k0.at) / 3;
    for (const glm::vec3& point :
         {k0.position, k0.position + third * k0.tangent, k1.position - third * k1.tangent, k1.position})
      box.add(point);
  }
  const glm::vec3 extent(size), half(0.5f * extent.x, 0, 0.5f * extent.z);
  const float corner = glm::length(half);
  return {half + extent.y * box.min - corner, half + extent.y * box.max + corner};
}

Result<void> makeDrawnArcs(std::span<const Knot> knots, PartKind kind, const glm::ivec3& size, float roll,
                           float level, ArcChain& chain, float& tolerance) {
  if (level >= 1 || kind == PartKind::kFog) {
    // Half a voxel as it is drawn.
    const float half = level >= 1 ? std::ldexp(0.5f, static_cast<int>(std::min(level, 16.0f))) : 0.5f;
    tolerance = std::max(half / static_cast<float>(size.y), kArcTolerance);
    // (Coarse arcs may fold where fine ones do not.)
    if (makeArcs(knots, size, roll, tolerance, chain)) return {};
  }
  tolerance = kArcTolerance;
  return makeArcs(knots, size, roll, tolerance, chain);
}

}  // namespace kelp::draw
