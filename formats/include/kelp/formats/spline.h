// SPDX-License-Identifier: MIT
// The spline of a rig: cubic Hermite segments through knots, in level-0 voxels of the part, +y along the spline.
// Source: Groen et al., "Spline Based Shell Mapping for Smooth Voxel Deformation", section 3.1, equations 1 and 2.
// Deviation: several segments in a row, and tangents that belong to the whole axis instead of to one segment.
#pragma once

#include <span>

#include "kelp/formats/error.h"
#include "kelp/formats/geometry.h"

namespace kelp {

// A part has 2 to kMaxKnots knots; `at` ascends strictly from 0 to 1.
inline constexpr int kMaxKnots = 64;

struct Knot {
  float at = 0;           // where along the axis the knot belongs, 0 .. 1; constant under animation
  glm::vec3 position{0};  // voxels; the straight rig has (0, at * size.y, 0)
  glm::vec3 tangent{0};   // dS/d(at), voxels; the straight rig has (0, size.y, 0)
};

// A cubic S(t), t in [0, 1], from p0 to p1 with the slopes dS/dt = m0 and m1 there; voxels.
struct Segment {
  glm::vec3 p0{0}, m0{0}, p1{0}, m1{0};
};

// The segment from knot k0 to knot k1: the tangents are scaled by the segment's share of the axis, k1.at - k0.at.
Segment makeSegment(const Knot& k0, const Knot& k1);

glm::vec3 evaluate(const Segment& segment, float t);
glm::vec3 derivative(const Segment& segment, float t);  // dS/dt

// Whether Sy never decreases on [0, 1] (up to 1e-5 of its rise) and rises in all: what the map of section 3.1 of the paper needs.
bool isMonotone(const Segment& segment);

// Whether every segment between the knots is monotone, every number is finite, and `at` ascends strictly from 0 to 1.
// kNotMonotone or kMisuse with the knot's index in `offset` if not.
Result<void> checkKnots(std::span<const Knot> knots);

// Straight knots for a volume of `size` voxels: two of them.
void straightKnots(const glm::ivec3& size, Knot (&knots)[2]);

// A box that contains every deformed voxel of a volume of `size` voxels (section 3.1 of the paper: copies of the base along the spline):
// the exact range of every segment, widened by what evaluation in float may err, swept by the base. Voxels. Fewer than 2 knots: empty.
Box deformedBounds(std::span<const Knot> knots, const glm::ivec3& size);

}  // namespace kelp
