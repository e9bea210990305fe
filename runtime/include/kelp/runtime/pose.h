// SPDX-License-Identifier: MIT
// A pose: where the knots of every part are right now. The host moves the knots itself, or adds clips.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <utility>

#include <glm/gtc/quaternion.hpp>

#include "kelp/runtime/asset.h"

namespace kelp::runtime {

// Rigid motion and scale of a part, in its pivot's space (kelp/formats/model.h). The identity at rest.
struct Motion {
  glm::vec3 translation{0};
  glm::quat rotation{1, 0, 0, 0};
  glm::vec3 scale{1};
};

// Whether it does nothing; asked of every part of every frame.
inline bool isRest(const Motion& motion) {
  static constexpr Motion kRest;
  return std::memcmp(&motion, &kRest, sizeof motion) == 0;  // NOLINT(bugprone-suspicious-memory-comparison): floats without gaps; -0 counts as motion, and moves nothing
}

// Independent of the asset once created (the asset must only be alive during calls that take both). Cheap to copy into with assign(). Only
// create() allocates. Not thread-safe; different poses may be used on different threads at the same time.
class Pose {
 public:
  // At rest. kOutOfMemory.
  static Result<Pose> create(const Asset& asset, const Allocator& allocator = {});
  Pose(Pose&& other) noexcept { *this = std::move(other); }
  Pose& operator=(Pose&& other) noexcept;

  int parts() const { return static_cast<int>(parts_); }
  // Whether the pose has the parts and knots of this asset: what every function that takes both asks first.
  bool fits(const Asset& asset) const;
  // The knots of a part, to read and to move: voxels. An empty span for a part that is not there. `at` must not be changed. Moving an end knot
  // along y stretches or squashes the part's volume between the ends (section 3.1 of the paper); kelp/formats/spline.h has the rules.
  std::span<Knot> knots(int part) {
    if (part < 0 || part >= parts()) return {};
    const std::uint32_t first = firstKnots()[part];
    return {knotData() + first, firstKnots()[part + 1] - first};
  }
  std::span<const Knot> knots(int part) const { return const_cast<Pose*>(this)->knots(part); }
  // The knots of all parts, one part after the other.
  std::span<Knot> allKnots() { return {knotData(), knots_}; }
  // The motion of a part, to read and to move; null for a part that is not there.
  Motion* motion(int part) { return part >= 0 && part < parts() ? motionData() + part : nullptr; }
  const Motion* motion(int part) const { return const_cast<Pose*>(this)->motion(part); }

  void reset();                                   // back to rest
  [[nodiscard]] bool assign(const Pose& other);   // false if `other` belongs to another kind of asset
  // Moves towards `to`: 0 leaves the pose as it is, 1 makes it `to`. Knots, translations and scales go straight, rotations by the shorter way
  // around at an even pace. What lies between two monotone poses is monotone. `part_weights`, one per part, multiplies the weight of each part: a
  // mask; empty: all ones. kMisuse, with nothing changed, if `to` belongs to another kind of asset or a weight is not within [0, 1].
  Result<void> blend(const Pose& to, float weight, std::span<const float> part_weights = {});
  // kNotMonotone, with the index of the part in `offset`, if a spline turns back along its axis: such a pose is not drawn.
  Result<void> check() const;
  // Moves tangents and knots in y only, as little as needed, until every spline is monotone.
  void clampMonotone();

 private:
  Pose() = default;
  bool sameShape(const Pose& other) const;
  // One block, because thousands of poses are walked each frame: the first knot of each part and the end of the last one's, motions and knots now, motions and
  // knots at rest. What a frame reads lies side by side.
  std::size_t firstKnotBytes() const { return (parts_ + 1) * sizeof(std::uint32_t); }
  std::size_t stateBytes() const { return parts_ * sizeof(Motion) + knots_ * sizeof(Knot); }
  std::uint32_t* firstKnots() { return reinterpret_cast<std::uint32_t*>(memory_.data()); }
  const std::uint32_t* firstKnots() const { return const_cast<Pose*>(this)->firstKnots(); }
  std::byte* state() { return memory_.data() + firstKnotBytes(); }
  Motion* motionData() { return reinterpret_cast<Motion*>(state()); }
  Knot* knotData() { return knot_data_; }
  std::byte* restState() { return state() + stateBytes(); }
  Motion* restMotions() { return reinterpret_cast<Motion*>(restState()); }
  Knot* restKnots() { return reinterpret_cast<Knot*>(restMotions() + parts_); }

  Buffer<std::byte> memory_;
  Knot* knot_data_ = nullptr;  // in memory_
  std::uint32_t parts_ = 0;
  std::uint32_t knots_ = 0;
};

// Adds `weight` times what the clip does at `seconds` to the pose. kMisuse, with nothing changed, if the clip is not there, the pose is not one
// of this asset, or a number is none.
//
// Time: tracks repeat after the clip's duration, also backwards; each wave repeats after its own period and never ends. An instance gets a phase of
// its own by an offset of its own to `seconds`. Phases are reduced in double precision: after a hundred hours they are still exact to a
// millionth of a turn. A clip that plays once: clamp `seconds` to [0, std::nextafter(duration, 0.0)].
//
// Layers: add further clips. Crossfade: add one clip with weight 1 - w and the other with w; the knots are then exactly between the two
// poses, and there is no dip towards rest. Where motions turn far, or a mask is wanted, make two poses and blend() them.
Result<void> addClip(const Asset& asset, int clip, double seconds, float weight, Pose& pose);
// Index of the clip of that name; -1: none.
int findClip(const Asset& asset, std::string_view name);

}  // namespace kelp::runtime
