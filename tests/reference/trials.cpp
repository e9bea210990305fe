// SPDX-License-Identifier: MIT
#include "reference/trials.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "reference/judge.h"
#include "reference/tiled_cpp.h"
#include "support/boxed_level.h"
#include "support/poses.h"
#include "support/voxel_knots.h"

namespace kelp::reference {
namespace {

using glm::dvec3;

// A point of the undeformed volume to where the spline takes it, in double precision.
class ForwardMap {
 public:
  ForwardMap(std::span<const Knot> knots, const glm::ivec3& size) : knots_(knots), height_(size.y) {}
  dvec3 operator()(const dvec3& rest) const {
    const double y =
        double{knots_.front().position.y} +
        rest.y / height_ * (double{knots_.back().position.y} - double{knots_.front().position.y});
    std::size_t i = 0;
    while (i + 2 < knots_.size() && y > double{knots_[i + 1].position.y}) ++i;
    double low = 0, high = 1;
    for (int n = 0; n < 60; ++n) (at(i, 0.5 * (low + high)).y < y ? low : high) = 0.5 * (low + high);
    const dvec3 s = at(i, low);
    return {rest.x + s.x, y, rest.z + s.z};
  }

 private:
  dvec3 at(std::size_t i, double t) const {
    const Knot &k0 = knots_[i], &k1 = knots_[i + 1];
    const double u = 1 - t, share = double{k1.at} - double{k0.at};
    return u * u * (1 + 2 * t) * dvec3(k0.position) + t * u * u * share * dvec3(k0.tangent) +
           t * t * (3 - 2 * t) * dvec3(k1.position) - t * t * u * share * dvec3(k1.tangent);
  }
  std::span<const Knot> knots_;
  double height_;
};

struct Ray {
  glm::vec3 o, r;
};

class RayMaker {
 public:
  RayMaker(const TrialVolume& volume, std::span<const Knot> knots, const Box& bounds, unsigned seed)
      : volume_(volume), knots_(knots), map_(knots, volume.size), bounds_(bounds), random_(seed) {}

  // Not inlined: GCC 12 takes the rounding to float32 and back out where it sees both ends, and the truth
  // would be asked about another ray than the trace (one false hit in 10 million, at 4096).
  [[gnu::noinline]] Ray make(int kind) {
    const dvec3 size(volume_.size);
    dvec3 rest = size * dvec3(unit(), unit(), unit());
    if (kind == 6) rest.y = unit() < 0.5 ? 2 * unit() : size.y - 2 * unit();
    if (kind == 7) rest = besideSolid(rest);
    if (kind == 8) rest.y = besideKnot();
    const dvec3 target = map_(rest);
    dvec3 d = dvec3(unit(), unit(), unit()) - 0.5 + dvec3(1e-4, 0, 0);
    if (kind == 1) d = map_(size * dvec3(unit(), unit(), unit())) - target + dvec3(1e-3, 1e-3, 0);
    if (kind == 2) d.y = 0;
    if (kind == 8) d.y = unit() < 0.5 ? 0 : 1e-6 * (unit() - 0.5);
    if (kind == 3) d.y *= std::pow(10.0, -1 - 6 * unit());
    if (kind == 4) {
      d = dvec3(0);
      d[static_cast<int>(random_() % 3)] = unit() < 0.5 ? -1 : 1;
    }
    d = glm::normalize(d);
    double back = 1e30;  // to where the ray enters the bounds, as callers do
    for (int a = 0; a < 3; ++a) {
      if (d[a] != 0)
        back = std::min(back, (target[a] - double{d[a] > 0 ? bounds_.min[a] : bounds_.max[a]}) / d[a]);
    }
    if (kind == 5) back *= unit() * unit();
    return {glm::vec3(target - back * d), glm::vec3(d)};
  }

 private:
  double unit() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  // A point within a quarter voxel of a solid voxel's surface.
  dvec3 besideSolid(const dvec3& otherwise) {
    const glm::ivec3 size = volume_.pattern.size;
    for (int i = 0; i < 2000; ++i) {
      const glm::ivec3 v(static_cast<int>(random_() % static_cast<unsigned>(size.x)),
                         static_cast<int>(random_() % static_cast<unsigned>(size.y)),
                         static_cast<int>(random_() % static_cast<unsigned>(size.z)));
      if (!volume_.pattern.solid[volume_.pattern.index(v)]) continue;
      const glm::ivec3 tiles = volume_.size / size;
      const glm::ivec3 tile(static_cast<int>(unit() * tiles.x), static_cast<int>(unit() * tiles.y),
                            static_cast<int>(unit() * tiles.z));
      return glm::clamp(dvec3(v + tile * size) + dvec3(-0.25) + 1.5 * dvec3(unit(), unit(), unit()), dvec3(0),
                        dvec3(volume_.size));
    }
    return otherwise;
  }

  // Within a voxel of a knot, mostly much nearer: where the spline may be steep without end.
  double besideKnot() {
    const double first = knots_.front().position.y, last = knots_.back().position.y;
    const double knot = knots_[random_() % knots_.size()].position.y;
    const double y = knot + (unit() < 0.5 ? -1 : 1) * std::pow(10.0, -4 * unit());
    return volume_.size.y * std::clamp((y - first) / (last - first), 0.0, 1.0);
  }

  const TrialVolume& volume_;
  std::span<const Knot> knots_;
  ForwardMap map_;
  Box bounds_;
  std::mt19937 random_;
};

std::string describe(const TrialVolume& volume, const TrialRig& rig, int kind, const Ray& ray,
                     const tiled::KelpHit& hit, const Truth& truth) {
  char text[512];
  std::snprintf(text, sizeof text,
                "%s, rig %s, kind %d: o (%a %a %a) r (%a %a %a): %s s %.4f voxel %d %d %d, %d steps; owed "
                "%.4f, possible %.4f",
                volume.name.c_str(), rig.name.c_str(), kind, double{ray.o.x}, double{ray.o.y},
                double{ray.o.z}, double{ray.r.x}, double{ray.r.y}, double{ray.r.z},
                hit.found ? "hit" : "no hit", double{hit.s}, hit.voxel.x, hit.voxel.y, hit.voxel.z, hit.steps,
                truth.owed.value_or(-1), truth.possible.value_or(-1));
  return text;
}

}  // namespace

TrialVolume wholeVolume(std::string name, fields::Occupancy volume) {
  TrialVolume out;
  out.name = std::move(name);
  out.size = volume.size;
  out.level = test::boxedLevel(volume, test::plainSurface(volume), 1);
  out.grid = out.tile_bricks = brickGrid(volume.size);
  out.pattern = std::move(volume);
  return out;
}

TrialVolume tiledVolume(std::string name, const fields::Occupancy& tile, const glm::ivec3& size) {
  // The tile in the middle of others like it, so many that no box of its bricks reaches their end.
  const int around = (kCellMaxReach * kBrickSide + std::min({tile.size.x, tile.size.y, tile.size.z}) - 1) /
                     std::min({tile.size.x, tile.size.y, tile.size.z});
  const int side = 2 * around + 1;
  fields::Occupancy block{
      side * tile.size,
      std::vector<std::uint8_t>(static_cast<std::size_t>(side * side * side) * tile.solid.size())};
  for (int z = 0; z < block.size.z; ++z)
    for (int y = 0; y < block.size.y; ++y)
      for (int x = 0; x < block.size.x; ++x)
        block.solid[block.index({x, y, z})] = tile.solid[tile.index(glm::ivec3(x, y, z) % tile.size)];
  TrialVolume out;
  out.name = std::move(name);
  out.size = size;
  out.level = test::boxedLevel(block, test::plainSurface(block), 1);
  out.grid = brickGrid(block.size);
  out.tile_bricks = brickGrid(tile.size);
  out.first_brick = around * out.tile_bricks;
  out.pattern = tile;
  out.tiled = true;
  return out;
}

std::vector<TrialRig> namedRigs(const glm::ivec3& size) {
  std::vector<TrialRig> rigs;
  for (const auto& pose : test::kFigure6) rigs.push_back({pose.name, test::figureKnots(pose)});
  const glm::vec3 s = glm::vec3(size) / static_cast<float>(size.y);
  rigs.push_back({"three segments",
                  {{0, {0, 0, 0}, s * glm::vec3(0.5f, 1, 0)},
                   {0.2f, s * glm::vec3(0.25f, 0.2f, -0.1f), s * glm::vec3(-1.3f, 0.6f, 0.8f)},
                   {0.65f, s * glm::vec3(-0.3f, 0.7f, 0.2f), s * glm::vec3(0.5f, 0, -1.2f)},
                   {1, s * glm::vec3(0.1f, 1, 0), s * glm::vec3(0, 1, 0)}}});
  // Nothing round: no coefficient is exact in float32.
  const float height = 1.567578f * static_cast<float>(size.y);
  rigs.push_back(
      {"lifted", test::inHeights({{0, {3.7f, 17.3f, -2.9f}, height * glm::vec3(0, 0, -3.1f)},
                                  {1, {-1.3f, 17.3f + height, 8.1f}, height * glm::vec3(-33.3f, 0, -10.7f)}},
                                 static_cast<float>(size.y))});
  return rigs;
}

TrialRig randomRig(const glm::ivec3& size, unsigned seed) {
  std::mt19937 random(seed);
  const auto unit = [&] { return std::uniform_real_distribution<float>(0, 1)(random); };
  const auto signedUnit = [&] { return 2 * unit() - 1; };
  const glm::vec3 s(size);
  while (true) {
    TrialRig rig{"random " + std::to_string(seed), {}};
    const int count = 2 + static_cast<int>(random() % 4);
    const float height = 0.4f + 2 * unit(), strength = std::pow(10.0f, 1.5f * unit() - 0.5f);
    for (int i = 0; i < count; ++i) {
      const float at = i == 0 ? 0.0f
                              : (i == count - 1 ? 1.0f
                                                : (static_cast<float>(i) + 0.6f * signedUnit()) /
                                                      static_cast<float>(count - 1));
      const float rise = unit() < 0.4f ? 0.0f : height * 2 * unit();
      rig.knots.push_back({at,
                           {0.5f * s.x * signedUnit(), 3 / s.y + height * at, 0.5f * s.z * signedUnit()},
                           {strength * s.x * signedUnit(), rise, strength * s.z * signedUnit()}});
      rig.knots.back().position.x /= s.y, rig.knots.back().position.z /= s.y;
      rig.knots.back().tangent.x /= s.y, rig.knots.back().tangent.z /= s.y;
    }
    if (checkKnots(rig.knots)) return rig;
  }
}

void TrialTally::add(const TrialTally& more) {
  rays += more.rays;
  hits += more.hits;
  owed += more.owed;
  grazing += more.grazing;
  missed += more.missed;
  invented += more.invented;
  depth_off += more.depth_off;
  steps += more.steps;
  outside += more.outside;
  steps_max = std::max(steps_max, more.steps_max);
  if (first_failure.empty()) first_failure = more.first_failure;
}

TrialTally runTrial(const TrialVolume& volume, const TrialRig& rig, int rays, unsigned seed) {
  std::vector<tiled::KelpSegment> segments;
  for (std::size_t i = 0; i + 1 < rig.knots.size(); ++i) {
    const Segment g = makeSegment(rig.knots[i], rig.knots[i + 1], static_cast<float>(volume.size.y));
    segments.push_back({g.p0, g.m0, g.p1, g.m1});
  }
  const Box bounds = deformedBounds(rig.knots, volume.size);
  const tiled::Context context{volume, segments.data(), static_cast<int>(segments.size()), bounds.min,
                               bounds.max};
  const Volume truth_volume{volume.size, volume.pattern.solid, 1.0, volume.size,
                            volume.tiled ? volume.pattern.size : glm::ivec3(0)};
  const float s_max = 2 * glm::length(bounds.max - bounds.min);

  TrialTally tally;
  const std::vector<Knot> in_voxels = test::inVoxels(rig.knots, static_cast<float>(volume.size.y));
  RayMaker make(volume, in_voxels, bounds, seed);
  for (int i = 0; i < rays; ++i) {
    const int kind = i % kRayKinds;
    const Ray ray = make.make(kind);
    const tiled::KelpHit hit = tiled::kelpTraceSheared(context, ray.o, ray.r, 0.0f, s_max);
    const Truth truth = truthOf(truth_volume, rig.knots, dvec3(ray.o), dvec3(ray.r), double{s_max});
    if (tally.count(truth, hit, double{hit.s}))
      tally.first_failure = describe(volume, rig, kind, ray, hit, truth);
  }
  return tally;
}

}  // namespace kelp::reference
