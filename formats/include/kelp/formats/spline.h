// SPDX-License-Identifier: MIT
// The spline of a rig: cubic Hermite segments through knots, with +y along the spline. Knots, and what moves
// them, are in units of the part's height, as in rig files: 1 is size.y level-0 voxels. So no number of a rig
// or a pose depends on the resolution. Segments and boxes are in voxels. Source: Groen et al., "Spline Based
// Shell Mapping for Smooth Voxel Deformation", section 3.1, equations 1 and 2. Differences: several segments
// in a row, and tangents relative to the whole axis, not to one segment.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "kelp/formats/error.h"
#include "kelp/formats/geometry.h"

namespace kelp {

// A part has 2 to kMaxKnots knots. Their `at` ascends strictly from 0 to 1.
inline constexpr int kMaxKnots = 64;

// How a part follows its spline (formats/SPEC.md, "Bending").
enum class Bend : std::uint8_t {
  kShear = 0,  // sections stay level: the paper's map; the spline must rise
  kSweep = 1,  // sections stay perpendicular to the spline (kelp/formats/sweep.h); it may turn back and curl
};

// In units of the part's height.
struct Knot {
  float at = 0;           // place along the axis, 0 to 1; animation does not change it
  glm::vec3 position{0};  // (0, at, 0) in a straight rig
  glm::vec3 tangent{0};   // dS/d(at); (0, 1, 0) in a straight rig
};

// A cubic S(t), t in [0, 1], from p0 to p1, with dS/dt = m0 and m1 at the ends. Voxels.
struct Segment {
  glm::vec3 p0{0}, m0{0}, p1{0}, m1{0};
};

// The segment from knot k0 to knot k1 of a part of `height` voxels. Its slopes are the knots' tangents times
// height * (k1.at - k0.at).
Segment makeSegment(const Knot& k0, const Knot& k1, float height);

// How the automatic tangents of a knot and of its neighbors follow when the knot moves: each changes by its
// factor times the movement. An automatic tangent is the slope between the neighbors (Catmull-Rom),
// one-sided at the ends of the spline.
struct Follow {
  float before = 0, self = 0, after = 0;  // of the knot before, of the knot itself, of the knot after
};
// `knot` is an index into `knots`. Bit i of `automatic`: the tangent of knot i is automatic.
Follow followOf(std::span<const Knot> knots, std::size_t knot, std::uint64_t automatic);

// t in [0, 1].
glm::vec3 evaluate(const Segment& segment, float t);
glm::vec3 derivative(const Segment& segment, float t);  // dS/dt

// True if Sy(1) > Sy(0), and Sy never falls on [0, 1] by more than 1e-5 of that rise. The map of section 3.1
// of the paper needs this.
bool isMonotone(const Segment& segment);

// Checks that there are 2 to kMaxKnots knots, `at` ascends strictly from 0 to 1, and every number is finite.
// Else kMisuse; `offset` is the index of the knot. Safe for any numbers.
Result<void> checkPlaces(std::span<const Knot> knots);
// For sheared parts. Checks that there are 2 to kMaxKnots knots, `at` ascends strictly from 0 to 1, every
// number is finite, and every segment is monotone. Else kMisuse, or kNotMonotone if a segment is not;
// `offset` is the index of the knot. Safe for any numbers.
Result<void> checkKnots(std::span<const Knot> knots);

// A box that contains the spline of a part of `height` voxels, in voxels: the exact range of every segment,
// plus the error of evaluation in float. Empty for fewer than 2 knots.
Box splineBounds(std::span<const Knot> knots, float height);
// A box that contains every deformed voxel of a volume of `size` voxels, in voxels: that of the spline, plus
// the volume's base, because the deformed volume consists of copies of the base along the spline (section 3.1
// of the paper). Empty for fewer than 2 knots.
Box deformedBounds(std::span<const Knot> knots, const glm::ivec3& size);

}  // namespace kelp
