// SPDX-License-Identifier: MIT
#include "bench_trace_long.h"

#include <cstdio>
#include <mutex>
#include <random>

#include "bench_trace_check.h"
#include "reference/trials.h"
#include "support/poses.h"

namespace kelp::bench {
namespace {

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

}  // namespace

bool runLong(const std::vector<Scene>& scenes, std::uint64_t rays, int threads) {
  std::vector<TrialVolume> volumes;
  for (const Scene& scene : scenes) {
    for (const Item& item : scene.items)
      volumes.push_back(reference::wholeVolume(scene.name + ": " + item.name, item.volume));
  }
  volumes.push_back(reference::wholeVolume("clump", test::ballClump({256, 249, 195}, 30, 7)));
  volumes.push_back(reference::wholeVolume("noise", test::dust({512, 361, 512}, 30000, 8)));
  const fields::Occupancy tile = makeTile();
  for (const int side : {512, 1024, 2048, 4096})
    volumes.push_back(reference::tiledVolume("virtual", tile, glm::ivec3(side, side, side / 2)));

  TrialTally total;
  for (const TrialVolume& volume : volumes) {
    std::vector<reference::TrialRig> rigs = reference::namedRigs(volume.size);
    for (unsigned seed = 0; seed < 8; ++seed) rigs.push_back(reference::randomRig(volume.size, seed));
    // Trials small enough to keep all threads busy.
    constexpr std::uint64_t kTrial = 4000;
    const std::uint64_t rounds = std::max<std::uint64_t>(1, rays / (volumes.size() * rigs.size() * kTrial));
    TrialTally tally;
    std::mutex mutex;
    parallelFor(static_cast<std::size_t>(rounds) * rigs.size(), threads, [&](std::size_t i) {
      const TrialTally one = reference::runTrial(volume, rigs[i % rigs.size()], static_cast<int>(kTrial),
                                                 static_cast<unsigned>(1000 + i));
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
    total.add(tally);
  }
  std::printf("in all %llu rays: %llu missed, %llu false\n", static_cast<unsigned long long>(total.rays),
              static_cast<unsigned long long>(total.missed), static_cast<unsigned long long>(total.invented));
  return total.missed == 0 && total.invented == 0;
}

}  // namespace kelp::bench
