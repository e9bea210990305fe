// SPDX-License-Identifier: MIT
// A chain of joints as one swept part: its center line in the bind pose, and what a pose makes of it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "decompose.h"
#include "kelp/formats/sweep.h"
#include "samples.h"

namespace kelp::bake {

// A swept part in the bind pose. In its part space, in voxels, the center line begins at (X / 2, 0, Z / 2)
// and leaves along +y; there it is as bent as in the bind pose. Its voxels are straight.
struct SkinSweep {
  glm::ivec3 size{0};       // voxels, straight
  glm::dmat4x3 place{1};    // skin space <- part space: a rotation and a scale
  std::vector<Knot> knots;  // at rest
  ArcChain arcs;            // of these

  double height() const { return static_cast<double>(size.y); }
  // The first knot, in part space.
  glm::dvec3 corner() const { return {0.5 * size.x, 0, 0.5 * size.z}; }
  // Part space -> skin space, and back.
  glm::dvec3 toSkin(const glm::dvec3& at) const { return place * glm::dvec4(at, 1); }
  glm::dvec3 toPart(const glm::dvec3& at) const;
  // Where a place of the bind pose (in part space) is in the straight part. Outside the slices: as if the
  // nearest section went on.
  glm::vec3 straightened(const glm::dvec3& at) const;
};

// The center line goes through the middles of the samples `members` around the joints' line, in equal steps,
// and some way beyond both ends. nullopt if the part would fold in the bind pose, or all joints are in one
// place.
std::optional<SkinSweep> makeSweep(const SkinSamples& samples, const SourceSkin& skin, const SkinSpace& space,
                                   const std::vector<std::uint32_t>& members, const SkinChain& chain);

// The motion of a part at a moment: a rigid motion of skin space, and before it, of a swept part, its knots.
struct SkinPose {
  glm::dmat4x3 motion{1};
  std::vector<Knot> knots;
};

// A swept part in a pose.
class PosedSweep {
 public:
  // false if the part folds; then it is taken as bent as in the bind pose.
  PosedSweep(const SkinSweep& sweep, const SkinPose& pose);
  explicit operator bool() const { return ok_; }
  // Skin space <- a place of the straight part.
  glm::dvec3 at(const glm::vec3& straight) const;
  // The motion of the section at a height of the straight part: posed <- bind pose.
  glm::dmat4x3 sectionMotion(double y) const;

 private:
  const SkinSweep& sweep_;
  glm::dmat4x3 from_part_{1};
  ArcChain arcs_;
  bool ok_ = false;
};

}  // namespace kelp::bake
