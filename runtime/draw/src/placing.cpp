// SPDX-License-Identifier: MIT
#include "placing.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace kelp::draw {
namespace {

// Added to the bounds on every side: a ray that meets a voxel in the box's very face must not be lost to
// rounding. Voxels.
constexpr float kMargin = 1.0f / 64.0f;

// The eye in part space by Cramer's rule: the columns of a matrix's inverse are the cross products of its
// rows, over the determinant. In double, whatever the size of the numbers. False: the matrix has no inverse.
bool eyeThoroughly(const glm::dvec3& r0, const glm::dvec3& r1, const glm::dvec3& r2, const glm::dvec3& d,
                   glm::vec4& eye) {
  const glm::dvec3 r12 = glm::cross(r1, r2);
  const double determinant = glm::dot(r0, r12), per = 1.0 / determinant;
  if (!std::isfinite(determinant) || !std::isfinite(per)) return false;
  eye = glm::vec4(glm::vec3(per * (d.x * r12 + d.y * glm::cross(r2, r0) + d.z * glm::cross(r0, r1))), eye.w);
  return true;
}

// Priority factor of hidden parts; they may come into view next.
constexpr float kHiddenWorth = 0.125f;

}  // namespace

namespace four {
using Floats = Lanes;
#include "placing.inl"
}  // namespace four

unsigned boundParts(const PosedParts& parts, PlacedParts& placed) {
  EightFloats heights;
  for (int part = 0; part < 8; ++part) heights.of[part] = parts.extents[part]->y;
  unsigned good = simd::boundKnots(parts.knots, heights, kMargin, placed.bounds);
  for (unsigned part = 0; good != 255 && part < 8; ++part) {
    if ((good >> part & 1) || !checkKnots(parts.knots[part])) continue;
    good |= 1u << part;
    const Box box = splineBounds(parts.knots[part], heights.of[part]);
    for (int axis = 0; axis < 3; ++axis) {
      placed.bounds.min[axis].of[part] = box.min[axis] - kMargin;
      placed.bounds.max[axis].of[part] = box.max[axis] + kMargin;
    }
  }
  return good;
}

void setBounds(const Box& box, const PosedParts& parts, std::size_t i, PlacedParts& placed) {
  // placeParts() adds the base of the part.
  const glm::vec3 base(parts.extents[i]->x, 0, parts.extents[i]->z);
  for (int axis = 0; axis < 3; ++axis) {
    placed.bounds.min[axis].of[i] = box.min[axis] - kMargin;
    placed.bounds.max[axis].of[i] = box.max[axis] - base[axis] + kMargin;
  }
}

namespace {

// The cases that lanes of floats leave: matrices of odd size, and directions whose length must be 1.
void settleEyes(const Projection& projection, PlacedParts& placed) {
  for (unsigned part = 0; part < 8; ++part) {
    glm::vec4 eye(placed.eye[0].of[part], placed.eye[1].of[part], placed.eye[2].of[part], 0);
    if (!(placed.ordinary >> part & 1)) {
      glm::dvec3 rows[3], away;
      for (int row = 0; row < 3; ++row) {
        const EightFloats(&r)[4] = placed.to_world[row];
        rows[row] = glm::dvec3(r[0].of[part], r[1].of[part], r[2].of[part]);
        away[row] = projection.eye[row] - projection.eye.w * double{r[3].of[part]};
      }
      if (!eyeThoroughly(rows[0], rows[1], rows[2], away, eye)) placed.invertible &= ~(1u << part);
    }
    if (projection.eye.w == 0) eye = glm::vec4(glm::normalize(glm::dvec3(eye)), 0);
    for (int axis = 0; axis < 3; ++axis) placed.eye[axis].of[part] = eye[axis];
  }
}

}  // namespace

void placeParts(const Projection& projection, const PosedParts& parts, PlacedParts& placed) {
  placed.affine = placed.invertible = placed.ordinary = 0;
  for (int first = 0; first < 8; first += 4) four::placeParts(projection, parts, first, placed);
  if (projection.eye.w == 0 || (placed.invertible & ~placed.ordinary)) settleEyes(projection, placed);
}

void judgeParts(const Projection& projection, const View& view, Rays rays, const PlacedParts& placed,
                JudgedParts& judged) {
  judged.seen = judged.small = 0;
  for (int first = 0; first < 8; first += 4) four::judgeParts(projection, view, rays, first, placed, judged);
  judged.seen &= placed.invertible;
  judged.small &= placed.invertible;
}

void writeHeads(const Projection& projection, const PlacedParts& placed, RecordHead* const (&heads)[8]) {
  for (int first = 0; first < 8; first += 4) four::writeHeads(projection, first, placed, heads);
}

Detail detailAt(const View& view, float pixels, int levels) {
  return Detail::of(four::chooseLevel(pixels, view.quality.pixels_per_voxel, view.quality.finest_level,
                                      static_cast<float>(levels))
                        .first());
}

bool isInvertible(const glm::mat4& m) {
  glm::vec4 eye(0);
  const glm::mat4 rows = glm::transpose(m);
  return std::isfinite(m[3][0] + m[3][1] + m[3][2]) &&
         eyeThoroughly(glm::vec3(rows[0]), glm::vec3(rows[1]), glm::vec3(rows[2]), glm::dvec3(0), eye);
}

namespace {

// For each set of axes along which the eye lies below the bounds (bits 0 to 2) or above them (3 to 5).
constexpr std::array<std::uint32_t, 64> makeOutlines() {
  std::array<std::uint32_t, 64> outlines{};
  for (std::uint32_t sides = 0; sides < 64; ++sides) {
    const std::uint32_t below = sides & 7, above = sides >> 3, beside = below | above;
    if (beside == 0 || (below & above) != 0) continue;
    // The corner at the eye, a at one side of it; b and c are the other axes, c one that the eye lies within
    // if there is one.
    const std::uint32_t corner = above;
    std::uint32_t a = 0, b = 0, c = 0;
    for (std::uint32_t axis = 1; axis < 8; axis *= 2) {
      if (!(beside & axis)) {
        (c == 0 ? c : b) = axis;
      } else {
        (a == 0 ? a : b == 0 ? b : c) = axis;
      }
    }
    const bool one = beside == a, two = !one && (beside & c) == 0;
    // Around the outline: of one face, of two, of three.
    const std::uint32_t loops[3][6] = {
        {0, b, b | c, c, c, c}, {b, 0, a, a | c, c, b | c}, {a, a | b, b, b | c, c, a | c}};
    const std::uint32_t(&loop)[6] = loops[one ? 0 : two ? 1 : 2];
    const int face_order[6] = {0, 1, 3, 2, 2, 2}, order[6] = {0, 1, 5, 2, 4, 3};
    for (int i = 0; i < 6; ++i) outlines[sides] |= (loop[one ? face_order[i] : order[i]] ^ corner) << (3 * i);
  }
  return outlines;
}
constexpr std::array<std::uint32_t, 64> kOutlines = makeOutlines();

}  // namespace

void outlineParts(bool orthographic, const PlacedParts& placed, std::uint32_t (&outlines)[8]) {
  EightFloats sides;
  for (int first = 0; first < 8; first += 4) four::findSides(orthographic, placed, first, sides);
  for (int part = 0; part < 8; ++part) outlines[part] = kOutlines[static_cast<std::size_t>(sides.of[part])];
}

}  // namespace kelp::draw
