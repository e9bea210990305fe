// SPDX-License-Identifier: MIT
#include "sweep_map.h"

#include <algorithm>
#include <cmath>

namespace kelp::runtime {
namespace {

using glm::dot;
using glm::dvec3;

// f / sin(f) of half the slice's angle.
double chordShare(const SweepSlice& slice) { return slice.half / slice.half_chord; }

// The section of a slice at a height at rest.
struct SliceSection {
  dvec3 at, x, z, along, inward;
  SliceSection(const SweepSlice& slice, double y) {
    const double k = slice.curvature, a = (y - slice.y) / slice.rise, angle = k * a, angle2 = angle * angle;
    const double sine = std::sin(angle), cosine = std::cos(angle);
    const double forward = angle2 < 1e-8 ? a * (1 - angle2 / 6) : sine / k;
    const double sideways = angle2 < 1e-8 ? 0.5 * angle * a : (1 - cosine) / k;
    along = cosine * slice.along + sine * slice.inward;
    inward = cosine * slice.inward - sine * slice.along;
    x = slice.c * inward - slice.s * slice.across;
    z = slice.s * inward + slice.c * slice.across;
    at = slice.middle + forward * slice.along + sideways * slice.inward;
  }
};

}  // namespace

double SweepSlice::stretch(double room_a, double room_b) const {
  return std::max(1.0, rise * chordShare(*this) / std::sqrt(room_a * room_b));
}

SweepMap::SweepMap(const ArcChain& chain, const glm::ivec3& size)
    : chain_(chain), middle_(0.5 * size.x, 0.5 * size.z) {
  const glm::vec3 far = glm::max(glm::abs(chain.bounds.min), glm::abs(chain.bounds.max));
  float least_rise = chain.arcs[0].rise;
  for (int i = 1; i < chain.count; ++i) least_rise = std::min(least_rise, chain.arcs[i].rise);
  slack_ = 1e-6 * double{std::max({far.x, far.y, far.z})} + 2e-7 * size.y / double{least_rise};
}

SweepSlice SweepMap::slice(int number) const {
  const Arc& arc = chain_.arcs[number];
  const ArcJoint &from = chain_.joints[number], &to = chain_.joints[number + 1];
  SweepSlice slice;
  slice.middle = dvec3(arc.middle);
  slice.along = dvec3(arc.along);
  slice.inward = dvec3(arc.inward);
  slice.across = glm::cross(slice.inward, slice.along);
  slice.curvature = arc.curvature;
  slice.c = arc.bend.x;
  slice.s = arc.bend.y;
  slice.y = arc.y;
  slice.rise = arc.rise;
  slice.low = from.y;
  slice.high = to.y;
  slice.half = 0.5 * (slice.high - slice.low) / slice.rise;
  const double f = slice.curvature * slice.half, f2 = f * f;  // at most 30 degrees
  slice.half_chord = slice.half * (1 - f2 / 6 * (1 - f2 / 20 * (1 - f2 / 42 * (1 - f2 / 72))));
  slice.sine = slice.curvature * slice.half_chord;
  slice.cosine = std::sqrt(1 - slice.sine * slice.sine);
  slice.most_u = std::abs(slice.c) * middle_.x + std::abs(slice.s) * middle_.y;
  return slice;
}

int SweepMap::nearestArc(const dvec3& point) const {
  int nearest = 0;
  double least = INFINITY;
  for (int i = 0; i < chain_.count; ++i) {
    const Arc& arc = chain_.arcs[i];
    const dvec3 e = point - dvec3(arc.middle);
    const double power = dot(e, e) - double{arc.radius} * double{arc.radius};
    if (power < least) least = power, nearest = i;
  }
  return nearest;
}

bool SweepMap::isBeyond(int number, const dvec3& point, double distance) const {
  const Arc& arc = chain_.arcs[number];
  const dvec3 e = point - dvec3(arc.middle);
  const double reach = double{arc.radius} + distance;
  return dot(e, e) >= reach * reach;
}

SweepPoint SweepMap::see(int number, const SweepSlice& slice, const dvec3& point) const {
  const dvec3 e = point - slice.middle;
  const double k = slice.curvature, side = dot(e, slice.along) < 0 ? -1 : 1;
  double p = dot(e, slice.inward), l = side * dot(e, slice.along);
  SweepPoint at;
  at.v = dot(e, slice.across);
  // How far it is beyond the plane on its side. Between joints must be no gap; at the ends of the part is
  // nothing to fall through to.
  const double beyond = l * slice.cosine - (1 - k * p) * slice.half_chord;
  const bool end = side < 0 ? number == 0 : number + 1 == chain_.count;
  at.nearly = beyond > 0 && !end && beyond <= slack_;
  if (beyond > 0 && !at.nearly) {
    double held_p = p - beyond * slice.sine, held_l = l - beyond * slice.cosine;
    if (!(1 - k * held_p > 0)) held_p = 1 / k, held_l = 0;  // the axis of curvature is nearer
    const double off_p = p - held_p, off_l = l - held_l;
    at.off = off_p * slice.inward + (side * off_l) * slice.along;
    at.off_length = std::sqrt(off_p * off_p + off_l * off_l);
    p = held_p;
    l = held_l;
  }
  const double to_axis = 1 - k * p, turned = k * l;
  at.room = std::sqrt(to_axis * to_axis + turned * turned);
  at.u = (2 * p - k * (p * p + l * l)) / (1 + at.room);
  if (at.room > 0) {
    at.cosine = to_axis / at.room;
    at.sine = side * turned / at.room;
    at.tangent = to_axis > 0 ? side * l / to_axis : 0;
  }
  return at;
}

dvec3 SweepMap::toRest(const SweepSlice& slice, const SweepPoint& at) const {
  const double x = slice.curvature * at.tangent, x2 = x * x;
  const double length = x2 < 1e-4 ? at.tangent * (1 - x2 / 3 + x2 * x2 / 5) : std::atan(x) / slice.curvature;
  return {middle_.x + slice.c * at.u - slice.s * at.v,
          std::clamp(slice.y + slice.rise * length, slice.low, slice.high),
          middle_.y + slice.s * at.u + slice.c * at.v};
}

double SweepMap::ballOf(int own, const dvec3& point, const dvec3& rest, double depth) const {
  const double x = rest.x - middle_.x, z = rest.z - middle_.y;
  const auto stretchIn = [&](int number) {
    const Arc& arc = chain_.arcs[number];
    const double c = arc.bend.x, s = arc.bend.y;
    const double u = std::min(c * x + s * z + depth, std::abs(c) * middle_.x + std::abs(s) * middle_.y);
    return double{arc.rise} / (1 - double{arc.curvature} * u);
  };
  double most = std::max(1.0, stretchIn(own));
  for (const int way : {1, -1}) {
    for (int i = own + way; i >= 0 && i < chain_.count; i += way) {
      const glm::vec4& joint = chain_.joints[way > 0 ? i : i + 1].plane;
      if (std::abs(dot(dvec3(joint), point) + double{joint.w}) > depth / most + slack_) break;
      most = std::max(most, stretchIn(i));
    }
  }
  return depth / most - 2 * slack_;
}

SweepMap::Cut SweepMap::cutOfRest(double y) const {
  int arc = 0;
  while (arc + 1 < chain_.count && y >= double{chain_.joints[arc + 1].y}) ++arc;
  return {arc, y};
}

// A cut at a joint names the arc above it. Where something ends there, that is one too many.
int SweepMap::lastArc(const Cut& from, const Cut& to) const {
  return to.arc > from.arc && to.y <= double{chain_.joints[to.arc].y} ? to.arc - 1 : to.arc;
}

bool SweepMap::between(const Cut& from, const Cut& to, Cut& middle) const {
  const int first = from.arc, last = lastArc(from, to);
  if (first < last) {
    const int joint = (first + last + 1) / 2;
    middle = {joint, chain_.joints[joint].y};
  } else {
    middle = {first, 0.5 * (from.y + to.y)};
  }
  return middle.y > from.y && middle.y < to.y;
}

SweepMap::Slab SweepMap::slab(int number, const Cut& from, const Cut& to, const dvec3& low,
                              const dvec3& high) const {
  const SweepSlice arc = slice(number);
  const double bottom = std::max(from.y, arc.low), top = std::min(to.y, arc.high);
  const SliceSection section(arc, 0.5 * (bottom + top));
  const double half_x = 0.5 * (high.x - low.x), half_z = 0.5 * (high.z - low.z);
  const double x = 0.5 * (low.x + high.x) - middle_.x, z = 0.5 * (low.z + high.z) - middle_.y;
  const double least_u = arc.c * x + arc.s * z - std::abs(arc.c) * half_x - std::abs(arc.s) * half_z;
  // Where it is farthest from the axis of curvature, the box is longest and bulges most.
  const double half = std::max(0.5 * (top - bottom), 0.0) / arc.rise;
  Slab slab;
  slab.along = (1 - arc.curvature * least_u) * half;
  slab.bulge = 0.5 * slab.along * arc.curvature * half;
  slab.half[0] = half_x * section.x;
  slab.half[1] = half_z * section.z;
  slab.half[2] = slab.along * section.along;
  slab.half[3] = 0.5 * slab.bulge * section.inward;
  slab.center = section.at + x * section.x + z * section.z + slab.half[3];
  return slab;
}

bool SweepMap::isFine(const Cut& from, const Cut& to, const dvec3& low, const dvec3& high,
                      double side) const {
  constexpr double kFineBulge = 0.25, kFineLength = 1.25;
  if (from.arc != lastArc(from, to)) return false;
  const Slab box = slab(from.arc, from, to, low, high);
  return box.bulge <= kFineBulge * side && 2 * box.along <= kFineLength * side;
}

dvec3 SweepMap::nearest(const Cut& from, const Cut& to, const dvec3& low, const dvec3& high,
                        const dvec3& point) const {
  const SweepSlice arc = slice(from.arc);
  const dvec3 e = point - arc.middle;
  const double l = dot(e, arc.along), to_axis = 1 - arc.curvature * dot(e, arc.inward);
  // Of its sections, that is the nearest which is turned least from the point, also beyond the axis.
  const double turned = arc.curvature * l;
  const bool nearly_straight = to_axis > 0 && turned * turned < 1e-8 * to_axis * to_axis;
  const double length = nearly_straight ? l / to_axis : std::atan2(turned, to_axis) / arc.curvature;
  const SliceSection section(arc, std::clamp(arc.y + arc.rise * length, from.y, to.y));
  const dvec3 off = point - section.at;
  const double x = std::clamp(middle_.x + dot(off, section.x), low.x, high.x) - middle_.x;
  const double z = std::clamp(middle_.y + dot(off, section.z), low.z, high.z) - middle_.y;
  return section.at + x * section.x + z * section.z;
}

}  // namespace kelp::runtime
