// SPDX-License-Identifier: MIT
#include "bench_trace_check.h"

#include <atomic>
#include <thread>

#include "reference/sweep_trials.h"
#include "reference/sweep_truth.h"
#include "support/traced_level.h"
#include "trace_cpp.h"

namespace kelp::bench {

void parallelFor(std::size_t count, int threads, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  const auto run = [&] {
    for (std::size_t i = next++; i < count; i = next++) work(i);
  };
  std::vector<std::thread> pool;
  for (int i = 1; i < threads; ++i) pool.emplace_back(run);
  run();
  for (std::thread& thread : pool) thread.join();
}

std::vector<RayCheck> checkRays(const PosedItem& item, const Rays& rays, int nth, int threads) {
  const fields::Occupancy& volume = item.item->volume;
  const trace::KelpSegment segment{item.segment.p0, item.segment.m0, item.segment.p1, item.segment.m1};
  std::vector<trace::KelpArc> arcs;
  std::vector<trace::KelpJoint> joints;
  trace::Context context;
  if (item.chain) {
    arcs = reference::arcsAs<trace::KelpArc>(*item.chain);
    joints = reference::jointsAs<trace::KelpJoint>(*item.chain);
    context.arcs = arcs.data();
    context.joints = joints.data();
    context.arc_count = item.chain->count;
  } else {
    context.segments = &segment;
    context.segment_count = 1;
  }
  context.bounds_min = item.bounds.min;
  context.bounds_max = item.bounds.max;
  context.size = glm::vec3(volume.size);
  context.level_size = volume.size;
  const trace::Level level = test::tracedLevel(item.item->level, volume.size);
  context.levels = &level;

  // The box itself, as a solid of few, large voxels.
  const glm::ivec3 few = (volume.size + 63) / 64;
  const std::vector<std::uint8_t> full(static_cast<std::size_t>(few.x * few.y * few.z), 1);
  const reference::Volume box{few, full, 1.0 / 64, volume.size};
  const reference::Volume solid{volume.size, volume.solid, 1.0, volume.size};

  std::vector<RayCheck> checks(rays.origin.size());
  constexpr std::size_t kChunk = 256;
  parallelFor((checks.size() + kChunk - 1) / kChunk, threads, [&](std::size_t chunk) {
    for (std::size_t i = kChunk * chunk; i < std::min(kChunk * (chunk + 1), checks.size()); ++i) {
      const glm::vec4 &o = rays.origin[i], &r = rays.direction[i];
      if (r.w < 0) continue;
      RayCheck& check = checks[i];
      const trace::KelpHit hit = trace::kelpTrace(context, glm::vec3(o), glm::vec3(r), 0.0f, o.w);
      check.cpp = {hit.found ? hit.s : -1, static_cast<float>(hit.steps), static_cast<float>(hit.fetches),
                   static_cast<float>(hit.outside)};
      const glm::dvec3 from(o), along(r);
      const double far{o.w};
      check.meets_box =
          hit.found || (item.chain ? reference::firstTouch(box, *item.chain, from, along, 0, far, 0.0)
                                   : reference::firstTouch(box, item.knots, from, along, 0, far, 0.0))
                           .has_value();
      if (nth > 0 && i % static_cast<std::size_t>(nth) == 0)
        check.truth = item.chain ? reference::truthOf(solid, *item.chain, from, along, far)
                                 : reference::truthOf(solid, item.knots, from, along, far);
    }
  });
  return checks;
}

}  // namespace kelp::bench
