// SPDX-License-Identifier: MIT
// A pose: where the knots of every part are right now. The host moves the knots itself, or adds clips.
#pragma once

#include <span>

#include <glm/gtc/quaternion.hpp>

#include "kelp/runtime/asset.h"

namespace kelp::runtime {

// Rigid motion and scale of a part, in its pivot's space (kelp/formats/model.h). The identity at rest.
struct Motion {
  glm::vec3 translation{0};
  glm::quat rotation{1, 0, 0, 0};
  glm::vec3 scale{1};
};

// Independent of the asset once created (the asset must only be alive during calls that take both). Not thread-safe; cheap to copy into
// with assign(). Moving knots never allocates.
class Pose {
 public:
  // At rest. kOutOfMemory.
  static Result<Pose> create(const Asset& asset, const Allocator& allocator = {});
  Pose(Pose&&) noexcept = default;
  Pose& operator=(Pose&&) noexcept = default;

  int parts() const { return static_cast<int>(motions_.size()); }
  // The knots of a part, to read and to move: voxels. An empty span for a part that is not there. `at` must not be changed.
  std::span<Knot> knots(int part);
  std::span<const Knot> knots(int part) const;
  // The motion of a part, to read and to move; null for a part that is not there.
  Motion* motion(int part) { return part >= 0 && part < parts() ? &motions_[static_cast<std::size_t>(part)] : nullptr; }
  const Motion* motion(int part) const { return const_cast<Pose*>(this)->motion(part); }

  void reset();                                   // back to rest
  [[nodiscard]] bool assign(const Pose& other);   // false if `other` belongs to another kind of asset
  // kNotMonotone, with the index of the part in `offset`, if a spline turns back along its axis: such a pose is not drawn.
  Result<void> check() const;
  // Moves tangents and knots in y only, as little as needed, until every spline is monotone.
  void clampMonotone();

 private:
  Pose() = default;
  Buffer<Knot> knots_;
  Buffer<Knot> rest_;
  Buffer<std::uint32_t> first_knot_;  // parts + 1
  Buffer<Motion> motions_;
};

// Adds `weight` times what the clip does at `seconds` to the pose. Negative times and times past the end wrap around.
// kMisuse if the clip is not there or the pose is not one of this asset.
Result<void> addClip(const Asset& asset, int clip, double seconds, float weight, Pose& pose);
// Index of the clip of that name; -1: none.
int findClip(const Asset& asset, std::string_view name);

}  // namespace kelp::runtime
