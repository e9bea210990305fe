// SPDX-License-Identifier: MIT
// distance(), overlaps() and sphereCast() beside raycast() in the same run; README.md here.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <random>

#include "kelp/formats/sweep.h"
#include "kelp/runtime/distance.h"
#include "reference/sweep_trials.h"
#include "support/distance_pack.h"

namespace kelp::runtime {
namespace {

// The least nanoseconds per call of several runs.
double nanoseconds(int calls, const std::function<void(int)>& call) {
  double best = 1e30;
  for (int run = 0; run < 60; ++run) {
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
  float sum = 0;  // so that nothing is left out

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

  // What other benchmarks count in.
  void yardstick() {
    std::vector<glm::mat4> matrices(1025, glm::mat4(0.5f));
    const double ns = nanoseconds(1024, [&](int i) {
      const auto k = static_cast<std::size_t>(i);
      matrices[k] = matrices[k] * matrices[k + 1];
    });
    std::printf("GLM mat4 product: %.1f ns\n", ns);
  }

  void row(const char* name, const Instance& instance) {
    constexpr int kPoints = 1024;
    const Box box = bounds(instance);
    const std::vector<glm::vec3> near = around(box, 0.05f, kPoints), far = around(box, 3, kPoints);
    const auto ask = [&](const std::vector<glm::vec3>& points) {
      return nanoseconds(
          kPoints, [&](int i) { sum += distance(instance, points[static_cast<std::size_t>(i)])->bound; });
    };
    // As things ask that swim together: each point is near the one before.
    std::vector<glm::vec3> swarm = near;
    for (std::size_t i = 1; i < swarm.size(); ++i)
      swarm[i] = glm::clamp(swarm[i - 1] + 0.02f * (near[i] - near[i - 1]) / (box.max - box.min),
                            box.min - 0.05f, box.max + 0.05f);
    const auto cast = [&](const std::vector<glm::vec3>& points) {
      return nanoseconds(kPoints, [&](int i) {
        const glm::vec3& p = points[static_cast<std::size_t>(i)];
        const auto hit = raycast(instance, {p + glm::vec3(1, 0.5f, 0.7f), glm::vec3(-1, -0.5f, -0.7f)});
        sum += hit ? hit->t : 0.0f;
      });
    };
    std::printf("%-22s %10.0f %10.0f %10.0f %10.0f %10.0f", name, ask(near), ask(swarm), ask(far), cast(near),
                cast(swarm));
  }

  void poses() {
    std::printf("%-22s %10s %10s %10s %10s %10s\n", "ns a call, pose", "distance", "a swarm's", "far away",
                "raycast", "a swarm's");
    Pose pose = *Pose::create(*asset);
    for (const test::FigurePose& figure : test::kFigure6) {
      pose.setKnots(0, test::figureKnots(figure)).value();
      row(figure.name, {asset.get(), &pose});
      std::printf("\n");
    }
  }

  // A slender part, so that it can curl. Every query makes the arcs of the pose.
  void sweptPoses() {
    const glm::ivec3 size(60, 200, 56);
    RawPack pack = test::distancePackOf(test::ballClump(size, 40, 2));
    pack.parts[0].bend = Bend::kSweep;
    std::printf("%-22s %10s %10s %10s %10s %10s %10s %10s\n", "swept", "distance", "a swarm's", "far away",
                "raycast", "a swarm's", "arcs", "make them");
    for (const reference::SweepRig& rig : reference::namedSweeps(size)) {
      pack.parts[0].knots = rig.knots;
      pack.parts[0].roll = rig.roll;
      const std::vector<std::byte> swept_bytes = test::bytesOf(pack);
      const MemorySource swept_source(swept_bytes);
      Options options;
      options.distance_level = 0;
      const std::unique_ptr<Asset> swept = Asset::open(swept_source.source(), options).value();
      swept->loadAll().value();
      const Pose pose = *Pose::create(*swept);
      row(rig.name.c_str(), {swept.get(), &pose});
      ArcChain chain;
      const double make = nanoseconds(1024, [&](int) {
        makeArcs(rig.knots, size, rig.roll, kArcTolerance, chain).value();
        sum += chain.bounds.max.x;
      });
      std::printf(" %10d %10.0f\n", chain.count, make);
    }
  }

  // 100 spheres among 400 instances, as in a frame: the boxes are made once.
  void crowd() {
    std::vector<Pose> poses;
    for (const test::FigurePose& figure : test::kFigure6) {
      poses.push_back(*Pose::create(*asset));
      poses.back().setKnots(0, test::figureKnots(figure)).value();
    }
    std::uniform_real_distribution<float> unit(0, 1);
    std::vector<Instance> instances;
    for (int i = 0; i < 400; ++i) {
      // Most plants are bent a little, some strongly.
      const std::size_t figure = i % 8 == 0 ? 1 + static_cast<std::size_t>(i / 8 % 6) : 0;
      Instance one{asset.get(), &poses[figure]};
      one.to_world[3] = glm::vec4(20 * unit(random), 0, 20 * unit(random), 1);
      instances.push_back(one);
    }
    std::vector<Sphere> spheres;
    for (int i = 0; i < 100; ++i)
      spheres.push_back({{20 * unit(random), unit(random), 20 * unit(random)}, 0.1f});
    std::vector<Box> boxes(instances.size());
    int touched = 0, tested = 0;
    const double ns = nanoseconds(5, [&](int) {
      touched = tested = 0;
      for (std::size_t i = 0; i < instances.size(); ++i) boxes[i] = bounds(instances[i]);
      for (const Sphere& sphere : spheres) touched += *overlaps(instances, sphere, boxes) >= 0;
    });
    for (const Sphere& sphere : spheres)
      for (const Box& box : boxes)
        tested += glm::distance(sphere.centre, glm::clamp(sphere.centre, box.min, box.max)) < sphere.radius;
    std::printf("overlaps of 100 spheres with 400 instances: %.3f ms; %d touch, %d pairs of boxes meet\n",
                1e-6 * ns, touched, tested);
    double t = 0;
    const double cast = nanoseconds(100, [&](int i) {
      const Sphere& a = spheres[static_cast<std::size_t>(i)];
      const Sphere& b = spheres[static_cast<std::size_t>(99 - i)];
      t += double{sphereCast(instances, a.centre, b.centre, 0.05f, boxes)->t};
    });
    const double closest = nanoseconds(100, [&](int i) {
      t += double{closestPoint(instances, spheres[static_cast<std::size_t>(i)].centre, 1, boxes)->distance};
    });
    std::printf("sphereCast through them: %.1f us; closestPoint: %.1f us (%g)\n", 1e-3 * cast, 1e-3 * closest,
                t);
  }
};

}  // namespace
}  // namespace kelp::runtime

int main() {
  kelp::runtime::Bench bench;
  bench.yardstick();
  bench.poses();
  bench.crowd();
  bench.sweptPoses();
  std::printf("(%g)\n", static_cast<double>(bench.sum));
}
