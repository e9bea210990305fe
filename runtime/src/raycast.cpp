// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include <glm/glm.hpp>

#include "asset_impl.h"
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

// The bricks of a level as trace.glsl asks for them.
struct LevelBricks {
  const PageReader* reader = nullptr;
  const LevelState* level = nullptr;

  const std::uint32_t* find(std::uint32_t cell) const {
    const std::uint32_t* page = reader->words(*level, cellPage(cell));
    return page ? page + kBrickWords * cellBrick(cell) : nullptr;
  }
  // The attribute of a surface voxel.
  std::optional<std::uint32_t> attributeAt(const glm::ivec3& voxel) const {
    const glm::ivec3 brick = voxel >> 3;
    const glm::ivec3& grid = level->data.grid;
    const std::uint32_t cell = level->data.cells[static_cast<std::size_t>(brick.x) + static_cast<std::size_t>(grid.x) * (static_cast<std::size_t>(brick.y) + static_cast<std::size_t>(grid.y) * static_cast<std::size_t>(brick.z))];
    const std::uint32_t* words = cell & kCellSolid ? find(cell) : nullptr;
    if (!words) return std::nullopt;
    const std::uint8_t code = codeOf(words, voxel);
    if (!isSurfaceCode(code)) return std::nullopt;
    return attributeOf(words, voxel, code);
  }
};

const std::uint8_t* traceBrick(const void* user, std::uint32_t cell) {
  const std::uint32_t* words = static_cast<const LevelBricks*>(user)->find(cell);
  return words ? reinterpret_cast<const std::uint8_t*>(words + kSliceWords) : nullptr;
}

// An inner voxel, met only by rays that start inside a solid, has no attribute: the material of the nearest surface voxel among its 26
// neighbours, or the palette's first, as shaders/shading.glsl has it.
std::uint8_t innerMaterial(const LevelBricks& bricks, const glm::ivec3& voxel) {
  std::uint8_t material = 0;
  int nearest = 4;
  for (int i = 0; i < 27; ++i) {
    const glm::ivec3 offset = glm::ivec3(i % 3, i / 3 % 3, i / 9) - 1;
    const int distance = offset.x * offset.x + offset.y * offset.y + offset.z * offset.z;
    const glm::ivec3 v = voxel + offset;
    if (distance >= nearest || glm::any(glm::lessThan(v, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(v, bricks.level->data.size))) continue;
    if (const auto beside = bricks.attributeAt(v)) {
      nearest = distance;
      material = attributePalette(*beside);
    }
  }
  return material;
}

// The levels that a trace may look at: the finest one not finer than `wanted` whose grid is there, and those above. Answers how many; 0: the
// coarsest is not whole yet, so there would be holes.
int listLevels(const Asset& asset, const PageReader& reader, int part, int wanted, LevelBricks (&bricks)[kMaxLevels], trace::Level (&levels)[kMaxLevels]) {
  const int last = asset.pack().parts()[static_cast<std::size_t>(part)].levels - 1;
  const LevelState* coarsest = reader.level(part, last);
  if (!coarsest || coarsest->resident.load(std::memory_order_acquire) != coarsest->data.pages.size()) return 0;
  int count = 0;
  for (int level = std::clamp(wanted, 0, last); level <= last; ++level) {
    const LevelState* state = reader.level(part, level);
    if (!state) continue;
    bricks[count] = {&reader, state};
    levels[count] = {state->data.cells.data(), state->data.grid, &traceBrick, &bricks[count]};
    ++count;
  }
  return count;
}

}  // namespace

std::optional<Hit> raycast(const Instance& instance, const Ray& ray, int wanted_level) {
  if (!instance.asset || (instance.pose && instance.pose->parts() != static_cast<int>(instance.asset->pack().parts().size()))) return std::nullopt;
  if (!finite(ray.origin) || !finite(ray.direction) || ray.direction == glm::vec3(0) || !(ray.t_max >= 0)) return std::nullopt;
  const std::span<const Part> parts = instance.asset->pack().parts();
  const PageReader reader(*instance.asset);
  std::optional<Hit> nearest;
  float t_max = ray.t_max;
  for (int i = 0; i < static_cast<int>(parts.size()); ++i) {
    const Part& part = parts[static_cast<std::size_t>(i)];
    if (part.kind != PartKind::kSolid) continue;
    const std::span<const Knot> knots = knotsOf(instance, i);
    LevelBricks bricks[kMaxLevels];
    trace::Level levels[kMaxLevels];
    const int level_count = listLevels(*instance.asset, reader, i, wanted_level, bricks, levels);
    if (level_count == 0 || !checkKnots(knots)) continue;
    const LevelState& level = *bricks[0].level;

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
    context.level_size = level.data.size;
    context.level_scale = std::ldexp(1.0f, -level.level);
    context.levels = levels;
    context.coarser = level_count - 1;
    context.complete = level.resident.load(std::memory_order_acquire) == level.data.pages.size();
    const trace::KelpHit found = trace::kelpTrace(context, glm::vec3(o + s0 * r), glm::vec3(r), 0.0f, static_cast<float>(s1 - s0));
    if (!found.found || !std::isfinite(found.s) || !finite(glm::dvec3(found.rest))) continue;  // a pack's numbers may be beyond what floats can follow

    Hit hit;
    hit.t = static_cast<float>((s0 + double{found.s}) / length);
    if (hit.t > t_max) continue;
    hit.position = ray.origin + hit.t * ray.direction;
    hit.part = i;
    hit.level = level.level + found.coarser;
    hit.voxel = found.voxel;
    hit.rest = found.rest;
    glm::dvec3 normal = -glm::normalize(glm::dvec3(ray.direction));
    if (const auto attribute = bricks[found.coarser].attributeAt(found.voxel)) {
      const float stretch = static_cast<float>(part.size.y) / (knots.back().position.y - knots.front().position.y);
      const glm::vec3 bent = trace::kelpDeformNormal(segments[found.segment], found.t, stretch, decodeNormal(attributeNormal(*attribute)));
      if (glm::dot(bent, bent) > 0) normal = glm::normalize(glm::transpose(glm::dmat3(to_part)) * glm::dvec3(bent));
      hit.material = attributePalette(*attribute);
    } else {
      hit.material = innerMaterial(bricks[found.coarser], found.voxel);
    }
    hit.normal = glm::vec3(normal);
    t_max = hit.t;
    nearest = hit;
  }
  return nearest;
}

}  // namespace kelp::runtime
