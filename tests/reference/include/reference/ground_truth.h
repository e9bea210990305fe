// SPDX-License-Identifier: MIT
// Ground truth for tracing, in double precision and independent of shaders/trace.glsl and of kelp's spline
// code: which solid voxel does a deformed ray touch first? By subdivision of the Bezier hull of the curve, so
// that no voxel can be missed, however thin the touch.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "kelp/formats/spline.h"

namespace kelp::reference {

// A dense volume: x fastest, then y, then z; not 0 is solid.
struct Volume {
  glm::ivec3 size{0};
  std::span<const std::uint8_t> solid;
  double scale = 1;     // voxels of this volume per level-0 voxel: 2^-level
  glm::ivec3 size0{0};  // level-0 size, for the spline's stretch
  // not 0: `solid` is a tile of this size that repeats over the volume, which may then be larger than any
  // memory
  glm::ivec3 tile{0};
};

struct Touch {
  double s = 0;  // along the ray
  double t = 0;  // spline parameter within the segment
  int segment = 0;
  glm::ivec3 voxel{0};  // a solid voxel that is touched there
  glm::dvec3 q{0};      // position in the undeformed volume, voxels of the volume
};

// The segments as the library rounds them are the segments.
inline std::vector<Segment> segmentsOf(std::span<const Knot> knots, const glm::ivec3& size) {
  std::vector<Segment> segments;
  for (std::size_t i = 0; i + 1 < knots.size(); ++i)
    segments.push_back(makeSegment(knots[i], knots[i + 1], static_cast<float>(size.y)));
  return segments;
}

// The first point of o + s r, s in [s_min, s_max], that lies in the solid - the union of its voxels - shrunk
// by `erode` voxels, measured along the axes (negative: grown). r is a unit vector, part space. Exact to
// about 1e-6 voxel. `voxel` is a solid voxel that is touched there.
std::optional<Touch> firstTouch(const Volume& volume, std::span<const Knot> knots, const glm::dvec3& o,
                                const glm::dvec3& r, double s_min, double s_max, double erode);

}  // namespace kelp::reference
