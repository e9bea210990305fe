// SPDX-License-Identifier: MIT
#include "spline_map.h"

#include <algorithm>
#include <cmath>

#include "posed_part.h"

namespace kelp::runtime {
namespace {

double across2(const glm::dvec3& v) { return v.x * v.x + v.z * v.z; }

// The control points of a cubic between two of its places.
struct Hull {
  glm::dvec3 p[4];
};
Hull hullOf(const SplineMap::Cut& a, const SplineMap::Cut& b) {
  const double third = (b.t - a.t) / 3;
  return {{a.at, a.at + third * a.slope, b.at - third * b.slope, b.at}};
}

// The square of the largest factor by which the map (x, y) -> (x - m y, h y) lengthens a vector.
double lengthening2(double m2, double h) {
  const double sum = 1 + m2 + h * h;
  return 0.5 * (sum + std::sqrt(std::max(sum * sum - 4 * h * h, 0.0)));
}

}  // namespace

SplineMap::SplineMap(std::span<const Knot> knots, const glm::ivec3& size)
    : knots_(knots), height_(static_cast<float>(size.y)) {
  low_ = height_ * knots.front().position.y;
  high_ = height_ * knots.back().position.y;
  stretch_ = double{height_} / (high_ - low_);
}

SplineMap::Cut SplineMap::cutAt(int segment, double t) const {
  const auto i = static_cast<std::size_t>(segment);
  const Segment s = makeSegment(knots_[i], knots_[i + 1], height_);
  const glm::dvec3 p0(s.p0), m0(s.m0), m1(s.m1), rise = glm::dvec3(s.p1) - p0;
  const glm::dvec3 a = m0 + m1 - 2.0 * rise, b = 3.0 * rise - 2.0 * m0 - m1;
  return {segment, t, p0 + t * (m0 + t * (b + t * a)), m0 + t * (2.0 * b + 3.0 * t * a)};
}

SplineMap::Cut SplineMap::cut(double y) const {
  std::size_t i = 0;
  while (i + 2 < knots_.size() && y > double{height_ * knots_[i + 1].position.y}) ++i;
  const Segment s = makeSegment(knots_[i], knots_[i + 1], height_);
  const auto segment = static_cast<int>(i);
  double t = trace::kelpSplineParameter(asTrace(s), static_cast<float>(y - double{s.p0.y}),
                                        static_cast<float>(double{s.p1.y} - y));
  // From float to double precision.
  const double rise = double{s.p1.y} - double{s.p0.y}, m0 = s.m0.y, m1 = s.m1.y;
  const double a = m0 + m1 - 2 * rise, b = 3 * rise - 2 * m0 - m1, target = y - double{s.p0.y};
  const double slope = m0 + t * (2 * b + 3 * t * a);
  if (slope > 0) {
    const double next = std::clamp(t - (t * (m0 + t * (b + t * a)) - target) / slope, 0.0, 1.0);
    if (std::abs(next * (m0 + next * (b + next * a)) - target) <=
        std::abs(t * (m0 + t * (b + t * a)) - target))
      t = next;
  }
  return cutAt(segment, t);
}

SplineMap::Cut SplineMap::between(const Cut& a, const Cut& b) const {
  if (a.segment == b.segment) return cutAt(a.segment, 0.5 * (a.t + b.t));
  if (b.segment > a.segment + 1) return cutAt((a.segment + b.segment + 1) / 2, 0);
  return a.t < 1 ? cutAt(a.segment, 1) : cutAt(b.segment, 0.5 * b.t);
}

glm::dvec3 SplineMap::gradient(const Cut& cut, const glm::dvec3& g) const {
  glm::dvec3 slope = cut.slope;
  // The spline runs level here: to the side of it.
  slope.y = std::max(slope.y, 1e-6 * (std::abs(slope.x) + std::abs(slope.z)) + 1e-30);
  return {slope.y * g.x, stretch_ * slope.y * g.y - slope.x * g.x - slope.z * g.z, slope.y * g.z};
}

SplineMap::Box SplineMap::sweep(const Cut& a, const Cut& b) const {
  Box box{a.at, a.at};
  const auto add = [&box](const Cut& from, const Cut& to) {
    for (const glm::dvec3& p : hullOf(from, to).p) {
      box.min = glm::min(box.min, p);
      box.max = glm::max(box.max, p);
    }
  };
  Cut from = a;
  while (from.segment < b.segment) {
    add(from, cutAt(from.segment, 1));
    from = cutAt(from.segment + 1, 0);
  }
  add(from, b);
  box.min.y = a.at.y;
  box.max.y = b.at.y;
  return box;
}

// The square of a distance that no point of the deformed set between two cuts is nearer than, on one side of
// `from`. At a height that differs by d the set is at least R = sqrt(rest^2 - (stretch d)^2) beside the rest
// point, and the spline has moved sideways by some s: the distance is at least sqrt(max(R - s, 0)^2 + d^2).
// Either with the extremes of R, s and d in the piece, or with s <= m d, whose least value is known.
double SplineMap::pieceBound(const Cut& from, const Piece& piece, double rest2) const {
  const Hull hull = hullOf(piece.near, piece.far);
  double side2 = 0;
  for (const glm::dvec3& p : hull.p) side2 = std::max(side2, across2(p - from.at));
  const double near = std::abs(piece.near.at.y - from.at.y), far = std::abs(piece.far.at.y - from.at.y);
  const double beside = std::sqrt(std::max(rest2 - stretch_ * stretch_ * far * far, 0.0)) - std::sqrt(side2);
  double bound2 = near * near + (beside > 0 ? beside * beside : 0.0);
  double m2 = near > 0 ? side2 / (near * near) : INFINITY;
  if (piece.first) {
    double run2 = 0, rise = INFINITY;
    for (int i = 0; i < 3; ++i) {
      const glm::dvec3 step = hull.p[i + 1] - hull.p[i];
      run2 = std::max(run2, across2(step));
      rise = std::min(rise, std::abs(step.y) * (step.y * (piece.far.at.y - from.at.y) >= 0 ? 1 : 0));
    }
    if (rise > 0) m2 = std::min(m2, run2 / (rise * rise));
  }
  if (m2 < 1e12) bound2 = std::max(bound2, rest2 / lengthening2(m2, stretch_));
  return bound2;
}

// Goes along the spline to one side. target: the least value found at any one cut. A piece whose bound is far
// below it is split.
void SplineMap::addPieces(const Cut& from, bool up, double rest2, int& splits, double& target,
                          double& least) const {
  constexpr double kGoodEnough = 0.8;
  constexpr int kDeepest = 12;
  const int last = static_cast<int>(knots_.size()) - 2;
  Piece stack[kDeepest];
  Cut near = from;
  for (int segment = from.segment; segment >= 0 && segment <= last; segment += up ? 1 : -1) {
    if (segment != from.segment) near = cutAt(segment, up ? 0 : 1);
    int count = 0;
    stack[count++] = {near, cutAt(segment, up ? 1 : 0), segment == from.segment};
    while (count > 0) {
      const Piece piece = stack[--count];
      const double nearest = piece.near.at.y - from.at.y;
      if (nearest * nearest >= least) return;  // and so is everything beyond
      const glm::dvec3 d = piece.far.at - from.at;
      const double beside =
          std::sqrt(std::max(rest2 - stretch_ * stretch_ * d.y * d.y, 0.0)) - std::sqrt(across2(d));
      target = std::min(target, d.y * d.y + (beside > 0 ? beside * beside : 0.0));
      const double bound2 = pieceBound(from, piece, rest2);
      if (bound2 >= kGoodEnough * target || splits == 0 || count + 2 > kDeepest) {
        least = std::min(least, bound2);
        continue;
      }
      --splits;
      const Cut middle = cutAt(piece.near.segment, 0.5 * (piece.near.t + piece.far.t));
      stack[count++] = {middle, piece.far, false};
      stack[count++] = {piece.near, middle, piece.first};
    }
  }
}

double SplineMap::bound(const Cut& cut, double rest) const {
  if (!(rest > 0)) return 0;
  double target = rest * rest, least = target;
  for (const bool up : {true, false}) {
    int splits = 8;
    addPieces(cut, up, rest * rest, splits, target, least);
  }
  return std::sqrt(least);
}

}  // namespace kelp::runtime
