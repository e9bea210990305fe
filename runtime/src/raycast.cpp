// SPDX-License-Identifier: MIT
#include <cmath>

#include <glm/glm.hpp>

#include "kelp/runtime/instance.h"
#include "posed_part.h"

namespace kelp::runtime {
namespace {

bool finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

// Clips the line o + s r to the box; false if it misses.
bool clip(const glm::dvec3& o, const glm::dvec3& r, const Box& box, double& s0, double& s1) {
  for (int i = 0; i < 3; ++i) {
    if (r[i] == 0.0) {
      if (o[i] < double{box.min[i]} || o[i] > double{box.max[i]}) return false;
      continue;
    }
    const double a = (double{box.min[i]} - o[i]) / r[i];
    const double b = (double{box.max[i]} - o[i]) / r[i];
    s0 = std::max(s0, std::min(a, b));
    s1 = std::min(s1, std::max(a, b));
  }
  return s0 <= s1;
}

// A surface voxel's attribute; an inner voxel, met only by rays that start inside a solid, borrows that of a neighbour.
std::optional<std::uint32_t> attributeAt(const LevelData& level, const glm::ivec3& voxel) {
  const glm::ivec3 brick = voxel >> 3;
  const auto cell = static_cast<std::size_t>(brick.x) + static_cast<std::size_t>(level.grid.x) * (static_cast<std::size_t>(brick.y) + static_cast<std::size_t>(level.grid.y) * static_cast<std::size_t>(brick.z));
  if (!(level.cells[cell] & kCellSolid)) return std::nullopt;
  const std::uint32_t slot = level.cells[cell] & kCellSlotMask;
  const std::uint8_t code = level.codes[std::size_t{slot} * kBrickVoxels + static_cast<std::size_t>(codeIndex(voxel))];
  if (!isSurfaceCode(code)) return std::nullopt;
  return level.attributes[level.slice_base[std::size_t{slot} * 8 + static_cast<std::size_t>(voxel.z & 7)] + code - kSurfaceCode];
}

std::optional<std::uint32_t> nearbyAttribute(const LevelData& level, const glm::ivec3& voxel) {
  if (const auto own = attributeAt(level, voxel)) return own;
  for (int i = 0; i < 27; ++i) {
    const glm::ivec3 v = voxel + glm::ivec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    if (glm::any(glm::lessThan(v, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(v, level.size))) continue;
    if (const auto beside = attributeAt(level, v)) return beside;
  }
  return std::nullopt;
}

}  // namespace

std::optional<Hit> raycast(const Instance& instance, const Ray& ray, int wanted_level) {
  if (!instance.asset || (instance.pose && instance.pose->parts() != static_cast<int>(instance.asset->pack().parts().size()))) return std::nullopt;
  if (!finite(ray.origin) || !finite(ray.direction) || ray.direction == glm::vec3(0) || !(ray.t_max >= 0)) return std::nullopt;
  const std::span<const Part> parts = instance.asset->pack().parts();
  std::optional<Hit> nearest;
  float t_max = ray.t_max;
  for (int i = 0; i < static_cast<int>(parts.size()); ++i) {
    const Part& part = parts[static_cast<std::size_t>(i)];
    const std::span<const Knot> knots = knotsOf(instance, i);
    const int level_index = instance.asset->residentLevel(i, wanted_level);
    if (level_index < 0 || !checkKnots(knots)) continue;
    const LevelData& level = *instance.asset->level(i, level_index);

    // The ray in part space, in double precision, and its origin moved to where it enters the bounds: float32 is exact near the volume.
    const glm::dmat4 to_world(partToWorld(instance, i));
    const glm::dmat4 to_part = glm::inverse(to_world);
    const glm::dvec3 o = glm::dvec3(to_part * glm::dvec4(ray.origin, 1.0));
    const glm::dvec3 d = glm::dvec3(to_part * glm::dvec4(ray.direction, 0.0));
    const double length = glm::length(d);
    if (!finite(o) || !std::isfinite(length) || length == 0.0) continue;
    const glm::dvec3 r = d / length;
    const Box box = deformedBounds(knots, part.size);
    double s0 = 0.0;
    double s1 = double{t_max} * length;
    if (!clip(o, r, box, s0, s1)) continue;

    trace::KelpSegment segments[kMaxKnots];
    for (std::size_t k = 0; k + 1 < knots.size(); ++k) segments[k] = asTrace(makeSegment(knots[k], knots[k + 1]));
    trace::Context context;
    context.segments = segments;
    context.segment_count = static_cast<int>(knots.size()) - 1;
    context.bounds_min = box.min;
    context.bounds_max = box.max;
    context.size = glm::vec3(part.size);
    context.level_size = level.size;
    context.level_scale = std::ldexp(1.0f, -level_index);
    context.cells = level.cells.data();
    context.grid = level.grid;
    context.codes = level.codes.data();
    const trace::KelpHit found = trace::kelpTrace(context, glm::vec3(o + s0 * r), glm::vec3(r), 0.0f, static_cast<float>(s1 - s0));
    if (!found.found) continue;

    Hit hit;
    hit.t = static_cast<float>((s0 + double{found.s}) / length);
    if (hit.t > t_max) continue;
    hit.position = ray.origin + hit.t * ray.direction;
    hit.part = i;
    hit.level = level_index;
    hit.voxel = found.voxel;
    hit.rest = found.rest;
    const glm::mat3 normal_to_world = glm::transpose(glm::mat3(to_part));
    glm::vec3 normal = -glm::vec3(ray.direction);
    if (const auto attribute = nearbyAttribute(level, found.voxel)) {
      const float stretch = static_cast<float>(part.size.y) / (knots.back().position.y - knots.front().position.y);
      normal = normal_to_world * trace::kelpDeformNormal(segments[found.segment], found.t, stretch, decodeNormal(attributeNormal(*attribute)));
      hit.material = attributePalette(*attribute);
    }
    hit.normal = glm::normalize(normal);
    t_max = hit.t;
    nearest = hit;
  }
  return nearest;
}

}  // namespace kelp::runtime
