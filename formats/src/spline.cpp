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

Cubic axisOf(const Segment& s, int axis) { return {s.a[axis], s.b[axis], s.c[axis], s.d[axis]}; }

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
bool isFinite(const Segment& s) { return isFinite(s.a) && isFinite(s.b) && isFinite(s.c) && isFinite(s.d); }

}  // namespace

Segment makeSegment(const Knot& k0, const Knot& k1) {
  const float share = k1.at - k0.at;
  const glm::vec3 rise = k1.position - k0.position;
  const glm::vec3 m0 = k0.tangent * share;
  const glm::vec3 m1 = k1.tangent * share;
  Segment segment;
  segment.a = m0 + m1 - 2.0f * rise;
  segment.b = 3.0f * rise - 2.0f * m0 - m1;
  segment.c = m0;
  segment.d = k0.position;
  return segment;
}

glm::vec3 evaluate(const Segment& s, float t) { return s.d + t * (s.c + t * (s.b + t * s.a)); }

glm::vec3 derivative(const Segment& s, float t) { return s.c + t * (2.0f * s.b + t * (3.0f * s.a)); }

bool isMonotone(const Segment& segment) {
  const Cubic y = axisOf(segment, 1);
  const double rise = y.a + y.b + y.c;
  if (!(rise > 0.0) || !std::isfinite(rise)) return false;
  // The largest fall below any earlier height; the tolerance absorbs the rounding of the coefficients to float.
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
