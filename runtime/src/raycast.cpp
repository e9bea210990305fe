// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include <glm/glm.hpp>

#include "asset_impl.h"
#include "kelp/cages/posed_cage.h"
#include "kelp/formats/page.h"
#include "kelp/runtime/instance.h"
#include "kelp/runtime/level.h"
#include "kelp/simd/bound_knots.h"
#include "posed_part.h"

namespace kelp::runtime {
namespace {

bool finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

// Clips the line o + s r to the box. False if the line misses it.
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

// The bricks of a level, for trace.glsl.
struct LevelBricks {
  const PageReader* reader = nullptr;
  const LevelState* level = nullptr;

  const std::uint32_t* find(std::uint32_t cell) const {
    const std::uint32_t* page = reader->words(*level, cellPage(cell));
    return page ? page + kBrickWords * cellBrick(cell) : nullptr;
  }
  // The attribute of a voxel; nullopt if it is not a surface voxel in memory.
  std::optional<std::uint32_t> attributeAt(const glm::ivec3& voxel) const {
    const glm::ivec3 brick = voxel >> 3;
    const glm::ivec3& grid = level->data.grid;
    const std::uint32_t cell =
        level->data.cells[static_cast<std::size_t>(brick.x) +
                          static_cast<std::size_t>(grid.x) *
                              (static_cast<std::size_t>(brick.y) +
                               static_cast<std::size_t>(grid.y) * static_cast<std::size_t>(brick.z))];
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

// An inner voxel has no attribute; rays hit one that start inside a solid, or where pieces of a cage part.
// Its material is found as in shaders/shading.glsl.
std::uint8_t innerMaterial(const LevelBricks& bricks, const glm::ivec3& voxel) {
  std::uint8_t material = 0;
  int nearest = 4;
  for (int away = 1; away <= 8 && nearest == 4; ++away)
    for (int i = 0; i < 27; ++i) {
      const glm::ivec3 towards = glm::ivec3(i % 3, i / 3 % 3, i / 9) - 1;
      const int distance = towards.x * towards.x + towards.y * towards.y + towards.z * towards.z;
      const glm::ivec3 v = voxel + away * towards;
      if (distance >= nearest || glm::any(glm::lessThan(v, glm::ivec3(0))) ||
          glm::any(glm::greaterThanEqual(v, bricks.level->data.size)))
        continue;
      if (const auto beside = bricks.attributeAt(v)) {
        nearest = distance;
        material = attributePalette(*beside);
      }
    }
  return material;
}

bool isComplete(const LevelState* level) {
  return level && level->resident.load(std::memory_order_acquire) == level->data.pages.size();
}

// The cage for a trace at level `wanted`: its own, or the first coarser one of which all of the coarsest
// level that is seen through it is in memory, where it is kept. What the next finer cage needs is requested.
// All of the part's coarsest level is in memory.
const Cage& chooseCage(const PageReader& reader, int part, std::span<const Cage> cages, int wanted) {
  const Cage* cage = &cages[static_cast<std::size_t>(wanted)];
  const LevelState *level = reader.level(part, cage->last_level), *finer = nullptr;
  while (!isComplete(level)) {
    finer = level;
    level = reader.level(part, (++cage)->last_level);
  }
  reader.keep(*level);
  if (finer) reader.askAhead(*finer, *level);
  return *cage;
}

// Lists the levels for a trace, of which the coarsest is complete: the finest one not finer than `wanted`
// whose grid is in memory, and all coarser ones up to `last`. Returns their number.
int listLevels(const PageReader& reader, int part, int wanted, int last, LevelBricks (&bricks)[kMaxLevels],
               trace::Level (&levels)[kMaxLevels]) {
  int count = 0;
  for (int level = wanted; level <= last; ++level) {
    const LevelState* state = reader.level(part, level);
    if (!state) continue;
    bricks[count] = {&reader, state};
    levels[count] = {state->data.cells.data(), state->data.grid, &traceBrick, &bricks[count]};
    ++count;
  }
  return count;
}

// A ray in part space, in double precision, from s0 to s1 within the bounds of a part.
struct PartRay {
  glm::dmat4 to_part;
  glm::dvec3 origin, direction;  // direction has length 1
  double length = 0;             // of the world's direction vector
  double s0 = 0, s1 = 0;
  Box bounds;
};

std::optional<PartRay> rayInPart(const Instance& instance, int part, const Box& bounds, const Ray& ray,
                                 float t_max) {
  PartRay in;
  in.to_part = glm::inverse(glm::dmat4(matrixOf(instance, part)));
  in.bounds = bounds;
  in.origin = glm::dvec3(in.to_part * glm::dvec4(ray.origin, 1.0));
  const glm::dvec3 d = glm::dvec3(in.to_part * glm::dvec4(ray.direction, 0.0));
  in.length = glm::length(d);
  if (!finite(in.origin) || !std::isfinite(in.length) || in.length == 0.0) return std::nullopt;
  in.direction = d / in.length;
  in.s1 = double{t_max} * in.length;
  if (!clip(in.origin, in.direction, bounds, in.s0, in.s1)) return std::nullopt;
  return in;
}

// How a part bends, as trace.glsl reads it. Without initial values: it is large, and on the stack.
struct BentPart {
  const Part* part;
  Box bounds;
  int segment_count, arc_count;  // one of them is not 0, or `cage` is set
  float stretch;                 // of a sheared part
  trace::KelpSegment segments[kMaxKnots];
  trace::KelpArc arcs[kMaxArcs];
  trace::KelpJoint joints[kMaxArcs + 1];
  PosedCage cage;

  // False: the part is not drawn. through: the cage of the part's in which it is traced; null: none.
  bool make(const Instance& instance, int index, const Cage* through) {
    const PosedPart posed = posedPart(instance, index);
    part = posed.part;
    segment_count = arc_count = 0;
    cage.cage = nullptr;
    if (!through) return posed.isSwept() ? sweep(posed) : shear(posed.knots);
    const Result<PosedCage> caged =
        posedCage(instance, index, static_cast<int>(through - part->cages.data()), CageUse::kTree);
    if (!caged) return false;
    cage = *caged;
    bounds = cage.bounds;
    return true;
  }
  void describe(trace::Context& context) const {
    context.segments = segments;
    context.segment_count = segment_count;
    context.arcs = arcs;
    context.joints = joints;
    context.arc_count = arc_count;
    if (!cage.cage) return;
    context.cage_words = cage.cage->words.data();
    context.nodes = cage.nodes.data();
    context.cage_boxes = &cage.tree[0].min;
    context.cage_leaves = static_cast<int>(cage.leaves);
    context.cage_leaf_cells = cage.cage->leaves.data();
    context.fold_min = cage.inverted.min;
    context.fold_max = cage.inverted.max;
  }
  // The normal of a hit in part space, up to length; n: at rest.
  glm::vec3 normal(const trace::Context& context, const trace::KelpHit& hit, const glm::vec3& n) const {
    if (cage.cage) return trace::kelpCageNormal(context, hit, n);
    if (arc_count == 0) return trace::kelpDeformNormal(segments[hit.segment], hit.t, stretch, n);
    const glm::vec3 middle = 0.5f * glm::vec3(part->size);
    return trace::kelpSweepNormal(arcs[hit.segment], joints[hit.segment], joints[hit.segment + 1],
                                  hit.rest.x - middle.x, hit.rest.y, hit.rest.z - middle.z, n);
  }

 private:
  bool shear(std::span<const Knot> knots) {
    if (!checkKnots(knots)) return false;
    bounds = simd::boundKnots(knots, part->size);
    stretch = 1.0f / (knots.back().position.y - knots.front().position.y);
    for (std::size_t k = 0; k + 1 < knots.size(); ++k)
      segments[k] = asTrace(makeSegment(knots[k], knots[k + 1], static_cast<float>(part->size.y)));
    segment_count = static_cast<int>(knots.size()) - 1;
    return true;
  }
  bool sweep(const PosedPart& posed) {
    ArcChain chain;
    if (!posed.arcs(chain)) return false;
    bounds = chain.bounds;
    for (int i = 0; i < chain.count; ++i) arcs[i] = asTrace(chain.arcs[i]);
    for (int i = 0; i <= chain.count; ++i) joints[i] = asTrace(chain.joints[i]);
    arc_count = chain.count;
    return true;
  }
};

// The nearest hit with one part, up to t_max.
std::optional<Hit> castPart(const Instance& instance, const PageReader& reader, int index, const Ray& ray,
                            float t_max, int wanted_level) {
  const Part& part = instance.asset->pack().parts()[static_cast<std::size_t>(index)];
  if (part.kind != PartKind::kSolid) return std::nullopt;
  int wanted = std::clamp(wanted_level, 0, part.levels - 1), last = part.levels - 1;
  if (!isComplete(reader.level(index, last))) return std::nullopt;  // the model would have holes
  const Cage* cage = nullptr;
  if (!part.cages.empty()) {
    cage = &chooseCage(reader, index, part.cages, wanted);
    wanted = cage->level;
    last = cage->last_level;
  }
  LevelBricks bricks[kMaxLevels];
  trace::Level levels[kMaxLevels];
  const int level_count = listLevels(reader, index, wanted, last, bricks, levels);
  BentPart bent;
  if (!bent.make(instance, index, cage)) return std::nullopt;
  const LevelState& level = *bricks[0].level;
  const std::optional<PartRay> in = rayInPart(instance, index, bent.bounds, ray, t_max);
  if (!in) return std::nullopt;

  trace::Context context;
  bent.describe(context);
  context.bounds_min = in->bounds.min;
  context.bounds_max = in->bounds.max;
  context.size = glm::vec3(part.size);
  context.level_size = level.data.size;
  context.level_scale = std::ldexp(1.0f, -level.level);
  context.levels = levels;
  context.coarser = level_count - 1;
  context.complete = level.resident.load(std::memory_order_acquire) == level.data.pages.size();
  // The trace starts where the ray enters the bounds: float is exact near the volume.
  const trace::KelpHit found =
      trace::kelpTrace(context, glm::vec3(in->origin + in->s0 * in->direction), glm::vec3(in->direction),
                       0.0f, static_cast<float>(in->s1 - in->s0));
  // The numbers of a pack may be too large for floats.
  if (!found.found || !std::isfinite(found.s) || !finite(glm::dvec3(found.rest))) return std::nullopt;

  Hit hit;
  hit.t = static_cast<float>((in->s0 + double{found.s}) / in->length);
  if (hit.t > t_max) return std::nullopt;
  hit.position = ray.origin + hit.t * ray.direction;
  hit.part = index;
  hit.level = level.level + found.coarser;
  hit.voxel = found.voxel;
  hit.rest = toObject(instance, index, found.rest);
  glm::dvec3 normal = -glm::normalize(glm::dvec3(ray.direction));
  if (const auto attribute = bricks[found.coarser].attributeAt(found.voxel)) {
    const glm::vec3 turned = bent.normal(context, found, decodeNormal(attributeNormal(*attribute)));
    if (glm::dot(turned, turned) > 0)
      normal = glm::normalize(glm::transpose(glm::dmat3(in->to_part)) * glm::dvec3(turned));
    hit.material = attributePalette(*attribute);
  } else {
    hit.material = innerMaterial(bricks[found.coarser], found.voxel);
  }
  hit.normal = glm::vec3(normal);
  return hit;
}

std::optional<Hit> castOne(const Instance& instance, const Ray& ray, int wanted_level) {
  if (!instance.asset ||
      (instance.pose && instance.pose->parts() != static_cast<int>(instance.asset->pack().parts().size())))
    return std::nullopt;
  if (!finite(ray.origin) || !finite(ray.direction) || ray.direction == glm::vec3(0) || !(ray.t_max >= 0))
    return std::nullopt;
  const PageReader reader(*instance.asset);
  std::optional<Hit> nearest;
  const auto parts = static_cast<int>(instance.asset->pack().parts().size());
  for (int part = 0; part < parts; ++part) {
    const float t_max = nearest ? nearest->t : ray.t_max;
    if (const auto hit = castPart(instance, reader, part, ray, t_max, wanted_level)) nearest = hit;
  }
  if (nearest && instance.pose && !instance.pose->check()) return std::nullopt;  // it is not drawn
  return nearest;
}

}  // namespace

std::optional<Hit> raycast(Instances instances, const Ray& ray, int wanted_level) {
  std::optional<Hit> nearest;
  Ray rest = ray;
  for (std::size_t i = 0; i < instances.size(); ++i) {
    if (auto hit = castOne(instances[i], rest, wanted_level)) {
      hit->instance = static_cast<int>(i);
      nearest = hit;
      rest.t_max = hit->t;
    }
  }
  return nearest;
}

}  // namespace kelp::runtime
