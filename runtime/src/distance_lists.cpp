// SPDX-License-Identifier: MIT
// The queries of kelp/runtime/distance.h: what they refuse, and which instances of a list they ask.
#include <algorithm>
#include <cmath>

#include "posed_solid.h"

namespace kelp::runtime {
namespace {

double toBox(const Box& box, const glm::vec3& p) {
  if (box.empty()) return INFINITY;
  return glm::length(glm::dvec3(p) - glm::clamp(glm::dvec3(p), glm::dvec3(box.min), glm::dvec3(box.max)));
}
bool meet(const Box& a, const Box& b) {
  return glm::all(glm::lessThanEqual(a.min, b.max)) && glm::all(glm::lessThanEqual(b.min, a.max));
}
Box grown(Box box, float by) {
  // And by more than rounding takes away.
  const glm::vec3 more = glm::vec3(by) + 1e-6f * (glm::abs(box.min) + glm::abs(box.max) + by);
  return {box.min - more, box.max + more};
}
Box boxOf(const Sphere& s) { return grown({s.center, s.center}, s.radius); }
Box boxOf(const Capsule& s) { return grown({glm::min(s.a, s.b), glm::max(s.a, s.b)}, s.radius); }
Box boxOf(const OrientedBox& s) {
  // In double: the square of a tiny length may be no float.
  const glm::mat3 axes(glm::mat3_cast(glm::normalize(glm::dquat(s.rotation))));
  const glm::vec3 half = glm::abs(axes[0]) * s.half_size.x + glm::abs(axes[1]) * s.half_size.y +
                         glm::abs(axes[2]) * s.half_size.z;
  return grown({s.center - half, s.center + half}, 0);
}

bool isRadius(float radius) { return std::isfinite(radius) && radius >= 0; }
// Lengths whose squares are finite, and not 0.
bool isWay(const glm::vec3& a, const glm::vec3& b) {
  const float length2 = glm::dot(b - a, b - a);
  return allFinite(a) && allFinite(b) && std::isfinite(length2) && length2 > 0;
}
const char* faultOf(const Sphere& s) {
  return allFinite(s.center) && isRadius(s.radius) ? nullptr : "a sphere that is not finite or negative";
}
const char* faultOf(const Capsule& s) {
  return isWay(s.a, s.b) && isRadius(s.radius) ? nullptr : "a capsule that is not finite or has no length";
}
const char* faultOf(const OrientedBox& s) {
  const double turn2 = glm::dot(glm::dquat(s.rotation), glm::dquat(s.rotation));
  const bool fine = allFinite(s.center) && allFinite(s.half_size) && std::isfinite(turn2) && turn2 > 0 &&
                    s.half_size.x > 0 && s.half_size.y > 0 && s.half_size.z > 0;
  return fine ? nullptr : "a box that is not finite or has no size";
}

Error misuse(const char* detail) { return {ErrorCode::kMisuse, detail}; }

// Calls use(i) for the instances of a list that are drawn and whose box passes test(box), until it returns
// false.
template <class Test, class Use>
Result<void> eachInstance(Instances instances, std::span<const Box> boxes, const Test& test, const Use& use) {
  if (!boxes.empty() && boxes.size() != instances.size()) return misuse("not as many boxes as instances");
  for (std::size_t i = 0; i < instances.size(); ++i) {
    if (!boxes.empty() && !test(boxes[i])) continue;
    const Result<bool> drawn = checkInstance(instances[i]);
    if (!drawn && instances.size() == 1) return drawn.error();
    if (!drawn) return Error{drawn.error().code, drawn.error().detail, i, Error::Unit::kInstance};
    // The box of one alone costs a third of a query, and spares nothing.
    const bool boxed = boxes.empty() && instances.size() > 1;
    if (!*drawn || (boxed && !test(bounds(instances[i])))) continue;
    if (!use(static_cast<int>(i))) return {};
  }
  return {};
}

template <class One>
Result<std::optional<int>> overlapsOne(Instances instances, const One& shape, std::span<const Box> boxes) {
  if (const char* fault = faultOf(shape)) return misuse(fault);
  const Box around = boxOf(shape);
  std::optional<int> found;
  const Result<void> done = eachInstance(
      instances, boxes, [&](const Box& box) { return meet(box, around); },
      [&](int i) {
        if (touches(instances[static_cast<std::size_t>(i)], shape)) found = i;
        return !found;
      });
  if (!done) return done.error();
  return found;
}

}  // namespace

Result<Distance> distance(Instances instances, const glm::vec3& point, std::span<const Box> boxes) {
  if (!allFinite(point)) return misuse("a point that is not finite");
  Distance nearest;
  const Result<void> done = eachInstance(
      instances, boxes,
      [&](const Box& box) { return toBox(box, point) <= std::max(double{nearest.bound}, 0.0); },
      [&](int i) {
        Distance found;
        findNearest(instances[static_cast<std::size_t>(i)], point, found);
        found.instance = i;
        if (found.part && (!nearest.part || found.bound < nearest.bound)) nearest = found;
        return true;
      });
  if (!done) return done.error();
  return nearest;
}

Result<ClosestPoint> closestPoint(Instances instances, const glm::vec3& point, float reach,
                                  std::span<const Box> boxes) {
  if (!allFinite(point) || !(reach > 0)) return misuse("a point or a reach that is not finite, or negative");
  ClosestPoint nearest;
  nearest.distance = reach;
  const Result<void> done = eachInstance(
      instances, boxes, [&](const Box& box) { return toBox(box, point) <= double{nearest.distance}; },
      [&](int i) {
        ClosestPoint found = nearest;
        found.part.reset();
        findClosest(instances[static_cast<std::size_t>(i)], glm::dvec3(point), found);
        found.instance = i;
        nearest.ran_out |= found.ran_out;
        if (found.part && (!nearest.part || found.distance < nearest.distance)) nearest = found;
        return nearest.distance > 0;
      });
  if (!done) return done.error();
  if (!nearest.part) nearest.distance = kFarAway;
  return nearest;
}

Result<std::optional<int>> overlaps(Instances instances, const Shape& shape, std::span<const Box> boxes) {
  return std::visit([&](const auto& one) { return overlapsOne(instances, one, boxes); }, shape);
}

Result<SphereCast> sphereCast(Instances instances, const glm::vec3& from, const glm::vec3& to, float radius,
                              std::span<const Box> boxes) {
  if (!isWay(from, to) || !isRadius(radius)) return misuse("a way that is not finite or has no length");
  const Box around = boxOf(Capsule{from, to, radius});
  SphereCast nearest;
  const glm::dvec3 way = glm::dvec3(to) - glm::dvec3(from);
  const Result<void> done = eachInstance(
      instances, boxes, [&](const Box& box) { return meet(box, around); },
      [&](int i) {
        SphereCast found = nearest;
        found.part.reset();
        cast(instances[static_cast<std::size_t>(i)], glm::dvec3(from), way, double{radius}, found);
        found.instance = i;
        if (found.part) nearest = found;
        return nearest.t > 0;
      });
  if (!done) return done.error();
  nearest.center = glm::vec3(glm::dvec3(from) + double{nearest.t} * way);
  if (nearest.part) {
    Distance at;
    findNearest(instances[static_cast<std::size_t>(nearest.instance)], nearest.center, at);
    nearest.away = at.away;
  }
  return nearest;
}

}  // namespace kelp::runtime
