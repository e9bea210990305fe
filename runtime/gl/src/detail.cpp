// SPDX-License-Identifier: MIT
#include "detail.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "kelp/formats/lanes.h"

namespace kelp::gl {
namespace {

// Added to the bounds on every side: a ray that meets a voxel in the box's very face must not be lost to rounding. Voxels.
constexpr float kMargin = 1.0f / 64.0f;

bool isFinite(const glm::dmat4& m) {
  double sum = 0;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) sum += 0.0 * m[column][row];
  }
  return sum == 0.0;
}

}  // namespace

Result<Camera> makeCamera(const View& view) {
  const glm::dmat4 to_eye(view.world_to_eye);
  const glm::dmat4 to_clip(view.eye_to_clip);
  Camera camera;
  camera.world_to_clip = to_clip * to_eye;
  camera.linear = camera.world_to_clip;
  const double determinant = glm::determinant(camera.world_to_clip);
  if (!isFinite(camera.world_to_clip) || !std::isfinite(determinant) || determinant == 0.0) {
    return Error{ErrorCode::kMisuse, "the view's matrices are not finite and invertible"};
  }
  // All rays of a view meet where clip x, y and w vanish: at the eye, or, orthographic, at infinity.
  const bool orthographic = to_clip[0][3] == 0 && to_clip[1][3] == 0 && to_clip[2][3] == 0;
  camera.eye = glm::inverse(camera.world_to_clip) * glm::dvec4(0, 0, 1, 0);
  if (orthographic) {
    camera.eye /= glm::length(glm::dvec3(camera.eye));
    if ((to_eye * camera.eye).z > 0) camera.eye = -camera.eye;
    camera.eye.w = 0;
  } else {
    camera.eye /= camera.eye.w;
  }
  double side = 0;  // of a unit cube in eye space: to_world has what world_to_eye does not scale
  for (int axis = 0; axis < 3; ++axis) side = std::max(side, glm::length(glm::dvec3(to_eye[axis])));
  const double pixels = std::max(glm::length(glm::dvec3(to_clip[0][0], to_clip[1][0], to_clip[2][0])) * view.viewport.x,
                                 glm::length(glm::dvec3(to_clip[0][1], to_clip[1][1], to_clip[2][1])) * view.viewport.y);
  camera.pixel_scale = static_cast<float>(0.5 * side * pixels);
  return camera;
}

bool boundPart(std::span<const Knot> knots, const glm::ivec3& size, Box& bounds) {
  if (boundSoundKnots(knots, size, kMargin, bounds)) return true;
  if (!checkKnots(knots)) return false;
  bounds = deformedBounds(knots, size);
  bounds.min -= kMargin;
  bounds.max += kMargin;
  return true;
}

namespace {

// The eye in part space by Cramer's rule: the columns of a matrix's inverse are the cross products of its rows, over the determinant.
// In double, whatever the size of the numbers. False: the matrix has no inverse.
bool eyeThoroughly(const glm::dvec3& r0, const glm::dvec3& r1, const glm::dvec3& r2, const glm::dvec3& d, glm::vec4& eye) {
  const glm::dvec3 r12 = glm::cross(r1, r2);
  const double determinant = glm::dot(r0, r12), per = 1.0 / determinant;
  if (!std::isfinite(determinant) || !std::isfinite(per)) return false;
  eye = glm::vec4(glm::vec3(per * (d.x * r12 + d.y * glm::cross(r2, r0) + d.z * glm::cross(r0, r1))), eye.w);
  return true;
}

// Rays leave the bounds at a point and go to the eye, so that an error of the eye's by a part of its distance moves a hit by that part of the box: float
// does, but for determinants near the ends of its range. `d`: from the part's origin to the eye, in the world.
bool placeEye(const Lanes& r0, const Lanes& r1, const Lanes& r2, const glm::dvec3& d, RecordHead& head) {
  const Lanes s0 = r0.rotated3(), s1 = r1.rotated3(), s2 = r2.rotated3();
  const Lanes r12 = r1 * s2 - s1 * r2, r20 = r2 * s0 - s2 * r0, r01 = r0 * s1 - s0 * r1;  // turned by one place
  const Lanes terms = s0.rotated3() * r12;
  const float determinant = (terms + (terms.all<1>() + terms.all<2>())).first();
  if (!(std::abs(determinant) > 1e-24f && std::abs(determinant) < 1e24f)) {
    return eyeThoroughly(glm::vec3(head.to_world[0]), glm::vec3(head.to_world[1]), glm::vec3(head.to_world[2]), d, head.eye);
  }
  const Lanes sum = (static_cast<float>(d.x) * r12 + static_cast<float>(d.y) * r20) + static_cast<float>(d.z) * r01;
  float eye[4];
  ((1.0f / determinant) * sum.rotated3()).store(eye);
  head.eye = glm::vec4(eye[0], eye[1], eye[2], head.eye.w);
  return true;
}

// Where a point of the world is in clip space: the sum may be small beside its terms, so it is of doubles.
Lanes toClip(const glm::dmat4& m, const glm::vec4& p) {
  const DoubleLanes x(double{p.x}), y(double{p.y}), z(double{p.z});
  const auto half = [&](int row) {
    return (DoubleLanes::load(&m[0][row]) * x + DoubleLanes::load(&m[1][row]) * y) + (DoubleLanes::load(&m[2][row]) * z + DoubleLanes::load(&m[3][row]));
  };
  return rounded(half(0), half(2));
}

}  // namespace

bool isInvertible(const glm::mat4& m) {
  glm::vec4 eye(0);
  const glm::mat4 rows = glm::transpose(m);
  return std::isfinite(m[3][0] + m[3][1] + m[3][2]) && eyeThoroughly(glm::vec3(rows[0]), glm::vec3(rows[1]), glm::vec3(rows[2]), glm::dvec3(0), eye);
}

bool placePart(const Camera& camera, const glm::mat4& to_world, const Box& bounds, RecordHead& head, PlacedPart& placed) {
  Lanes r0 = Lanes::load(&to_world[0][0]), r1 = Lanes::load(&to_world[1][0]), r2 = Lanes::load(&to_world[2][0]), r3 = Lanes::load(&to_world[3][0]);
  const Lanes w0 = Lanes::load(&camera.linear[0][0]), w1 = Lanes::load(&camera.linear[1][0]), w2 = Lanes::load(&camera.linear[2][0]);
  const auto turned = [&](const Lanes& v) { return w0 * v.all<0>() + w1 * v.all<1>() + w2 * v.all<2>(); };
  const Lanes mx = turned(r0), my = turned(r1), mz = turned(r2), mw = toClip(camera.world_to_clip, to_world[3]);
  const auto store = [](const Lanes& lanes, glm::vec4& to) { lanes.store(&to[0]); };
  Lanes row0 = mx, row1 = my, row2 = mz, row3 = mw;
  transpose(row0, row1, row2, row3);
  store(row0, head.to_clip[0]);
  store(row1, head.to_clip[1]);
  store(row2, head.to_clip[2]);
  store(row3, head.to_clip[3]);
  transpose(r0, r1, r2, r3);
  store(r0, head.to_world[0]);
  store(r1, head.to_world[1]);
  store(r2, head.to_world[2]);

  // A linear function over a box is greatest where every term is: its value at the centre, and |term| times half a side for each. The planes'
  // functions are w + x, w - x and so on; with w in x's place, w itself. Roundings must not make a part that is seen lie outside.
  const Lanes low = Lanes::load(&bounds.min.x), high = Lanes::load(&bounds.min.z).rotated();  // and numbers that do not matter
  const Lanes centre = 0.5f * (low + high), half = high - centre;
  const Lanes at = (mx * centre.all<0>() + my * centre.all<1>()) + (mz * centre.all<2>() + mw);
  const Lanes x = mx * half.all<0>(), y = my * half.all<1>(), z = mz * half.all<2>();
  const Lanes at_w = at.all<3>(), x_w = x.all<3>(), y_w = y.all<3>(), z_w = z.all<3>();
  const Lanes above = abs(x_w + x) + abs(y_w + y) + abs(z_w + z), below = abs(x_w - x) + abs(y_w - y) + abs(z_w - z);
  const Lanes slack = 1e-6f * (above + below + (abs(at_w) + abs(at)));
  placed.outside = lessBits(min(at_w + at + above, at_w - at + below) + slack, 0.0f) != 0;
  placed.nearest = (at_w - (abs(x_w) + abs(y_w) + abs(z_w))).first();
  // A number that is not finite anywhere in to_world is in this one.
  if (!std::isfinite(placed.nearest)) return false;

  head.eye.w = static_cast<float>(camera.eye.w);
  if (!placeEye(r0, r1, r2, glm::dvec3(camera.eye) - camera.eye.w * glm::dvec3(to_world[3]), head)) return false;
  if (head.eye.w == 0) head.eye = glm::vec4(glm::vec3(glm::normalize(glm::dvec3(head.eye))), 0);

  const Lanes sides = r0 * r0 + r1 * r1 + r2 * r2;
  const float side = std::sqrt(max(sides, max(sides.all<1>(), sides.all<2>())).first());
  placed.pixels = side * camera.pixel_scale / std::max(placed.nearest, 1e-20f);
  return true;
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

std::uint32_t outlineOf(const glm::vec4& eye, const Box& bounds) {
  static_assert(offsetof(Box, max) == 3 * sizeof(float));
  const Lanes at = Lanes::load(&eye.x), low = Lanes::load(&bounds.min.x), high = Lanes::load(&bounds.min.z).rotated();
  if (eye.w == 0) return kOutlines[(lessBits(0.0f, at) & 7) | (lessBits(at, 0.0f) & 7) << 3];
  const glm::vec3 extent = bounds.max - bounds.min;
  const float close = (1.0f / 16.0f) * std::max(extent.x, std::max(extent.y, extent.z));
  if (((lessBits(at, low - close) | lessBits(high + close, at)) & 7) == 0) return 0;
  return kOutlines[(lessBits(at, low) & 7) | (lessBits(high, at) & 7) << 3];
}

namespace {

// The base-2 logarithm of a positive number, to 0.00013: the exponent, and a polynomial in the fraction, exact at both ends.
float logarithm(float x) {
  std::uint32_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  const int exponent = static_cast<int>(bits >> 23) - 127;
  const std::uint32_t one = (bits & 0x7fffffu) | 0x3f800000u;
  float fraction;
  std::memcpy(&fraction, &one, sizeof fraction);
  fraction -= 1.0f;
  return static_cast<float>(exponent) + fraction * (1.4383793f + fraction * (-0.6758807f + fraction * (0.3181545f - 0.0806531f * fraction)));
}

}  // namespace

Detail chooseDetail(float pixels, float wanted, int finest, int levels) {
  const Detail detail{std::min(finest, levels - 1), 0};
  // As many levels up as the voxels are too small, by powers of two.
  if (!(wanted > pixels * static_cast<float>(1u << detail.level))) return detail;
  const float between = logarithm(wanted / pixels);
  if (!(between < static_cast<float>(levels - 1))) return {levels - 1, 0};
  const int whole = std::max(static_cast<int>(between), detail.level);
  return {whole, std::max(0, static_cast<int>(64.0f * (between - static_cast<float>(whole))))};
}

bool drawsCoarser(const Detail& detail, const glm::ivec2& pixel) {
  const int x = pixel.x ^ pixel.y;
  const int y = pixel.y;
  return ((x & 1) << 5 | (y & 1) << 4 | (x & 2) << 2 | (y & 2) << 1 | (x & 4) >> 1 | (y & 4) >> 2) < detail.coarser;
}

}  // namespace kelp::gl
