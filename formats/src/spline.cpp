// SPDX-License-Identifier: MIT
#include "kelp/formats/spline.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace kelp {
namespace {

// One coordinate of a segment in double precision, so that the questions below are about the stored floats and nothing else.
struct Cubic {
  double a, b, c, d;
  double operator()(double t) const { return d + t * (c + t * (b + t * a)); }
};

Cubic axisOf(const Segment& s, int axis) {
  const double m0 = s.m0[axis], m1 = s.m1[axis], rise = double{s.p1[axis]} - double{s.p0[axis]};
  return {m0 + m1 - 2 * rise, 3 * rise - 2 * m0 - m1, m0, s.p0[axis]};
}

// The same in float, for every coordinate: S(t) = d + t (c + t (b + t a)).
struct Power {
  glm::vec3 a, b, c, d;
};
Power powerOf(const glm::vec3& p0, const glm::vec3& m0, const glm::vec3& p1, const glm::vec3& m1) {
  const glm::vec3 rise = p1 - p0;
  return {m0 + m1 - 2.0f * rise, 3.0f * rise - 2.0f * m0 - m1, m0, p0};
}
// From the end that is nearer to t, so that both are met exactly.
bool fromEnd(float t) { return t > 0.5f; }
Power powerFrom(const Segment& s, bool end) { return end ? powerOf(s.p1, -s.m1, s.p0, -s.m0) : powerOf(s.p0, s.m0, s.p1, s.m1); }

// Parameters where the cubic may turn, ascending: 0, the roots of its derivative inside (0, 1), 1. Answers how many, 2 to 4.
int turningPoints(const Cubic& f, double (&t)[4]) {
  int count = 0;
  t[count++] = 0.0;
  // 3a t^2 + 2b t + c = 0 by the form that does not cancel; a double or missing root is no turn.
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

bool isFinite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
// Also of what is computed from them in float.
bool isFinite(const Segment& s) {
  for (const bool end : {false, true}) {
    const Power f = powerFrom(s, end);
    if (!isFinite(f.a) || !isFinite(f.b) || !isFinite(f.c) || !isFinite(f.d)) return false;
  }
  return true;
}

}  // namespace

Segment makeSegment(const Knot& k0, const Knot& k1) {
  const float share = k1.at - k0.at;
  return {k0.position, k0.tangent * share, k1.position, k1.tangent * share};
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
  // The largest fall below any earlier height; the tolerance absorbs the rounding of positions and tangents to float.
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

Result<void> checkKnots(std::span<const Knot> knots) {
  if (knots.size() < 2) return Error{ErrorCode::kMisuse, "a rig needs at least 2 knots", 0};
  if (knots.size() > static_cast<std::size_t>(kMaxKnots)) return Error{ErrorCode::kMisuse, "a rig has at most 64 knots", 0};
  for (std::size_t i = 0; i < knots.size(); ++i) {
    if (!std::isfinite(knots[i].at) || !isFinite(knots[i].position) || !isFinite(knots[i].tangent)) {
      return Error{ErrorCode::kMisuse, "a knot holds a number that is not finite", i};
    }
    if (i > 0 && !(knots[i].at > knots[i - 1].at)) return Error{ErrorCode::kMisuse, "knots do not ascend along the axis", i};
  }
  if (knots.front().at != 0.0f) return Error{ErrorCode::kMisuse, "the first knot is not at 0", 0};
  if (knots.back().at != 1.0f) return Error{ErrorCode::kMisuse, "the last knot is not at 1", knots.size() - 1};
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    const Segment segment = makeSegment(knots[i], knots[i + 1]);
    if (!isFinite(segment)) return Error{ErrorCode::kMisuse, "a knot is too far away to compute with", i};
    if (!isMonotone(segment)) return Error{ErrorCode::kNotMonotone, "the spline turns back after a knot", i};
  }
  return {};
}

void straightKnots(const glm::ivec3& size, Knot (&knots)[2]) {
  const float height = static_cast<float>(size.y);
  knots[0] = {0.0f, glm::vec3(0.0f), glm::vec3(0.0f, height, 0.0f)};
  knots[1] = {1.0f, glm::vec3(0.0f, height, 0.0f), glm::vec3(0.0f, height, 0.0f)};
}

Box deformedBounds(std::span<const Knot> knots, const glm::ivec3& size) {
  Box box;
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    const Segment segment = makeSegment(knots[i], knots[i + 1]);
    glm::vec3 low(0.0f), high(0.0f);
    for (int axis = 0; axis < 3; ++axis) {
      const Cubic f = axisOf(segment, axis);
      double t[4];
      const int count = turningPoints(f, t);
      double least = f(t[0]), most = least;
      for (int k = 1; k < count; ++k) {
        least = std::min(least, f(t[k]));
        most = std::max(most, f(t[k]));
      }
      // Whoever evaluates the segment in float may land this far outside (eight roundings of the largest partial sum).
      const double slack = 0x1p-20 * (std::abs(f.a) + std::abs(f.b) + std::abs(f.c) + std::abs(f.d));
      low[axis] = static_cast<float>(least - slack);
      high[axis] = static_cast<float>(most + slack);
    }
    // Every copy of the base spans [0, X] x [0, Z] from the spline.
    box.add(low);
    box.add(high + glm::vec3(static_cast<float>(size.x), 0.0f, static_cast<float>(size.z)));
  }
  return box;
}

}  // namespace kelp
