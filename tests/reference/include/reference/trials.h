// SPDX-License-Identifier: MIT
// Many awkward rays through a posed volume: trace.glsl, compiled as C++, judged by the ground truth. For
// tests and for long runs.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "kelp/fields/fields.h"
#include "kelp/formats/spline.h"
#include "reference/judge.h"

namespace kelp::reference {

// A volume with what trace.glsl reads. A tiled one repeats a small pattern, so that it may be larger than any
// memory.
struct TrialVolume {
  std::string name;
  glm::ivec3 size{0};
  fields::Occupancy pattern;  // the volume, or one tile of it
  RawLevel level;
  glm::ivec3 grid{0};         // bricks of `level`
  glm::ivec3 tile_bricks{0};  // bricks of the pattern
  glm::ivec3 first_brick{0};  // of the pattern in `level`
  bool tiled = false;
};
TrialVolume wholeVolume(std::string name, fields::Occupancy volume);
// `tile` repeated over `size` voxels. Its sides must be multiples of 8.
TrialVolume tiledVolume(std::string name, const fields::Occupancy& tile, const glm::ivec3& size);

struct TrialRig {
  std::string name;
  std::vector<Knot> knots;
};
// The poses of the paper's Figure 6, and three segments.
std::vector<TrialRig> namedRigs(const glm::ivec3& size);
// Two to five knots, monotone, with strong tangents, stretched or squashed.
TrialRig randomRig(const glm::ivec3& size, unsigned seed);

struct TrialTally {
  std::uint64_t rays = 0, hits = 0, owed = 0, grazing = 0, missed = 0, invented = 0;
  std::uint64_t depth_off = 0;  // hits, not grazing, more than half a voxel from the truth
  std::uint64_t steps = 0, outside = 0;
  int steps_max = 0;
  std::string first_failure;  // the first ray that was judged wrong, to be traced again

  void add(const TrialTally& more);
  // Counts a ray with its hit, a KelpHit of any program, `s` along the ray. True: it is the first one that is
  // judged wrong.
  template <class Hit>
  bool count(const Truth& truth, const Hit& hit, double s) {
    const Verdict verdict = judge(truth, hit.found ? std::optional(s) : std::nullopt);
    ++rays;
    hits += hit.found;
    owed += truth.owed.has_value();
    grazing += truth.grazing();
    missed += verdict == Verdict::kMissed;
    invented += verdict == Verdict::kFalse;
    depth_off += hit.found && truth.owed && (s < *truth.possible - 0.5 || s > *truth.owed + 0.5);
    steps += static_cast<std::uint64_t>(hit.steps);
    outside += static_cast<std::uint64_t>(hit.outside);
    steps_max = std::max(steps_max, hit.steps);
    return verdict != Verdict::kRight && first_failure.empty();
  }
};

// Rays of every kind: any direction, along the spline, exactly and nearly horizontal, along an axis, from
// inside, at the ends, close past solid voxels, (nearly) horizontal close to a knot.
inline constexpr int kRayKinds = 9;
TrialTally runTrial(const TrialVolume& volume, const TrialRig& rig, int rays, unsigned seed);

}  // namespace kelp::reference
