// SPDX-License-Identifier: MIT
#include "kelp/runtime/instance.h"

#include <cmath>

#include <glm/glm.hpp>

#include "kelp/simd/bound_knots.h"
#include "posed_part.h"

namespace kelp::runtime {
namespace {

// The motion of a part about its pivot, object -> object.
glm::mat4 motionMatrix(const Part& part, const Motion& motion) {
  const glm::mat4 pivot = affine(part.pivot);
  glm::mat4 trs = glm::mat4_cast(motion.rotation);
  for (int i = 0; i < 3; ++i) trs[i] *= motion.scale[i];
  trs[3] = glm::vec4(motion.translation, 1.0f);
  return pivot * trs * glm::inverse(pivot);
}

// Segment and parameter at a height in rest space, where y = size.y (Sy(t) - Sy(0)) / (Sy(1) - Sy(0)).
struct SplinePoint {
  Segment segment;
  float t = 0;
};

SplinePoint splineAtHeight(std::span<const Knot> knots, float height, float y) {
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    if (y <= height * knots[i + 1].position.y || i + 2 == knots.size()) {
      const Segment segment = makeSegment(knots[i], knots[i + 1], height);
      const float t = trace::kelpSplineParameter(asTrace(segment), y - segment.p0.y, segment.p1.y - y);
      return {segment, t};
    }
  }
  return {};
}

bool isPart(const Instance& instance, int part) {
  return instance.asset && part >= 0 &&
         static_cast<std::size_t>(part) < instance.asset->pack().parts().size();
}

// Whether the part exists, and the pose has knots for it.
bool isPosed(const Instance& instance, int part) {
  return isPart(instance, part) && knotsOf(instance, part).size() >= 2;
}

float heightOf(const Instance& instance, int part) {
  return static_cast<float>(instance.asset->pack().parts()[static_cast<std::size_t>(part)].size.y);
}

// Object space at rest -> part space at rest.
glm::vec3 toVoxels(const Instance& instance, int part, const glm::vec3& rest) {
  const Part& of = instance.asset->pack().parts()[static_cast<std::size_t>(part)];
  return glm::vec3(glm::inverse(affine(of.to_object)) * glm::vec4(rest, 1.0f));
}

}  // namespace

std::span<const Knot> knotsOf(const Instance& instance, int part) {
  return instance.pose ? instance.pose->knots(part)
                       : instance.asset->pack().parts()[static_cast<std::size_t>(part)].knots;
}

glm::vec3 toObject(const Instance& instance, int part, const glm::vec3& voxels) {
  const Part& of = instance.asset->pack().parts()[static_cast<std::size_t>(part)];
  return of.to_object * glm::vec4(voxels, 1.0f);
}

glm::mat4 partToWorld(const Instance& instance, int part) {
  if (!isPart(instance, part)) return glm::mat4(1);
  const std::span<const Part> parts = instance.asset->pack().parts();
  glm::mat4 matrix = affine(parts[static_cast<std::size_t>(part)].to_object);
  for (int i = part; i >= 0; i = parts[static_cast<std::size_t>(i)].parent) {
    if (!instance.pose || i >= instance.pose->parts() || isRest(*instance.pose->motion(i))) continue;
    matrix = motionMatrix(parts[static_cast<std::size_t>(i)], *instance.pose->motion(i)) * matrix;
  }
  return instance.to_world * matrix;
}

Box bounds(const Instance& instance) {
  Box all;
  if (!instance.asset) return all;
  const std::span<const Part> parts = instance.asset->pack().parts();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::span<const Knot> knots = knotsOf(instance, static_cast<int>(i));
    if (knots.size() < 2) continue;
    const Box box =
        transformed(partToWorld(instance, static_cast<int>(i)), simd::boundKnots(knots, parts[i].size));
    all.add(box.min);
    all.add(box.max);
  }
  return all;
}

glm::vec3 bend(const Instance& instance, int part, const glm::vec3& rest) {
  const std::span<const Knot> knots = knotsOf(instance, part);
  const float height = heightOf(instance, part);
  const float low = height * knots.front().position.y;
  const float y = low + rest.y * (knots.back().position.y - knots.front().position.y);
  const SplinePoint at = splineAtHeight(knots, height, y);
  const glm::vec3 s = evaluate(at.segment, at.t);
  return {rest.x + s.x, y, rest.z + s.z};
}

glm::vec3 toWorld(const Instance& instance, int part, const glm::vec3& rest) {
  if (!isPosed(instance, part)) return glm::vec3(0);
  const glm::vec3 bent = bend(instance, part, toVoxels(instance, part, rest));
  return glm::vec3(partToWorld(instance, part) * glm::vec4(bent, 1.0f));
}

std::optional<glm::vec3> toRest(const Instance& instance, int part, const glm::vec3& world) {
  if (!isPosed(instance, part)) return std::nullopt;
  const std::span<const Knot> knots = knotsOf(instance, part);
  if (!checkKnots(knots)) return std::nullopt;
  const glm::vec3 p = glm::vec3(glm::inverse(partToWorld(instance, part)) * glm::vec4(world, 1.0f));
  const float height = heightOf(instance, part);
  const float low = height * knots.front().position.y;
  const float high = height * knots.back().position.y;
  if (!(p.y >= low && p.y <= high)) return std::nullopt;
  const SplinePoint at = splineAtHeight(knots, height, p.y);
  const glm::vec3 s = evaluate(at.segment, at.t);
  return toObject(instance, part, {p.x - s.x, (p.y - low) / (high - low) * height, p.z - s.z});
}

glm::mat4 frameAt(const Instance& instance, int part, const glm::vec3& rest) {
  if (!isPosed(instance, part)) return glm::mat4(1);
  const std::span<const Knot> knots = knotsOf(instance, part);
  const float height = heightOf(instance, part);
  const float low = knots.front().position.y;
  const float y = height * low + toVoxels(instance, part, rest).y * (knots.back().position.y - low);
  const SplinePoint at = splineAtHeight(knots, height, y);
  glm::vec3 along = derivative(at.segment, glm::clamp(at.t, 1e-4f, 1.0f - 1e-4f));
  if (!(glm::dot(along, along) > 0)) along = glm::vec3(0, 1, 0);
  const glm::mat4 to_world = partToWorld(instance, part);
  const glm::mat3 turn(to_world);
  const glm::vec3 up = glm::normalize(turn * along);
  glm::vec3 x = turn[0] - glm::dot(turn[0], up) * up;
  // The spline runs along x here.
  if (!(glm::dot(x, x) > 1e-12f * glm::dot(turn[0], turn[0]))) x = turn[2] - glm::dot(turn[2], up) * up;
  x = glm::normalize(x);
  return glm::mat4(glm::vec4(x, 0), glm::vec4(up, 0), glm::vec4(glm::cross(x, up), 0),
                   glm::vec4(toWorld(instance, part, rest), 1.0f));
}

}  // namespace kelp::runtime
