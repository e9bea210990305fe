// SPDX-License-Identifier: MIT
#include "placing.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace kelp::gl {
namespace {

// Added to the bounds on every side: a ray that meets a voxel in the box's very face must not be lost to rounding. Voxels.
constexpr float kMargin = 1.0f / 64.0f;

// The eye in part space by Cramer's rule: the columns of a matrix's inverse are the cross products of its rows, over the determinant.
// In double, whatever the size of the numbers. False: the matrix has no inverse.
bool eyeThoroughly(const glm::dvec3& r0, const glm::dvec3& r1, const glm::dvec3& r2, const glm::dvec3& d, glm::vec4& eye) {
  const glm::dvec3 r12 = glm::cross(r1, r2);
  const double determinant = glm::dot(r0, r12), per = 1.0 / determinant;
  if (!std::isfinite(determinant) || !std::isfinite(per)) return false;
  eye = glm::vec4(glm::vec3(per * (d.x * r12 + d.y * glm::cross(r2, r0) + d.z * glm::cross(r0, r1))), eye.w);
  return true;
}

// Four numbers of type float, one by one.
struct Numbers {
  float of[4];
  explicit Numbers(const Lanes& lanes) { lanes.store(of); }
  operator Lanes() const { return Lanes::load(of); }
};

Lanes cross(const Lanes (&a)[4], const Lanes (&b)[4], int axis) {
  const int next = (axis + 1) % 3, last = (axis + 2) % 3;
  return a[next] * b[last] - b[next] * a[last];
}

void storeRow(const Lanes& x, const Lanes& y, const Lanes& z, const Lanes& w, glm::vec4* const (&to)[4]) {
  Lanes rows[4] = {x, y, z, w};
  transpose(rows[0], rows[1], rows[2], rows[3]);
  for (int part = 0; part < 4; ++part) rows[part].store(&to[part]->x);
}

}  // namespace

unsigned boundParts(const std::span<const Knot> (&knots)[4], const glm::ivec3* const (&sizes)[4], PlacedParts& placed) {
  const auto all = [&](int axis) {
    const auto of = [&](int part) { return static_cast<float>((*sizes[part])[axis]); };
    return Lanes::of(of(0), of(1), of(2), of(3));
  };
  const unsigned sound = boundSoundKnots({{knots[0], knots[1], knots[2], knots[3]}, all(0), all(2)}, kMargin, placed.bounds);
  if (sound == 15) return sound;
  unsigned good = sound;
  for (unsigned part = 0; part < 4; ++part) {
    if ((sound >> part & 1) || !checkKnots(knots[part])) continue;
    good |= 1u << part;
    const Box box = deformedBounds(knots[part], *sizes[part]);
    for (int axis = 0; axis < 3; ++axis) {
      Numbers low(placed.bounds.min[axis]), high(placed.bounds.max[axis]);
      low.of[part] = box.min[axis] - kMargin;
      high.of[part] = box.max[axis] + kMargin;
      placed.bounds.min[axis] = low;
      placed.bounds.max[axis] = high;
    }
  }
  return good;
}

void placeParts(const Camera& camera, const glm::mat4 (&to_world)[4], PlacedParts& placed, RecordHead* const (&heads)[4]) {
  Lanes world[4][4];  // [row][column]
  for (int column = 0; column < 4; ++column) {
    for (int part = 0; part < 4; ++part) world[part][column] = Lanes::load(&to_world[part][column][0]);
    transpose(world[0][column], world[1][column], world[2][column], world[3][column]);
  }
  Lanes clip[4][4];
  const auto both = [](const auto& function) { return rounded(function(&lowHalf), function(&highHalf)); };
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 3; ++column) {
      clip[row][column] = camera.linear[0][row] * world[0][column] + camera.linear[1][row] * world[1][column] + camera.linear[2][row] * world[2][column];
    }
    // A sum that may be small beside its terms, so it is of doubles.
    const glm::dmat4& m = camera.world_to_clip;
    clip[row][3] = both([&](DoubleLanes (*half)(Lanes)) {
      return (m[0][row] * half(world[0][3]) + m[1][row] * half(world[1][3])) + (m[2][row] * half(world[2][3]) + m[3][row]);
    });
  }

  // A linear function over a box is greatest where every term is: its value at the centre, and |term| times half a side for each. The planes'
  // functions are w + x, w - x and so on, and w itself. Roundings must not make a part that is seen lie outside.
  Lanes centre[3], reach[4][3], at[4];
  for (int axis = 0; axis < 3; ++axis) {
    centre[axis] = 0.5f * (placed.bounds.min[axis] + placed.bounds.max[axis]);
    const Lanes half = placed.bounds.max[axis] - centre[axis];
    for (int row = 0; row < 4; ++row) reach[row][axis] = half * clip[row][axis];
  }
  for (int row = 0; row < 4; ++row) at[row] = (clip[row][0] * centre[0] + clip[row][1] * centre[1]) + (clip[row][2] * centre[2] + clip[row][3]);
  const Lanes at_w = at[3], spread = abs(reach[3][0]) + abs(reach[3][1]) + abs(reach[3][2]);
  placed.nearest = at_w - spread;
  placed.outside = lessBits(at_w + spread + 2e-6f * (spread + abs(at_w)), 0.0f);
  for (int row = 0; row < 3; ++row) {
    Lanes above = 0.0f, below = 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
      above = above + abs(reach[3][axis] + reach[row][axis]);
      below = below + abs(reach[3][axis] - reach[row][axis]);
    }
    const Lanes slack = 1e-6f * (above + below + (abs(at_w) + abs(at[row])));
    placed.outside |= lessBits(min(at_w + at[row] + above, at_w - at[row] + below) + slack, 0.0f);
  }
  // A number that is not finite anywhere in to_world is in this one.
  placed.invertible = lessBits(abs(placed.nearest), std::numeric_limits<float>::infinity());

  // Rays leave the bounds at a point and go to the eye, so that an error of the eye's by a part of its distance moves a hit by that part of the box: float
  // does, but for determinants near the ends of its range. `away`: from the part's origin to the eye, in the world.
  Lanes away[3];
  for (int axis = 0; axis < 3; ++axis) {
    away[axis] = both([&](DoubleLanes (*half)(Lanes)) { return camera.eye[axis] - camera.eye.w * half(world[axis][3]); });
  }
  Lanes r12[3], determinant = 0.0f;
  for (int axis = 0; axis < 3; ++axis) {
    r12[axis] = cross(world[1], world[2], axis);
    determinant = determinant + world[0][axis] * r12[axis];
  }
  const Lanes per = 1.0f / determinant;
  for (int axis = 0; axis < 3; ++axis) {
    placed.eye[axis] = per * ((away[0] * r12[axis] + away[1] * cross(world[2], world[0], axis)) + away[2] * cross(world[0], world[1], axis));
  }
  const unsigned ordinary = lessBits(1e-24f, abs(determinant)) & lessBits(abs(determinant), 1e24f);
  const bool orthographic = camera.eye.w == 0;
  if (orthographic || (placed.invertible & ~ordinary)) {
    Numbers x(placed.eye[0]), y(placed.eye[1]), z(placed.eye[2]);
    for (unsigned part = 0; part < 4; ++part) {
      glm::vec4 eye(x.of[part], y.of[part], z.of[part], 0);
      if (!(ordinary >> part & 1)) {
        const glm::mat4 rows = glm::transpose(to_world[part]);
        const glm::dvec3 d = glm::dvec3(camera.eye) - camera.eye.w * glm::dvec3(to_world[part][3]);
        if (!eyeThoroughly(glm::vec3(rows[0]), glm::vec3(rows[1]), glm::vec3(rows[2]), d, eye)) placed.invertible &= ~(1u << part);
      }
      if (orthographic) eye = glm::vec4(glm::normalize(glm::dvec3(eye)), 0);
      x.of[part] = eye.x, y.of[part] = eye.y, z.of[part] = eye.z;
    }
    placed.eye[0] = x, placed.eye[1] = y, placed.eye[2] = z;
  }

  Lanes side = 0.0f;
  for (int column = 0; column < 3; ++column) {
    side = max(world[0][column] * world[0][column] + world[1][column] * world[1][column] + world[2][column] * world[2][column], side);
  }
  placed.pixels = sqrt(side) * camera.pixel_scale / max(placed.nearest, 1e-20f);

  for (int row = 0; row < 4; ++row) {
    storeRow(clip[row][0], clip[row][1], clip[row][2], clip[row][3], {&heads[0]->to_clip[row], &heads[1]->to_clip[row], &heads[2]->to_clip[row], &heads[3]->to_clip[row]});
  }
  for (int row = 0; row < 3; ++row) {
    storeRow(world[row][0], world[row][1], world[row][2], world[row][3], {&heads[0]->to_world[row], &heads[1]->to_world[row], &heads[2]->to_world[row], &heads[3]->to_world[row]});
  }
  storeRow(placed.eye[0], placed.eye[1], placed.eye[2], static_cast<float>(camera.eye.w), {&heads[0]->eye, &heads[1]->eye, &heads[2]->eye, &heads[3]->eye});
}

bool isInvertible(const glm::mat4& m) {
  glm::vec4 eye(0);
  const glm::mat4 rows = glm::transpose(m);
  return std::isfinite(m[3][0] + m[3][1] + m[3][2]) && eyeThoroughly(glm::vec3(rows[0]), glm::vec3(rows[1]), glm::vec3(rows[2]), glm::dvec3(0), eye);
}

namespace {

// For each set of axes along which the eye lies below the bounds (bits 0 to 2) or above them (3 to 5).
constexpr std::array<std::uint32_t, 64> makeOutlines() {
  std::array<std::uint32_t, 64> outlines{};
  for (std::uint32_t sides = 0; sides < 64; ++sides) {
    const std::uint32_t below = sides & 7, above = sides >> 3, beside = below | above;
    if (beside == 0 || (below & above) != 0) continue;
    // The corner at the eye, a at one side of it; b and c are the other axes, c one that the eye lies within if there is one.
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
    const std::uint32_t loops[3][6] = {{0, b, b | c, c, c, c}, {b, 0, a, a | c, c, b | c}, {a, a | b, b, b | c, c, a | c}};
    const std::uint32_t(&loop)[6] = loops[one ? 0 : two ? 1 : 2];
    const int face_order[6] = {0, 1, 3, 2, 2, 2}, order[6] = {0, 1, 5, 2, 4, 3};
    for (int i = 0; i < 6; ++i) outlines[sides] |= (loop[one ? face_order[i] : order[i]] ^ corner) << (3 * i);
  }
  return outlines;
}
constexpr std::array<std::uint32_t, 64> kOutlines = makeOutlines();

}  // namespace

std::uint32_t outlineOf(const glm::vec4& eye, const Lanes& low, const Lanes& high) {
  const Lanes at = Lanes::load(&eye.x);
  if (eye.w == 0) return kOutlines[(lessBits(0.0f, at) & 7) | (lessBits(at, 0.0f) & 7) << 3];
  const Lanes extent = high - low;
  const Lanes close = (1.0f / 16.0f) * max(max(extent.all<0>(), extent.all<1>()), extent.all<2>());
  if (((lessBits(at, low - close) | lessBits(high + close, at)) & 7) == 0) return 0;
  return kOutlines[(lessBits(at, low) & 7) | (lessBits(high, at) & 7) << 3];
}

}  // namespace kelp::gl
