// SPDX-License-Identifier: MIT
// The spline of a rig: cubic Hermite segments through knots, in level-0 voxels of the part, with +y along the
// spline. Source: Groen et al., "Spline Based Shell Mapping for Smooth Voxel Deformation", section 3.1,
// equations 1 and 2. Differences: several segments in a row, and tangents relative to the whole axis, not to
// one segment.
#pragma once

#include <span>

#include "kelp/formats/error.h"
#include "kelp/formats/geometry.h"

namespace kelp {

// A part has 2 to kMaxKnots knots. Their `at` ascends strictly from 0 to 1.
inline constexpr int kMaxKnots = 64;

struct Knot {
  float at = 0;           // place along the axis, 0 to 1; animation does not change it
  glm::vec3 position{0};  // voxels; (0, at * size.y, 0) in a straight rig
  glm::vec3 tangent{0};   // dS/d(at), voxels; (0, size.y, 0) in a straight rig
};

// A cubic S(t), t in [0, 1], from p0 to p1, with dS/dt = m0 and m1 at the ends. Voxels.
struct Segment {
  glm::vec3 p0{0}, m0{0}, p1{0}, m1{0};
};

// The segment from knot k0 to knot k1. Its slopes are the knots' tangents times k1.at - k0.at.
Segment makeSegment(const Knot& k0, const Knot& k1);

// t in [0, 1].
glm::vec3 evaluate(const Segment& segment, float t);
glm::vec3 derivative(const Segment& segment, float t);  // dS/dt

// Whether Sy(1) > Sy(0), and Sy never falls on [0, 1] by more than 1e-5 of that rise. The map of section 3.1
// of the paper needs this.
bool isMonotone(const Segment& segment);

// Checks that there are 2 to kMaxKnots knots, `at` ascends strictly from 0 to 1, every number is finite, and
// every segment is monotone. Else kMisuse, or kNotMonotone if a segment is not; `offset` is the index of the
// knot. Safe for any numbers.
Result<void> checkKnots(std::span<const Knot> knots);

// A box that contains every deformed voxel of a volume of `size` voxels, in voxels. The deformed volume
// consists of copies of the volume's base along the spline (section 3.1 of the paper). So the box is the
// exact range of every segment, plus the error of evaluation in float, plus the base. Empty for fewer than 2
// knots.
Box deformedBounds(std::span<const Knot> knots, const glm::ivec3& size);

}  // namespace kelp
