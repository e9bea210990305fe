// SPDX-License-Identifier: MIT
#include "solid_search.h"

#include <cmath>

namespace kelp::runtime {

SearchFrame::SearchFrame(const SolidPlace& solid, const glm::dvec3& from) : eye(from) {
  const glm::dmat3& m = solid.to_world;
  const glm::dvec3 x = glm::normalize(m[0]), y = glm::normalize(m[1]), z = glm::normalize(m[2]);
  constexpr double kPerpendicular = 1e-6;
  if (std::abs(glm::dot(x, y)) < kPerpendicular && std::abs(glm::dot(x, z)) < kPerpendicular &&
      std::abs(glm::dot(y, z)) < kPerpendicular) {
    // A rotation although the part may be mirrored, and exactly one although the matrix is rounded.
    const glm::dvec3 across = glm::normalize(glm::cross(x, y));
    from_world = glm::transpose(glm::dmat3(x, glm::cross(across, x), across));
    shears = false;
  }
  to_frame = from_world * m;
  for (int i = 0; i < 3; ++i) grow[i] = (1 + 1e-9) * glm::abs(to_frame[i]);
  offset = from_world * (solid.origin - eye);
}

FrameBox boxOf(const SearchFrame& frame, const SplineMap& map, const SplineMap::Cut& from,
               const SplineMap::Cut& to, const glm::dvec3& low, const glm::dvec3& high) {
  constexpr double kRounding = 1e-6;
  const SplineMap::Box spline = map.sweep(from, to);
  return frame.place(
      {low.x + spline.min.x - kRounding, spline.min.y - kRounding, low.z + spline.min.z - kRounding},
      {high.x + spline.max.x + kRounding, spline.max.y + kRounding, high.z + spline.max.z + kRounding});
}

FrameBox boxOf(const SearchFrame& frame, const SweepMap& map, const SweepMap::Cut& from,
               const SweepMap::Cut& to, const glm::dvec3& low, const glm::dvec3& high) {
  glm::dvec3 least(INFINITY), most(-INFINITY);
  const int last = map.lastArc(from, to);
  for (int arc = from.arc; arc <= last; ++arc) {
    const SweepMap::Slab slab = map.slab(arc, from, to, low, high);
    const glm::dvec3 center = frame.place(slab.center);
    glm::dvec3 half = frame.grow * glm::dvec3(map.slack());
    for (int i = 0; i < 4; ++i) half += (1 + 1e-9) * glm::abs(frame.to_frame * slab.half[i]);
    least = glm::min(least, center - half);
    most = glm::max(most, center + half);
  }
  return {0.5 * (least + most), 0.5 * (most - least)};
}

}  // namespace kelp::runtime
