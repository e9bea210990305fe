// SPDX-License-Identifier: MIT
#include "kelp/formats/sweep.h"

#include <algorithm>
#include <cmath>

#include "finite.h"
#include "layout.h"

namespace kelp {
namespace {

using glm::dot;
using glm::dvec3;

// A place of the center line. z of the section is cross(x, along).
struct Place {
  dvec3 at, along, x;
};

// The arc from a place to a point: it leaves along `along`.
struct Reach {
  dvec3 chord, side;  // to the point; and its part perpendicular to `along`
  double chord2, ahead, side2;
  Reach(const Place& from, const dvec3& to)
      : chord(to - from.at),
        side(chord - dot(chord, from.along) * from.along),
        chord2(dot(chord, chord)),
        ahead(dot(chord, from.along)),
        side2(dot(side, side)) {}
  // The vector towards the center of curvature, of the length of the curvature.
  dvec3 inward() const { return (2 / chord2) * side; }
};

// How far a point is from the circle of an arc, in its plane and across.
double offCircle(const Place& from, const Reach& arc, const dvec3& point) {
  const dvec3 e = point - from.at, k = arc.inward();
  const double curvature = std::sqrt(dot(k, k)), l = dot(e, from.along);
  const dvec3 off = e - l * from.along;
  if (!(curvature > 0)) return std::sqrt(dot(off, off));
  const dvec3 inward = k / curvature;
  const double p = dot(off, inward), across = dot(off, off) - p * p;
  const double x = 1 - curvature * p, y = curvature * l, g = std::sqrt(x * x + y * y);
  const double u = (2 * p - curvature * (p * p + l * l)) / (1 + g);
  return std::sqrt(u * u + std::max(across, 0.0));
}

// The cubic between two knots, voxels.
struct Span {
  dvec3 p0, m0, p1, m1;
  dvec3 at(double t) const {
    const double u = 1 - t;
    return (u * u * (1 + 2 * t)) * p0 + (u * u * t) * m0 + (t * t * (1 + 2 * u)) * p1 - (t * t * u) * m1;
  }
  dvec3 slope(double t) const {
    const double u = 1 - t;
    return (6 * t * u) * (p1 - p0) + (u * (1 - 3 * t)) * m0 + (t * (3 * t - 2)) * m1;
  }
};

// An arc's direction at its end: its chord halves the turn.
dvec3 endAlong(const Place& from, const Reach& arc) {
  return (2 * arc.ahead / arc.chord2) * arc.chord - from.along;
}

// Two arcs from one place and direction to another, with equal lengths of the tangents on both sides.
struct Biarc {
  bool good = false;
  dvec3 joint{0};
  Biarc(const dvec3& p0, const dvec3& t0, const dvec3& p1, const dvec3& t1) {
    const dvec3 v = p1 - p0;
    const double v2 = dot(v, v), ahead = dot(v, t0 + t1);
    const dvec3 turn = t1 - t0;
    const double d = v2 / (ahead + std::sqrt(ahead * ahead + dot(turn, turn) * v2));
    joint = 0.5 * (p0 + p1 - d * turn);
    good = ahead > 0 && v2 > 0 && std::isfinite(d);
  }
};

class ChainMaker {
 public:
  ChainMaker(const glm::ivec3& size, ArcChain& chain)
      : half_x_(0.5 * size.x),
        half_z_(0.5 * size.z),
        corner_(glm::length(glm::dvec2(half_x_, half_z_))),
        size_(size),
        chain_(chain) {
    chain_.count = 0;
  }

  Result<void> make(std::span<const Knot> knots, double roll, double tolerance) {
    const double height = size_.y;
    tolerance *= height;
    const auto spans = static_cast<int>(knots.size()) - 1;
    int most = 16;  // pieces of a span, a power of two
    while (most > 1 && 2 * most * spans > kMaxArcs) most /= 2;
    start(knots.front(), roll);
    double y = 0;
    for (int i = 0; i < spans; ++i) {
      const Knot &a = knots[static_cast<std::size_t>(i)], &b = knots[static_cast<std::size_t>(i) + 1];
      const double share = height * (double{b.at} - double{a.at});
      const Span span{place(a), share * dvec3(a.tangent), place(b), share * dvec3(b.tangent)};
      const int first = chain_.count;
      length_ = 0;
      if (const char* wrong = addSpan(span, tolerance, most))
        return Error{wrong == kTooMany ? ErrorCode::kMisuse : ErrorCode::kFolds, wrong,
                     static_cast<std::uint64_t>(i), Error::Unit::kKnot};
      const double rise = share / length_;
      double from = 0;
      for (int j = first; j < chain_.count; ++j) {
        Arc& arc = chain_.arcs[j];
        const double to = from + lengths_[j];
        arc.rise = static_cast<float>(rise);
        arc.y = static_cast<float>(y + 0.5 * (from + to) * rise);
        chain_.joints[j].y = static_cast<float>(y + from * rise);
        from = to;
      }
      y = height * double{b.at};
    }
    finish(y);
    return {};
  }

 private:
  static constexpr const char* kFolding =
      "the spline bends too sharply for the part's thickness between this knot and the next";
  static constexpr const char* kTooMany = "the spline winds too often: a part has at most 256 arcs";
  static constexpr const char* kTurning =
      "the spline turns back on itself between this knot and the next: a tangent points away from where it "
      "goes";

  dvec3 place(const Knot& knot) const {
    return dvec3(half_x_, 0, half_z_) + double(size_.y) * dvec3(knot.position);
  }

  // The section at the first knot: turned by the least from +y to the tangent, then rolled.
  void start(const Knot& knot, double roll) {
    const dvec3 tangent(knot.tangent);
    at_.at = place(knot);
    at_.along = tangent / std::sqrt(dot(tangent, tangent));
    const dvec3& t = at_.along;
    dvec3 x(-1, 0, 0), z(0, 0, 1);  // the tangent points down: half a turn about z
    if (t.y > -1 + 1e-12) {
      const dvec3 both = t + dvec3(0, 1, 0);
      x = dvec3(1, 0, 0) - (t.x / (1 + t.y)) * both;
      z = dvec3(0, 0, 1) - (t.z / (1 + t.y)) * both;
    }
    at_.x = std::cos(roll) * x - std::sin(roll) * z;
    chain_.start_x = glm::vec3(at_.x);
    chain_.start_z = glm::vec3(glm::cross(at_.x, t));
    low_ = high_ = at_.at;
    addSection(at_.at, half_x_ * at_.x, half_z_ * glm::cross(at_.x, t));
    addJoint();
  }

  // Null, or what is wrong.
  const char* addSpan(const Span& span, double tolerance, int most) {
    const dvec3 end_along = span.m1 / std::sqrt(dot(span.m1, span.m1)),
                miss = endAlong(at_, Reach(at_, span.p1)) - end_along;
    const int wanted = piecesOf(span, end_along, tolerance), pieces = std::min(wanted, most);
    if (dot(miss, miss) < 1e-18 && wanted == 1) return addArc(span.p1);  // as of a straight spline
    dvec3 p0 = span.p0, t0 = at_.along;
    for (int i = 1; i <= pieces; ++i) {
      const double t = static_cast<double>(i) / pieces;
      const dvec3 p1 = i == pieces ? span.p1 : span.at(t), slope = i == pieces ? span.m1 : span.slope(t);
      const dvec3 t1 = slope / std::sqrt(dot(slope, slope));
      const Biarc biarc(p0, t0, p1, t1);
      if (!biarc.good) return kTurning;
      if (const char* wrong = addArc(biarc.joint)) return wrong;
      if (const char* wrong = addArc(p1)) return wrong;
      at_.along = t1;  // but for rounding, it is
      p0 = p1;
      t0 = t1;
    }
    return nullptr;
  }

  // Into how many pieces a span is cut, each two arcs: the error of a cubic falls with the third power of
  // their number. It is taken from one piece: from the jump of the curvature within it, and at three places.
  int piecesOf(const Span& span, const dvec3& end_along, double tolerance) const {
    const Biarc whole(span.p0, at_.along, span.p1, end_along);
    if (!whole.good || !(dot(span.slope(0.5), span.p1 - span.p0) > 0)) return 16;
    const Reach first(at_, whole.joint);
    const Place joint{whole.joint, endAlong(at_, first), {}};
    const Reach second(joint, span.p1);
    const dvec3 jump = glm::cross(joint.along, second.inward()) - glm::cross(at_.along, first.inward());
    const double length = std::sqrt(first.chord2) + std::sqrt(second.chord2);
    double error = std::sqrt(dot(jump, jump)) * length * length / 48;
    for (const double t : {0.25, 0.5, 0.75}) {
      const dvec3 point = span.at(t);
      const bool beyond = dot(point - joint.at, joint.along) > 0;
      error = std::max(error, beyond ? offCircle(joint, second, point) : offCircle(at_, first, point));
    }
    int pieces = 1;
    for (double allowed = tolerance; pieces < 16 && !(error <= allowed); allowed *= 8) pieces *= 2;
    return pieces;
  }

  // Adds the arc to a point; cut in halves until each turns by at most 60 degrees, which three cuts of a
  // whole turn do. Null, or what is wrong.
  const char* addArc(const dvec3& to, int cuts = 3) {
    const Reach arc(at_, to);
    if (!(arc.chord2 > 0) || !std::isfinite(arc.chord2)) return kFolding;
    const double chord = std::sqrt(arc.chord2), side = std::sqrt(arc.side2), per_chord = 1 / chord;
    // Of half the angle, which is between the direction here and the chord.
    const double sine = side * per_chord, cosine = arc.ahead * per_chord, tan4 = sine / (1 + cosine);
    const bool straight = sine <= 1e-12;
    if (straight && cosine <= 0) return kFolding;
    const dvec3 out = straight ? at_.x : (1 / side) * arc.side, along = per_chord * arc.chord;
    // Where it is farthest from its chord: there it is parallel to the chord.
    // Of a nearly straight arc it is the rest of a difference: made perpendicular once more.
    const dvec3 turned = straight ? out : cosine * out - sine * at_.along;
    const dvec3 rest = turned - dot(turned, along) * along;
    const dvec3 inward = (1 / std::sqrt(dot(rest, rest))) * rest;
    const dvec3 middle = at_.at + 0.5 * arc.chord - (straight ? 0.0 : 0.5 * chord * tan4) * inward;
    if (!straight && !(cosine > 0 && sine <= 0.5 * (1 + 1e-9))) {
      if (cuts == 0) return kFolding;
      if (const char* wrong = addArc(middle, cuts - 1)) return wrong;
      return addArc(to, cuts - 1);
    }
    if (chain_.count == kMaxArcs) return kTooMany;

    double c = dot(out, at_.x), s = dot(out, glm::cross(at_.x, at_.along));
    const double norm = 1 / std::sqrt(c * c + s * s);
    c = std::abs(c) < 1e-9 ? 0 : c * norm;
    s = std::abs(s) < 1e-9 ? 0 : s * norm;
    const double curvature = straight ? 0 : 2 * sine * per_chord;
    if (!(curvature * (std::abs(c) * half_x_ + std::abs(s) * half_z_) <= kMostCurved)) return kFolding;
    const double length = straight ? chord : chord * std::asin(sine) / sine;

    const int i = chain_.count++;
    lengths_[i] = length;
    length_ += length;
    Arc& made = chain_.arcs[i];
    made.middle = glm::vec3(middle);
    made.along = glm::vec3(along);
    made.inward = glm::vec3(inward);
    made.bend = glm::vec2(c, s);
    made.curvature = static_cast<float>(curvature);
    made.half_length = static_cast<float>(0.5 * length);
    // The slice is within the hull of its two sections and of the one where its ends' tangents meet.
    const double wider = 1 / cosine, apex = 0.5 * chord * tan4 * wider;
    const double to_place = 0.5 * chord * std::sqrt(1 + tan4 * tan4);
    const double to_end = std::sqrt(to_place * to_place + corner_ * corner_ + 2 * to_place * tan4 * corner_);
    made.radius = static_cast<float>(std::max(to_end, apex + wider * corner_) * (1 + 1e-6) + 1e-3);
    if (!straight) {
      const dvec3 across = glm::cross(inward, along);
      addSection(middle - apex * inward, half_x_ * (c * wider * inward - s * across),
                 half_z_ * (s * wider * inward + c * across));
    }
    // By two reflections, which turn the section as the arc does.
    at_.x -= 2 * dot(along, at_.x) * along;
    at_.along = 2 * cosine * along - at_.along;
    at_.at = to;
    addSection(at_.at, half_x_ * at_.x, half_z_ * glm::cross(at_.x, at_.along));
    addJoint();
    return nullptr;
  }

  void addSection(const dvec3& at, const dvec3& x, const dvec3& z) {
    const dvec3 reach = glm::abs(x) + glm::abs(z);
    low_ = glm::min(low_, at - reach);
    high_ = glm::max(high_, at + reach);
  }
  void addJoint() {
    chain_.joints[chain_.count].plane = glm::vec4(glm::vec3(at_.along), -dot(at_.along, at_.at));
  }

  // The joints' curvature for normals, the height of the last, and the bounds.
  void finish(double y) {
    const int last = chain_.count;
    for (int i = 0; i <= last; ++i) {
      const Arc &a = chain_.arcs[std::max(i - 1, 0)], &b = chain_.arcs[std::min(i, last - 1)];
      chain_.joints[i].curvature = 0.5f * (a.curvature * a.bend + b.curvature * b.bend);
      chain_.joints[i].rise = 0.5f * (a.rise + b.rise);
    }
    chain_.joints[last].y = static_cast<float>(y);
    const dvec3 slack = 1e-6 * glm::max(glm::abs(low_), glm::abs(high_)) + 1e-3;
    chain_.bounds.min = glm::vec3(low_ - slack);
    chain_.bounds.max = glm::vec3(high_ + slack);
  }

  const double half_x_, half_z_, corner_;  // of the section
  const glm::ivec3 size_;
  ArcChain& chain_;
  Place at_{};
  dvec3 low_{0}, high_{0};
  double length_ = 0;  // of the span
  double lengths_[kMaxArcs];
};

// The place on an arc, from its middle: sine and cosine of the angle, and the lengths along and inward.
struct OnArc {
  double sine, cosine, along, inward;
  OnArc(const Arc& arc, double y) {
    const double k = arc.curvature, a = (y - double{arc.y}) / double{arc.rise}, angle = k * a;
    sine = std::sin(angle);
    cosine = std::cos(angle);
    const double x = angle * angle;
    along = x < 1e-8 ? a * (1 - x / 6) : sine / k;
    inward = x < 1e-8 ? 0.5 * angle * a : (1 - cosine) / k;
  }
};

const Arc& arcAt(const ArcChain& chain, float y) {
  int i = 0;
  while (i + 1 < chain.count && y > chain.joints[i + 1].y) ++i;
  return chain.arcs[i];
}

}  // namespace

Result<void> makeArcs(std::span<const Knot> knots, const glm::ivec3& size, float roll, float tolerance,
                      ArcChain& chain) {
  if (const Result<void> placed = checkPlaces(knots); !placed) return placed;
  if (!std::isfinite(roll) || !(tolerance > 0))
    return Error{ErrorCode::kMisuse, "a part's roll or the tolerance of its arcs is not a number"};
  for (std::size_t i = 0; i < knots.size(); ++i) {
    // At 32,768 voxels the squares of these are far from the largest float.
    const glm::vec3 most = glm::max(glm::abs(knots[i].position), glm::abs(knots[i].tangent));
    if (!(std::max({most.x, most.y, most.z}) < 1e9f))
      return Error{ErrorCode::kMisuse, "a knot is too far away for 32-bit floats", i, Error::Unit::kKnot};
    if (i > 0 && knots[i].position == knots[i - 1].position)
      return Error{ErrorCode::kMisuse, "this knot and the next are on one point", i - 1, Error::Unit::kKnot};
  }
  for (std::size_t i = 0; i < knots.size(); ++i) {
    if (knots[i].tangent == glm::vec3(0))
      return Error{ErrorCode::kMisuse, "the tangent of a knot is zero", i, Error::Unit::kKnot};
  }
  return ChainMaker(size, chain).make(knots, roll, tolerance);
}

Result<void> checkSweep(std::span<const Knot> knots, const glm::ivec3& size, float roll) {
  ArcChain chain;
  return makeArcs(knots, size, roll, kArcTolerance, chain);
}

Result<void> checkRig(Bend bend, std::span<const Knot> knots, const glm::ivec3& size, float roll) {
  return bend == Bend::kSweep ? checkSweep(knots, size, roll) : checkKnots(knots);
}

glm::mat4x3 sectionAt(const ArcChain& chain, float y) {
  const Arc& arc = arcAt(chain, y);
  const OnArc on(arc, y);
  const dvec3 t(arc.along), n(arc.inward), b = glm::cross(n, t);
  const dvec3 along = on.cosine * t + on.sine * n, inward = on.cosine * n - on.sine * t;
  const double c = arc.bend.x, s = arc.bend.y;
  return {glm::vec3(c * inward - s * b), glm::vec3(along), glm::vec3(s * inward + c * b),
          glm::vec3(dvec3(arc.middle) + on.along * t + on.inward * n)};
}

glm::vec3 sweepPoint(const ArcChain& chain, const glm::ivec3& size, const glm::vec3& rest) {
  const glm::mat4x3 section = sectionAt(chain, rest.y);
  return section[3] + (rest.x - 0.5f * static_cast<float>(size.x)) * section[0] +
         (rest.z - 0.5f * static_cast<float>(size.z)) * section[2];
}

std::optional<glm::vec3> unsweepPoint(const ArcChain& chain, const glm::ivec3& size, const glm::vec3& point) {
  std::optional<glm::vec3> rest;
  // Far from the origin, the planes are as coarse as floats there.
  const float rounding = 1e-3f + 1e-6f * glm::length(point);
  double nearest = INFINITY;
  for (int i = 0; i < chain.count; ++i) {
    const auto beyond = [&](int joint) {
      const glm::vec4& plane = chain.joints[joint].plane;
      return dot(glm::vec3(plane), point) + plane.w;
    };
    if (!(beyond(i) >= -rounding && beyond(i + 1) <= rounding)) continue;
    const Arc& arc = chain.arcs[i];
    const dvec3 e = dvec3(point) - dvec3(arc.middle), n(arc.inward), t(arc.along);
    const double p = dot(e, n), l = dot(e, t), v = dot(e, glm::cross(n, t)), k = arc.curvature;
    const double g = std::hypot(1 - k * p, k * l), u = (2 * p - k * (p * p + l * l)) / (1 + g);
    if (!(1 - k * p > 0) || !(u * u + v * v < nearest)) continue;
    nearest = u * u + v * v;
    const double tangent = l / (1 - k * p), x = k * tangent;
    const double length = std::abs(x) < 1e-6 ? tangent : std::atan(x) / k;
    const double c = arc.bend.x, s = arc.bend.y;
    rest = glm::vec3(0.5 * size.x + c * u - s * v,
                     std::clamp(double{arc.y} + length * double{arc.rise}, double{chain.joints[i].y},
                                double{chain.joints[i + 1].y}),
                     0.5 * size.z + s * u + c * v);
  }
  return rest;
}

}  // namespace kelp
