// SPDX-License-Identifier: MIT
#include "kelp/formats/spline.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <glm/common.hpp>

#include "finite.h"
#include "layout.h"

namespace kelp {
namespace {

// One coordinate of a segment in double precision, so that the answers below concern the stored floats alone.
struct Cubic {
  double a, b, c, d;
  double operator()(double t) const { return d + t * (c + t * (b + t * a)); }
};

Cubic axisOf(const Segment& s, int axis) {
  const double m0 = s.m0[axis], m1 = s.m1[axis], rise = double{s.p1[axis]} - double{s.p0[axis]};
  return {m0 + m1 - 2 * rise, 3 * rise - 2 * m0 - m1, m0, s.p0[axis]};
}

// The same in float, for all three coordinates: S(t) = d + t (c + t (b + t a)).
struct Power {
  glm::vec3 a, b, c, d;
};
Power powerOf(const glm::vec3& p0, const glm::vec3& m0, const glm::vec3& p1, const glm::vec3& m1) {
  const glm::vec3 rise = p1 - p0;
  return {m0 + m1 - 2.0f * rise, 3.0f * rise - 2.0f * m0 - m1, m0, p0};
}
// Evaluates from the end that is nearer to t, so that both ends are exact.
bool fromEnd(float t) { return t > 0.5f; }
Power powerFrom(const Segment& s, bool end) {
  return end ? powerOf(s.p1, -s.m1, s.p0, -s.m0) : powerOf(s.p0, s.m0, s.p1, s.m1);
}

// The parameters where the cubic may turn, ascending: 0, the roots of its derivative inside (0, 1), 1.
// Returns their number, 2 to 4.
int turningPoints(const Cubic& f, double (&t)[4]) {
  int count = 0;
  t[count++] = 0.0;
  // 3a t^2 + 2b t + c = 0 by the form without cancellation. A double root is not a turn.
  const double qa = 3.0 * f.a, half_b = f.b, qc = f.c;
  const double discriminant = half_b * half_b - qa * qc;
  if (discriminant > 0.0) {
    const double q = -(half_b + std::copysign(std::sqrt(discriminant), half_b));
    double roots[2] = {qa != 0.0 ? q / qa : -1.0, q != 0.0 ? qc / q : -1.0};
    if (roots[0] > roots[1]) std::swap(roots[0], roots[1]);
    for (const double root : roots) {
      if (root > 0.0 && root < 1.0) t[count++] = root;
    }
  }
  t[count++] = 1.0;
  return count;
}

// Extends the box by the exact range of the segment, and by what evaluation in float may add.
void addExactRange(const Segment& segment, glm::vec3& low, glm::vec3& high) {
  for (int axis = 0; axis < 3; ++axis) {
    const Cubic f = axisOf(segment, axis);
    double t[4];
    const int count = turningPoints(f, t);
    const double slack = 0x1p-20 * (std::abs(f.a) + std::abs(f.b) + std::abs(f.c) + std::abs(f.d));
    for (int k = 0; k < count; ++k) {
      const double value = f(t[k]);
      low[axis] = std::min(low[axis], static_cast<float>(value - slack));
      high[axis] = std::max(high[axis], static_cast<float>(value + slack));
    }
  }
}

// Numbers up to this size can be added, subtracted and multiplied by 3 in float without overflow.
constexpr float kSafe = 1e30f;

// At least 0 if both slopes are at least 0 and their sum is at most 3 times the rise. A rising segment is
// then monotone (Fritsch and Carlson 1980). The rounding here is far below the tolerance of isMonotone.
float roomToTurn(float m0, float m1, float rise) {
  return std::min(std::min(m0, m1), 3.0f * rise - (m0 + m1));
}

float sizeOf(const glm::vec3& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

// A fast test that nearly every rig of a frame passes. False: look closer.
bool areFine(std::span<const Knot> knots) {
  if (knots.size() < 2 || knots.size() > static_cast<std::size_t>(kMaxKnots) || knots.front().at != 0.0f ||
      knots.back().at != 1.0f)
    return false;
  bool ascends = true;
  float sizes = sizeOf(knots[0].position) + sizeOf(knots[0].tangent);
  float least_rise = kSafe, least_room = kSafe;
  for (std::size_t i = 1; i < knots.size(); ++i) {
    const Knot &k0 = knots[i - 1], &k1 = knots[i];
    const float share = k1.at - k0.at, rise = k1.position.y - k0.position.y;
    sizes += sizeOf(k1.position) + sizeOf(k1.tangent);
    ascends &= share > 0.0f;
    least_rise = std::min(least_rise, rise);
    least_room = std::min(least_room, roomToTurn(k0.tangent.y * share, k1.tangent.y * share, rise));
  }
  // NaN anywhere makes `sizes` NaN, and the comparison false.
  return ascends && sizes < kSafe && least_rise > 0.0f && least_room >= 0.0f;
}

// True if the coefficients computed in float are finite.
bool staysFinite(const Segment& s) {
  for (const bool end : {false, true}) {
    const Power f = powerFrom(s, end);
    if (!isFinite(f.a) || !isFinite(f.b) || !isFinite(f.c) || !isFinite(f.d)) return false;
  }
  return true;
}

Error atKnot(ErrorCode code, const char* detail, std::size_t knot) {
  return {code, detail, knot, Error::Unit::kKnot};
}

}  // namespace

Segment makeSegment(const Knot& k0, const Knot& k1, float height) {
  const float share = height * (k1.at - k0.at);
  return {height * k0.position, share * k0.tangent, height * k1.position, share * k1.tangent};
}

Follow followOf(std::span<const Knot> knots, std::size_t knot, std::uint64_t automatic) {
  const std::size_t last = knots.size() - 1;
  const auto isAutomatic = [automatic](std::size_t i) { return (automatic >> i & 1) != 0; };
  // The slope at knot i is taken over this range of `at`.
  const auto range = [&](std::size_t i) {
    return knots[std::min(i + 1, last)].at - knots[i > 0 ? i - 1 : 0].at;
  };
  Follow follow;
  if (knot > 0 && isAutomatic(knot - 1)) follow.before = 1.0f / range(knot - 1);
  if (knot < last && isAutomatic(knot + 1)) follow.after = -1.0f / range(knot + 1);
  if (isAutomatic(knot) && knot == 0) follow.self = -1.0f / range(knot);
  if (isAutomatic(knot) && knot == last) follow.self = 1.0f / range(knot);
  return follow;
}

glm::vec3 evaluate(const Segment& s, float t) {
  const Power f = powerFrom(s, fromEnd(t));
  const float u = fromEnd(t) ? 1.0f - t : t;
  return f.d + u * (f.c + u * (f.b + u * f.a));
}

glm::vec3 derivative(const Segment& s, float t) {
  const Power f = powerFrom(s, fromEnd(t));
  const float u = fromEnd(t) ? 1.0f - t : t;
  const glm::vec3 slope = f.c + u * (2.0f * f.b + u * (3.0f * f.a));
  return fromEnd(t) ? -slope : slope;
}

bool isMonotone(const Segment& segment) {
  const Cubic y = axisOf(segment, 1);
  const double rise = double{segment.p1.y} - double{segment.p0.y};
  if (!(rise > 0.0) || !std::isfinite(y.a) || !std::isfinite(y.b)) return false;
  // The largest fall below an earlier height. The tolerance absorbs the rounding of positions and tangents to
  // float.
  double t[4];
  const int count = turningPoints(y, t);
  double highest = y(0.0), fall = 0.0;
  for (int i = 1; i < count; ++i) {
    const double height = y(t[i]);
    fall = std::max(fall, highest - height);
    highest = std::max(highest, height);
  }
  return fall <= 1e-5 * rise;
}

Result<void> checkPlaces(std::span<const Knot> knots) {
  if (knots.size() < 2) return atKnot(ErrorCode::kMisuse, "a rig needs at least 2 knots", 0);
  if (knots.size() > static_cast<std::size_t>(kMaxKnots))
    return atKnot(ErrorCode::kMisuse, "a rig has at most 64 knots", 0);
  for (std::size_t i = 0; i < knots.size(); ++i) {
    if (!std::isfinite(knots[i].at) || !isFinite(knots[i].position) || !isFinite(knots[i].tangent)) {
      return atKnot(ErrorCode::kMisuse, "a knot holds a number that is not finite", i);
    }
    if (i > 0 && !(knots[i].at > knots[i - 1].at))
      return atKnot(ErrorCode::kMisuse, "knots do not ascend along the axis", i);
  }
  if (knots.front().at != 0.0f) return atKnot(ErrorCode::kMisuse, "the first knot is not at 0", 0);
  if (knots.back().at != 1.0f)
    return atKnot(ErrorCode::kMisuse, "the last knot is not at 1", knots.size() - 1);
  return {};
}

Result<void> checkKnots(std::span<const Knot> knots) {
  if (areFine(knots)) return {};
  if (const Result<void> placed = checkPlaces(knots); !placed) return placed;
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    const Segment segment = makeSegment(knots[i], knots[i + 1], 1.0f);
    if (!staysFinite(makeSegment(knots[i], knots[i + 1], static_cast<float>(layout::kMaxSide))))
      return atKnot(ErrorCode::kMisuse, "a knot is too far away for 32-bit floats", i);
    if (!isMonotone(segment)) return atKnot(ErrorCode::kNotMonotone, "the spline turns back after a knot", i);
  }
  return {};
}

Box splineBounds(std::span<const Knot> knots, float height) {
  Box box;
  for (std::size_t i = 0; i + 1 < knots.size(); ++i)
    addExactRange(makeSegment(knots[i], knots[i + 1], height), box.min, box.max);
  return box;
}

Box deformedBounds(std::span<const Knot> knots, const glm::ivec3& size) {
  Box box = splineBounds(knots, static_cast<float>(size.y));
  if (box.empty()) return box;
  // Every copy of the base spans [0, X] x [0, Z] from the spline.
  box.max += glm::vec3(static_cast<float>(size.x), 0.0f, static_cast<float>(size.z));
  return box;
}

// Each coordinate of a corner is a sum of one of two numbers per axis, so its extremes are sums of extremes,
// rounding included (Arvo 1990).
bool isInvertible(const glm::mat4x3& m) {
  const double determinant =
      static_cast<double>(m[0].x) *
          (static_cast<double>(m[1].y) * m[2].z - static_cast<double>(m[1].z) * m[2].y) -
      static_cast<double>(m[1].x) *
          (static_cast<double>(m[0].y) * m[2].z - static_cast<double>(m[0].z) * m[2].y) +
      static_cast<double>(m[2].x) *
          (static_cast<double>(m[0].y) * m[1].z - static_cast<double>(m[0].z) * m[1].y);
  return isFinite(m) && std::isfinite(determinant) && determinant != 0.0;
}

Box transformed(const glm::mat4& matrix, const Box& box) {
  Box result;
  if (box.empty()) return result;
  glm::vec3 low[3], high[3];
  for (int axis = 0; axis < 3; ++axis) {
    const glm::vec3 column(matrix[axis]), a = box.min[axis] * column, b = box.max[axis] * column;
    low[axis] = glm::min(a, b);
    high[axis] = glm::max(a, b);
  }
  const glm::vec3 origin(matrix[3]);
  result.min = (low[0] + low[1]) + (low[2] + origin);
  result.max = (high[0] + high[1]) + (high[2] + origin);
  return result;
}

}  // namespace kelp
