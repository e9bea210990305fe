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

SplineMap::Cubic SplineMap::cubic(int segment) const {
  const auto i = static_cast<std::size_t>(segment);
  const Segment s = makeSegment(knots_[i], knots_[i + 1], height_);
  const glm::dvec3 p0(s.p0), m0(s.m0), m1(s.m1), rise = glm::dvec3(s.p1) - p0;
  return {p0, m0, 3.0 * rise - 2.0 * m0 - m1, m0 + m1 - 2.0 * rise};
}

SplineMap::Cut SplineMap::cutOf(const Cubic& c, int segment, double t) {
  return {segment, t, c.p0 + t * (c.m0 + t * (c.b + t * c.a)), c.m0 + t * (2.0 * c.b + 3.0 * t * c.a)};
}

SplineMap::Cut SplineMap::cut(double y) const {
  std::size_t i = 0;
  while (i + 2 < knots_.size() && y > double{height_ * knots_[i + 1].position.y}) ++i;
  const Segment s = makeSegment(knots_[i], knots_[i + 1], height_);
  const auto segment = static_cast<int>(i);
  const Cubic c = cubic(segment);
  const double t = trace::kelpSplineParameter(asTrace(s), static_cast<float>(y - double{s.p0.y}),
                                              static_cast<float>(double{s.p1.y} - y));
  // From float to double precision.
  const Cut rough = cutOf(c, segment, t);
  if (!(rough.slope.y > 0)) return rough;
  const Cut fine = cutOf(c, segment, std::clamp(t - (rough.at.y - y) / rough.slope.y, 0.0, 1.0));
  return std::abs(fine.at.y - y) < std::abs(rough.at.y - y) ? fine : rough;
}

bool SplineMap::between(const Cut& a, const Cut& b, Cut& middle) const {
  if (a.segment == b.segment) {
    middle = cutAt(a.segment, 0.5 * (a.t + b.t));
  } else if (b.segment > a.segment + 1) {
    middle = cutAt((a.segment + b.segment + 1) / 2, 0);
  } else {
    middle = a.t < 1 ? cutAt(a.segment, 1) : cutAt(b.segment, 0.5 * b.t);
  }
  return (middle.segment != a.segment || middle.t > a.t) && (middle.segment != b.segment || middle.t < b.t);
}

bool SplineMap::isFine(const Cut& from, const Cut& to, const glm::dvec3&, const glm::dvec3&,
                       double side) const {
  constexpr double kFineEnough = 0.25;
  const Box box = sweep(from, to);
  return std::max(box.max.x - box.min.x, box.max.z - box.min.z) <= kFineEnough * side;
}

glm::dvec3 SplineMap::nearest(const Cut& from, const Cut& to, const glm::dvec3& low, const glm::dvec3& high,
                              const glm::dvec3& point) const {
  const double y = std::clamp(point.y, from.at.y, to.at.y);
  const Cut at = y == from.at.y ? from : y == to.at.y ? to : cut(y);
  return {at.at.x + std::clamp(point.x - at.at.x, low.x, high.x), at.at.y,
          at.at.z + std::clamp(point.z - at.at.z, low.z, high.z)};
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

namespace {

// How the deformed set lies at a cut, as seen from a point at another one: the heights differ by d, the
// spline has moved sideways by s, and the set is at least R beside the rest point, because there it is at
// least `rest` away. So it is at least sqrt(max(R - s, 0)^2 + d^2) away.
struct Seen {
  SplineMap::Cut cut;
  double d, s, r;
  double squared() const { return d * d + (r > s ? (r - s) * (r - s) : 0.0); }
};
struct Piece {
  Seen near, far;
};
struct Eye {
  SplineMap::Cut cut;
  double rest2 = 0, stretch = 1, end = 0;  // end: the d where R becomes 0

  Seen see(const SplineMap::Cut& cut_there) const {
    const glm::dvec3 move = cut_there.at - cut.at;
    const double climb = stretch * move.y;
    return {cut_there, std::abs(move.y), std::sqrt(across2(move)),
            std::sqrt(std::max(rest2 - climb * climb, 0.0))};
  }
};

// The least square of the distance from (0, 0) to the line from (d0, g0) to (d1, g1), g0 > 0, where it is
// above the axis.
double toLine2(double d0, double g0, double d1, double g1) {
  if (g1 < 0) {
    d1 = d0 + (d1 - d0) * g0 / (g0 - g1);
    g1 = 0;
  }
  const double x = d1 - d0, y = g1 - g0, length2 = x * x + y * y;
  const double u = length2 > 0 ? std::clamp(-(d0 * x + g0 * y) / length2, 0.0, 1.0) : 0.0;
  return (d0 + u * x) * (d0 + u * x) + (g0 + u * y) * (g0 + u * y);
}

// At most the least of Seen::squared() in a piece: where s is at most m d, that of a shear by m is known.
double shearBound(const Eye& eye, const Piece& piece, double most_s) {
  const SplineMap::Cut &near = piece.near.cut, &far = piece.far.cut;
  double m2 = INFINITY;
  if (piece.near.d > 0) {
    m2 = most_s * most_s / (piece.near.d * piece.near.d);
  } else {  // by the three steps of the curve's hull
    const double third = (far.t - near.t) / 3;
    const glm::dvec3 first = third * near.slope, end = third * far.slope,
                     middle = far.at - near.at - first - end;
    const double steepest = std::max({across2(first), across2(middle), across2(end)});
    const double up = std::min({first.y, middle.y, end.y}), down = -std::max({first.y, middle.y, end.y});
    if (const double rise = std::max(up, down); rise > 0) m2 = steepest / (rise * rise);
  }
  return m2 < 1e12 ? eye.rest2 / lengthening2(m2, eye.stretch) : 0.0;
}

// At most the least of Seen::squared() in a piece. R is above its chord; s is below its own, but for what the
// curve differs from it, a cubic whose inner control points say how much at most.
double pieceBound(const Eye& eye, const Piece& piece, double enough) {
  const Seen &near = piece.near, &far = piece.far;
  double bound2 = near.d * near.d;
  const double rise = far.d - near.d;
  if (near.d >= eye.end || !(rise > 0)) return bound2;
  if (near.d == 0) bound2 = shearBound(eye, piece, 0);
  if (bound2 >= enough) return bound2;
  const double third = (far.cut.t - near.cut.t) / 3;
  const glm::dvec3 chord = (far.cut.at - near.cut.at) / (far.cut.at.y - near.cut.at.y);
  const double off = 0.75 * std::abs(third) *
                     std::sqrt(std::max(across2(near.cut.slope - near.cut.slope.y * chord),
                                        across2(far.cut.slope - far.cut.slope.y * chord)));
  const double share = far.d > eye.end ? (eye.end - near.d) / rise : 1.0;
  const double g0 = near.r - near.s - off, g1 = far.r - (near.s + share * (far.s - near.s)) - off;
  if (g0 > 0) bound2 = std::max(bound2, toLine2(near.d, g0, near.d + share * rise, g1));
  if (bound2 >= enough || near.d == 0) return bound2;
  return std::max(bound2, shearBound(eye, piece, std::max(near.s, far.s) + off));
}

}  // namespace

// Where the spline hardly leans: the bound of the steepest shear within reach. 0: it leans more.
double SplineMap::gentleBound(const Cut& cut, double rest) const {
  constexpr double kHardly2 = 0.02;  // the square of a slope
  double m2 = 0;
  const int last = static_cast<int>(knots_.size()) - 2;
  const auto addSegment = [&](int segment) {
    const Cubic c = cubic(segment);
    const glm::dvec3 end = c.m0 + 2.0 * c.b + 3.0 * c.a, middle = 3.0 * (c.m0 + c.b + c.a) - c.m0 - end;
    const double rise = std::min({c.m0.y, middle.y, end.y});
    if (!(rise > 0)) return false;
    m2 = std::max(m2, std::max({across2(c.m0), across2(middle), across2(end)}) / (rise * rise));
    return m2 < kHardly2;
  };
  if (!addSegment(cut.segment)) return 0;
  const auto knotY = [&](int knot) {
    return double{height_ * knots_[static_cast<std::size_t>(knot)].position.y};
  };
  for (int i = cut.segment + 1; i <= last && knotY(i) < cut.at.y + rest; ++i)
    if (!addSegment(i)) return 0;
  for (int i = cut.segment - 1; i >= 0 && knotY(i + 1) > cut.at.y - rest; --i)
    if (!addSegment(i)) return 0;
  return rest / std::sqrt(lengthening2(m2, stretch_));
}

namespace {

// How far along a segment, in t, the height changes by about as much as the bound will be.
double firstStep(const glm::dvec3& slope, double bend, double rest, double stretch) {
  const double steep = std::max(slope.y, 1e-9);
  const double likely = rest / std::sqrt(lengthening2(across2(slope) / (steep * steep), stretch));
  const double rise = std::max(likely, 0.05 * rest);
  return 2 * rise / (steep + std::sqrt(steep * steep + 4 * std::abs(bend) * rise));
}

// The same as pieceBound() by what is known from another height of the line through the point along y:
// `other` is there, and d still counts from `eye`.
double secondBound(const Eye& other, const Seen& near, const Seen& far) {
  const Seen a = other.see(near.cut), b = other.see(far.cut);
  double bound2 = near.d * near.d;
  const double climb = far.cut.at.y - near.cut.at.y;
  if (a.d >= other.end || b.d >= other.end || climb == 0) return bound2;
  const double third = (far.cut.t - near.cut.t) / 3;
  const glm::dvec3 chord = (far.cut.at - near.cut.at) / climb;
  const double off = 0.75 * std::abs(third) *
                     std::sqrt(std::max(across2(near.cut.slope - near.cut.slope.y * chord),
                                        across2(far.cut.slope - far.cut.slope.y * chord)));
  const double g0 = a.r - a.s - off, g1 = b.r - b.s - off;
  return g0 > 0 ? toLine2(near.d, g0, far.d, g1) : bound2;
}
double secondSquared(const Eye& other, const Seen& at) {
  const Seen seen = other.see(at.cut);
  return at.d * at.d + (seen.r > seen.s ? (seen.r - seen.s) * (seen.r - seen.s) : 0.0);
}

}  // namespace

// Goes along the spline in pieces, up and down, until they are farther than the least bound. A piece whose
// bound is far below the least square found at any one cut (target) is split. Returns the square of the
// bound, and where it is least.
double SplineMap::alongSpline(const Cut& cut, double rest, const Cut* second, double second_rest,
                              Cut& weakest) const {
  constexpr double kGoodEnough = 0.75;
  const Eye eye{cut, rest * rest, stretch_, rest / stretch_};
  const Eye other{second ? *second : cut, second_rest * second_rest, stretch_, second_rest / stretch_};
  const int last = static_cast<int>(knots_.size()) - 2;
  double target = rest * rest, least = target;
  int splits = 24;
  const Cubic own = cubic(cut.segment);
  const double first_step = firstStep(cut.slope, own.b.y + 3 * cut.t * own.a.y, rest, stretch_);
  for (const int way : {1, -1}) {
    Seen near = eye.see(cut);
    double step = first_step;
    for (int segment = cut.segment; segment >= 0 && segment <= last; segment += way) {
      const Cubic c = segment == cut.segment ? own : cubic(segment);
      if (segment != cut.segment) near = eye.see(cutOf(c, segment, way > 0 ? 0 : 1));
      const double end = way > 0 ? 1 : 0;
      while (near.cut.t != end) {
        if (near.d * near.d >= least) break;  // and so is everything beyond
        const double t = near.cut.t + way * step;
        const Seen far = eye.see(cutOf(c, segment, (t - end) * way < 0 ? t : end));
        target =
            std::min(target, second ? std::max(far.squared(), secondSquared(other, far)) : far.squared());
        double bound2 = pieceBound(eye, {near, far}, kGoodEnough * target);
        if (second && bound2 < kGoodEnough * target) bound2 = std::max(bound2, secondBound(other, near, far));
        if (bound2 < kGoodEnough * target && splits > 0) {
          --splits;
          step = 0.5 * std::abs(far.cut.t - near.cut.t);
          continue;
        }
        if (bound2 < least) {
          least = bound2;
          weakest = far.squared() < near.squared() ? far.cut : near.cut;
        }
        near = far;
        step *= 2;
      }
      if (near.d * near.d >= least) break;
    }
  }
  return least;
}

double SplineMap::bound(const Cut& cut, double rest, const RestAt& rest_at) const {
  if (!(rest > 0)) return 0;
  if (const double gentle = gentleBound(cut, rest); gentle > 0) return gentle;
  constexpr double kPoor = 0.1;  // of squares
  Cut weakest = cut, unused = cut;
  const double first = alongSpline(cut, rest, nullptr, 0, weakest);
  if (!rest_at.call || first > kPoor * rest * rest) return std::sqrt(first);
  const double there = rest_at.call(rest_at.user, weakest);
  return std::sqrt(std::max(first, alongSpline(cut, rest, &weakest, there, unused)));
}

}  // namespace kelp::runtime
