// SPDX-License-Identifier: MIT
// How the parts of a pose move: each with its parent, some with a place on their parent's spline, some as
// the host's joints say.
#pragma once

#include <array>
#include <span>

#include "kelp/simd/lanes.h"
#include "posed_part.h"

namespace kelp::runtime {

// As a * b.
inline glm::mat4 product(const glm::mat4& a, const glm::mat4& b) {
  using simd::Lanes;
  const Lanes x = Lanes::load(&a[0].x), y = Lanes::load(&a[1].x), z = Lanes::load(&a[2].x),
              w = Lanes::load(&a[3].x);
  glm::mat4 both;
  for (int i = 0; i < 4; ++i) ((x * b[i].x + y * b[i].y) + (z * b[i].z + w * b[i].w)).store(&both[i].x);
  return both;
}

// Segment and parameter at a height in rest space, where y = size.y (Sy(t) - Sy(0)) / (Sy(1) - Sy(0)).
struct SplinePoint {
  Segment segment;
  float t = 0;
};
SplinePoint splineAtHeight(std::span<const Knot> knots, float height, float y);

// The arcs of a part, made in `room`; null if it is not swept, or cannot be drawn.
const ArcChain* arcsOf(const PosedPart& posed, ArcChain& room);

// Orthonormal and right-handed: y runs along the second column of `axes`, x by the first, or by the third
// where that is parallel to y. All in a space that `to_space` takes to another; so does the origin, `at`.
glm::mat4 frameOf(const glm::mat4& to_space, const glm::mat3& axes, const glm::vec3& at);
// The frame of a rest point (part space) of a part that `to_space` takes to some space. y points along the
// spline. `arcs`: those of the part.
glm::mat4 frameIn(const PosedPart& posed, const ArcChain* arcs, const glm::mat4& to_space,
                  const glm::vec3& rest);
// The rest point at a place of the axis, `offset` heights from the middle line; part space.
glm::vec3 onAxis(const Part& part, float at, const glm::vec2& offset);

// Of one pose. The arcs of a spline are worked out once for the parts on it that follow one another. Kept on
// the stack; allocates nothing.
class PartMotions {
 public:
  // Null: at rest. Both must live as long.
  PartMotions(std::span<const Part> parts, const Pose* pose) : rest_(parts), pose_(pose) { parts_.fill(-1); }

  // Object at rest -> object now, of what moves with the part.
  glm::mat4 of(int part);
  // The same with what the parent's motion is, the identity for a part without a parent.
  glm::mat4 below(const glm::mat4& parent, int part);

 private:
  glm::mat4 step(int part);  // within what the parent's motion is
  const glm::mat4& onSpline(int part);

  static constexpr std::size_t kPlaces = 32;  // a part's is its index modulo this
  std::span<const Part> rest_;
  const Pose* pose_;
  std::array<int, kPlaces> parts_;
  std::array<glm::mat4, kPlaces> matrices_;
  int parent_ = -1;  // whose arcs these are, as posed and at rest; null: not swept, or it cannot be drawn
  ArcChain posed_, as_rested_;
  const ArcChain *posed_arcs_ = nullptr, *rest_arcs_ = nullptr;
};

}  // namespace kelp::runtime
