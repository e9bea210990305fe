// SPDX-License-Identifier: MIT
#include "reference/sweep_trials.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

#include "reference/sweep_truth.h"
#include "reference/tiled_cpp.h"

namespace kelp::reference {
namespace {

using glm::dvec3;

// Knots on a curve of this length by its direction at each place: a Hermite spline through them.
template <class Direction>
SweepRig along(std::string name, int knots, double length, Direction&& direction) {
  SweepRig rig{std::move(name), {}, 0};
  dvec3 at(0);
  constexpr int kSteps = 2000;
  for (int i = 0; i <= kSteps * (knots - 1); ++i) {
    const double share = static_cast<double>(i) / (kSteps * (knots - 1));
    if (i % kSteps == 0)
      rig.knots.push_back({static_cast<float>(static_cast<double>(i / kSteps) / (knots - 1)), glm::vec3(at),
                           glm::vec3(length * direction(share))});
    at += length / (kSteps * (knots - 1)) * direction(share + 0.5 / (kSteps * (knots - 1)));
  }
  return rig;
}

SweepRig arcRig(std::string name, int knots, double length, double turn, double way) {
  return along(std::move(name), knots, length, [=](double share) {
    const double a = turn * share;
    return dvec3(std::sin(a) * std::cos(way), std::cos(a), std::sin(a) * std::sin(way));
  });
}

struct SweepRay {
  dvec3 o, r;
};

class SweepRayMaker {
 public:
  SweepRayMaker(const TrialVolume& volume, const ArcChain& chain, unsigned seed)
      : volume_(volume), chain_(chain), random_(seed) {}

  [[gnu::noinline]] SweepRay make(int kind) {
    const dvec3 size(volume_.size);
    const auto number = static_cast<int>(random_() % static_cast<unsigned>(chain_.count));
    const Arc& arc = chain_.arcs[number];
    dvec3 rest(size.x * unit(), 0, size.z * unit());
    const double low = chain_.joints[number].y, high = chain_.joints[number + 1].y;
    rest.y = low + (high - low) * unit();
    if (kind == 5) rest.y = (random_() & 1 ? low : high) + 2 * unit() - 1;
    if (kind == 8) rest = besideSolid(rest);
    if (kind == 9) rest = dvec3(std::floor(rest.x), rest.y, std::floor(rest.z));
    const Arc& own = kind == 8 ? arcAt(rest.y) : arc;
    dvec3 target = swept(own, volume_.size, rest);
    const dvec3 above = swept(own, volume_.size, rest + dvec3(0, 1e-3, 0));
    const dvec3 t = glm::normalize(above - target), b = glm::cross(dvec3(own.inward), dvec3(own.along));
    const dvec3 n = glm::cross(t, b);
    const double turn = 2 * std::numbers::pi * unit();
    dvec3 d = dvec3(unit(), unit(), unit()) - 0.5 + dvec3(1e-4, 0, 0);
    if (kind == 1) d = t;
    if (kind == 2) d = std::cos(turn) * n + std::sin(turn) * b;
    if (kind == 3) d = b;
    if (kind == 4) {
      const dvec3 axis = dvec3(own.middle) + dvec3(own.inward) / std::max<double>(own.curvature, 1e-4) +
                         size.x * (unit() - 0.5) * b;
      d = axis - target;
    }
    if (kind == 6) {
      d = dvec3(0);
      d[static_cast<int>(random_() % 3)] = 1;
    }
    if (kind == 9) {  // within the plane that touches a face of voxels
      const dvec3 beside = swept(own, volume_.size, rest + dvec3(random_() & 1 ? 1e-3 : 0, 0, 1e-3));
      d = std::cos(turn) * t + std::sin(turn) * glm::normalize(beside - target);
    }
    d = (random_() & 1 ? 1.0 : -1.0) * glm::normalize(d);
    const Box& box = chain_.bounds;
    double back = 1e30;
    for (int a = 0; a < 3; ++a) {
      if (d[a] != 0) back = std::min(back, (target[a] - double{d[a] > 0 ? box.min[a] : box.max[a]}) / d[a]);
    }
    if (kind == 7) back *= unit() * unit();
    if (kind == 10) {
      // From far away, the direction rounded there; then moved to the bounds in double precision, as raycast
      // does.
      const double far = 30 * glm::length(dvec3(box.max - box.min));
      const glm::vec3 from(target - far * d), towards(d);
      dvec3 r = glm::normalize(dvec3(towards));
      return {dvec3(from) + (far - back) * r, r};
    }
    return {target - back * d, d};
  }

 private:
  double unit() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  const Arc& arcAt(double y) const {
    int i = 0;
    while (i + 1 < chain_.count && y > double{chain_.joints[i + 1].y}) ++i;
    return chain_.arcs[i];
  }
  dvec3 besideSolid(const dvec3& otherwise) {
    const glm::ivec3 size = volume_.pattern.size;
    for (int i = 0; i < 2000; ++i) {
      const glm::ivec3 v(static_cast<int>(random_() % static_cast<unsigned>(size.x)),
                         static_cast<int>(random_() % static_cast<unsigned>(size.y)),
                         static_cast<int>(random_() % static_cast<unsigned>(size.z)));
      if (!volume_.pattern.solid[volume_.pattern.index(v)]) continue;
      const dvec3 tiles(volume_.size / size);
      const glm::ivec3 tile(tiles * dvec3(unit(), unit(), unit()));
      return glm::clamp(dvec3(v + tile * size) - 0.25 + 1.5 * dvec3(unit(), unit(), unit()), dvec3(0),
                        dvec3(volume_.size));
    }
    return otherwise;
  }

  const TrialVolume& volume_;
  const ArcChain& chain_;
  std::mt19937 random_;
};

}  // namespace

std::vector<SweepRig> namedSweeps(const glm::ivec3& size) {
  constexpr double kDegrees = std::numbers::pi / 180;
  const double half = std::hypot(0.5 * size.x, 0.5 * size.z) / size.y;
  // Long enough to turn by so many radians for each of its height.
  const auto lengthFor = [half](double turn) { return std::max(1.0, turn * half / 0.9); };
  const auto bent = [&](std::string name, int knots, double degrees, double way) {
    return arcRig(std::move(name), knots, lengthFor(degrees * kDegrees), degrees * kDegrees, way);
  };
  std::vector<SweepRig> rigs{bent("straight", 2, 0, 0), bent("30 degrees", 2, 30, 0.4),
                             bent("45 degrees", 2, 45, 1), bent("60 degrees", 2, 60, 0),
                             bent("90 degrees", 3, 90, -2)};
  rigs.push_back(along("S", 4, lengthFor(3.8), [](double share) {
    const double a = 0.55 * std::sin(2 * std::numbers::pi * share), way = 3 * share;
    return dvec3(std::sin(a) * std::cos(way), std::cos(a), std::sin(a) * std::sin(way));
  }));
  rigs.push_back(bent("curl", 4, 270, 0.1));
  rigs.push_back(along("helix", 9, lengthFor(3.7), [](double share) {
    const double way = 1.5 * std::numbers::pi * share;
    return dvec3(0.77 * std::cos(way), 0.638, 0.77 * std::sin(way));
  }));
  rigs.back().roll = 0.7f;
  rigs.push_back(arcRig("tight", 9, 1, std::min(0.93 / half, 5.5), 0.7853981633974483));
  return rigs;
}

SweepRig randomSweep(const glm::ivec3& size, unsigned seed) {
  std::mt19937 random(seed);
  const auto signedUnit = [&] { return std::uniform_real_distribution<float>(-1, 1)(random); };
  while (true) {
    SweepRig rig{"random " + std::to_string(seed), {}, 3 * signedUnit()};
    const int count = 2 + static_cast<int>(random() % 4);
    glm::vec3 at(signedUnit(), signedUnit(), signedUnit());
    glm::vec3 way(signedUnit(), signedUnit(), signedUnit());
    for (int i = 0; i < count; ++i) {
      const float share = static_cast<float>(i) / static_cast<float>(count - 1);
      way = glm::normalize(glm::normalize(way) + 0.8f * glm::vec3(signedUnit(), signedUnit(), signedUnit()));
      rig.knots.push_back({share, at, (1 + 0.5f * signedUnit()) * way});
      at += (1.2f + 0.5f * signedUnit()) / static_cast<float>(count - 1) *
            glm::normalize(way + 0.5f * glm::vec3(signedUnit(), signedUnit(), signedUnit()));
    }
    if (checkSweep(rig.knots, size, rig.roll)) return rig;
  }
}

void SweepTally::add(const SweepTally& more) {
  TrialTally::add(more);
  clips += more.clips;
  arcs += more.arcs;
}

SweepTally runSweepTrial(const TrialVolume& volume, const SweepRig& rig, int rays, unsigned seed) {
  SweepTally tally;
  ArcChain chain;
  if (const Result<void> made = makeArcs(rig.knots, volume.size, rig.roll, kArcTolerance, chain); !made) {
    tally.first_failure = rig.name + ": " + made.error().detail;
    ++tally.missed;
    return tally;
  }
  const auto arcs = arcsAs<tiled::KelpArc>(chain);
  const auto joints = jointsAs<tiled::KelpJoint>(chain);
  const tiled::Context context{volume,      nullptr,       0,          chain.bounds.min, chain.bounds.max,
                               arcs.data(), joints.data(), chain.count};
  const Volume truth_volume{volume.size, volume.pattern.solid, 1.0, volume.size,
                            volume.tiled ? volume.pattern.size : glm::ivec3(0)};
  const float s_max = 2 * glm::length(chain.bounds.max - chain.bounds.min);
  SweepRayMaker make(volume, chain, seed);
  for (int i = 0; i < rays; ++i) {
    const int kind = i % kSweepRayKinds;
    const SweepRay ray = make.make(kind);
    const glm::vec3 o(ray.o), r(ray.r);
    const tiled::KelpHit hit = tiled::kelpTraceSwept(context, o, r, 0.0f, s_max);
    const Truth truth = truthOf(truth_volume, chain, dvec3(o), dvec3(r), double{s_max});
    tally.clips += static_cast<std::uint64_t>(hit.clips);
    tally.arcs += static_cast<std::uint64_t>(chain.count);
    tally.steps_max = std::max(tally.steps_max, hit.steps + hit.outside);
    if (tally.count(truth, hit, double{hit.s})) {
      char text[400];
      std::snprintf(text, sizeof text,
                    "%s, %s, kind %d: o (%a %a %a) r (%a %a %a): %s %.4f arc %d; owed %.4f, possible %.4f",
                    volume.name.c_str(), rig.name.c_str(), kind, double{o.x}, double{o.y}, double{o.z},
                    double{r.x}, double{r.y}, double{r.z}, hit.found ? "hit" : "no hit", double{hit.s},
                    hit.segment, truth.owed.value_or(-1), truth.possible.value_or(-1));
      tally.first_failure = text;
    }
  }
  return tally;
}

}  // namespace kelp::reference
