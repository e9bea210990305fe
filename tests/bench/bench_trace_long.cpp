// SPDX-License-Identifier: MIT
#include "bench_trace_long.h"

#include <cstdio>
#include <mutex>
#include <random>

#include "bench_trace_check.h"
#include "reference/cage_trials.h"
#include "reference/sweep_trials.h"
#include "reference/trials.h"
#include "support/poses.h"

namespace kelp::bench {
namespace {

using reference::SweepTally;
using reference::TrialTally;
using reference::TrialVolume;

// A tile with a ball, single voxels, a post, and more single voxels in the layers that come to lie at the
// ends of the volume.
fields::Occupancy makeTile() {
  fields::Occupancy tile = test::dust({64, 64, 64}, 20000, 1);
  std::mt19937 random(2);
  for (int z = 0; z < 64; ++z) {
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) {
        const glm::vec3 d = glm::vec3(x, y, z) - glm::vec3(20, 40, 30);
        const bool end = (y == 0 || y == 63) && random() % 300 == 0;
        if (glm::dot(d, d) < 25 || end || (x == 50 && z == 12)) tile.solid[tile.index({x, y, z})] = 1;
      }
    }
  }
  return tile;
}

// Random rays through a volume in these rigs, in trials small enough to keep all threads busy.
template <class Tally, class Volume, class Trial>
Tally runVolume(const Volume& volume, std::size_t rigs, std::uint64_t rays, int threads, Trial&& trial) {
  constexpr std::uint64_t kTrial = 4000;
  const std::uint64_t rounds = std::max<std::uint64_t>(1, rays / (rigs * kTrial));
  Tally tally;
  std::mutex mutex;
  parallelFor(static_cast<std::size_t>(rounds) * rigs, threads, [&](std::size_t i) {
    const Tally one = trial(i % rigs, static_cast<int>(kTrial), static_cast<unsigned>(1000 + i));
    const std::lock_guard lock(mutex);
    tally.add(one);
  });
  const auto n = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  std::printf(
      "%-28s %4dx%4dx%4d %9llu rays %9llu owed %6llu missed %4llu false %7llu grazing %5llu depth off, "
      "steps %6.2f max %d\n",
      volume.name.c_str(), volume.size.x, volume.size.y, volume.size.z, n(tally.rays), n(tally.owed),
      n(tally.missed), n(tally.invented), n(tally.grazing), n(tally.depth_off),
      static_cast<double>(tally.steps) / static_cast<double>(tally.rays), tally.steps_max);
  if (!tally.first_failure.empty()) std::printf("  %s\n", tally.first_failure.c_str());
  std::fflush(stdout);
  return tally;
}

std::vector<TrialVolume> volumesOf(const std::vector<Scene>& scenes, Bend bend) {
  std::vector<TrialVolume> volumes;
  for (const Scene& scene : scenes) {
    if (scene.bend != bend || scene.caged) continue;
    for (const Item& item : scene.items)
      volumes.push_back(reference::wholeVolume(scene.name + ": " + item.name, item.volume));
  }
  const bool swept = bend == Bend::kSweep;  // these are slender
  const auto slender = [&](const glm::ivec3& wide, const glm::ivec3& high) { return swept ? high : wide; };
  volumes.push_back(reference::wholeVolume(swept ? "clump swept" : "clump",
                                           test::ballClump(slender({256, 249, 195}, {72, 256, 64}), 30, 7)));
  volumes.push_back(
      reference::wholeVolume(swept ? "noise swept" : "noise",
                             test::dust(slender({512, 361, 512}, {140, 512, 101}), swept ? 300 : 30000, 8)));
  const fields::Occupancy tile = makeTile();
  for (const int side : {512, 1024, 2048, 4096}) {
    if (swept && side > 2048) continue;
    volumes.push_back(reference::tiledVolume(swept ? "virtual swept" : "virtual", tile,
                                             slender({side, side, side / 2}, {side / 4, side, side / 4})));
  }
  return volumes;
}

// By the tree and walked, in poses that fold nothing.
TrialTally runCaged(const std::vector<Scene>& scenes, std::uint64_t rays, int threads) {
  std::vector<reference::CagedVolume> volumes;
  for (const Scene& scene : scenes) {
    if (!scene.caged) continue;
    volumes.push_back(reference::cagedVolume(scene.name, scene.items.front().volume, kCageCell));
  }
  volumes.push_back(
      reference::cagedVolume("clump caged", test::ballClump({256, 249, 195}, 30, 7), 2 * kCageCell));
  TrialTally total;
  for (const reference::CagedVolume& volume : volumes) {
    std::vector<reference::CagePose> poses = reference::namedCagePoses(volume.size);
    poses.push_back(reference::shakenPose(0.2));
    total.add(runVolume<reference::CageTally>(volume, poses.size(), rays / volumes.size(), threads,
                                              [&](std::size_t pose, int count, unsigned seed) {
                                                reference::CageTallies both =
                                                    reference::runCageTrial(volume, poses[pose], count, seed);
                                                both.traced.add(both.walked);
                                                return both.traced;
                                              }));
  }
  return total;
}

}  // namespace

bool runLong(const std::vector<Scene>& scenes, std::uint64_t rays, int threads) {
  TrialTally total;
  const std::vector<TrialVolume> sheared = volumesOf(scenes, Bend::kShear);
  for (const TrialVolume& volume : sheared) {
    std::vector<reference::TrialRig> rigs = reference::namedRigs(volume.size);
    for (unsigned seed = 0; seed < 8; ++seed) rigs.push_back(reference::randomRig(volume.size, seed));
    total.add(runVolume<TrialTally>(volume, rigs.size(), rays / sheared.size(), threads,
                                    [&](std::size_t rig, int count, unsigned seed) {
                                      return reference::runTrial(volume, rigs[rig], count, seed);
                                    }));
  }
  SweepTally swept_total;
  const std::vector<TrialVolume> swept = volumesOf(scenes, Bend::kSweep);
  for (const TrialVolume& volume : swept) {
    std::vector<reference::SweepRig> rigs = reference::namedSweeps(volume.size);
    for (unsigned seed = 0; seed < 25; ++seed) rigs.push_back(reference::randomSweep(volume.size, seed));
    swept_total.add(runVolume<SweepTally>(volume, rigs.size(), rays / swept.size(), threads,
                                          [&](std::size_t rig, int count, unsigned seed) {
                                            return reference::runSweepTrial(volume, rigs[rig], count, seed);
                                          }));
  }
  const auto n = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  std::printf("sheared: %llu rays, %llu missed, %llu false\n", n(total.rays), n(total.missed),
              n(total.invented));
  std::printf("swept: %llu rays, %llu missed, %llu false; %.2f of %.2f slices clipped for each ray\n",
              n(swept_total.rays), n(swept_total.missed), n(swept_total.invented),
              static_cast<double>(swept_total.clips) / static_cast<double>(swept_total.rays),
              static_cast<double>(swept_total.arcs) / static_cast<double>(swept_total.rays));
  const TrialTally caged = runCaged(scenes, rays, threads);
  std::printf("caged: %llu rays, %llu missed, %llu false\n", n(caged.rays), n(caged.missed),
              n(caged.invented));
  total.add(swept_total);
  total.add(caged);
  return total.missed == 0 && total.invented == 0;
}

}  // namespace kelp::bench
