// SPDX-License-Identifier: MIT
// distance(), overlaps() and sphereCast() beside raycast() in the same run; README.md here.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <random>

#include "kelp/runtime/distance.h"
#include "support/distance_pack.h"

namespace kelp::runtime {
namespace {

// The least nanoseconds per call of several runs.
double nanoseconds(int calls, const std::function<void(int)>& call) {
  double best = 1e30;
  for (int run = 0; run < 7; ++run) {
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < calls; ++i) call(i);
    const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - begin;
    best = std::min(best, took.count() / calls);
  }
  return best;
}

struct Bench {
  std::vector<std::byte> bytes = test::bytesOf(test::distancePackOf(test::ballClump({150, 200, 140}, 40, 2)));
  MemorySource source{bytes};
  std::unique_ptr<Asset> asset;
  std::mt19937 random{1};

  Bench() {
    Options options;
    options.distance_level = 0;
    asset = Asset::open(source.source(), options).value();
    asset->loadAll().value();
  }
  // A point about so many voxels around the instance.
  std::vector<glm::vec3> around(const Box& box, float margin, int count) {
    std::uniform_real_distribution<float> unit(0, 1);
    std::vector<glm::vec3> points;
    for (int i = 0; i < count; ++i) {
      const glm::vec3 share(unit(random), unit(random), unit(random));
      points.push_back(glm::mix(box.min - margin, box.max + margin, share));
    }
    return points;
  }

  void poses() {
    constexpr int kPoints = 4096;
    std::printf("%-24s %12s %12s %12s %8s\n", "ns a call, pose", "distance", "far away", "raycast", "ratio");
    Pose pose = *Pose::create(*asset);
    float sum = 0;
    for (const test::FigurePose& figure : test::kFigure6) {
      pose.setKnots(0, test::figureKnots(figure)).value();
      const Instance instance{asset.get(), &pose};
      const Box box = bounds(instance);
      const std::vector<glm::vec3> near = around(box, 0.05f, kPoints), far = around(box, 3, kPoints);
      const auto ask = [&](const std::vector<glm::vec3>& points) {
        return nanoseconds(kPoints, [&](int i) {
          sum += distance(instance, points[static_cast<std::size_t>(i)])->bound;
        });
      };
      const double to_near = ask(near), to_far = ask(far);
      const double ray = nanoseconds(kPoints, [&](int i) {
        const auto k = static_cast<std::size_t>(i);
        const auto hit = raycast(instance, {far[k], near[k] - far[k]});
        sum += hit ? hit->t : 0.0f;
      });
      std::printf("%-24s %12.0f %12.0f %12.0f %8.2f\n", figure.name, to_near, to_far, ray, to_near / ray);
    }
    std::printf("(%g)\n", static_cast<double>(sum));
  }
};

}  // namespace
}  // namespace kelp::runtime

int main() {
  kelp::runtime::Bench bench;
  bench.poses();
}
