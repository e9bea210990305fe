// SPDX-License-Identifier: MIT
// The foxes of bench_frame: one skinned model of the shared assets, baked as parts that run and as one that
// stands still.
#pragma once

#include <memory>

#include "bench_frame_gl.h"
#include "bench_frame_scene.h"

namespace kelp::bench {

struct Foxes {
  static constexpr std::size_t kCount = 100;

  Foxes(const RawPack& parts, const RawPack& whole) : playing(parts), still(whole) {}
  // Null, with a word on the output, where the model is absent and in a build without the baker.
  static std::unique_ptr<Foxes> bake();
  // Ten by ten side by side, seen from their left, in a view of 4 by 3.
  void place(Crowd& crowd) const;

  Library playing, still;
  int run = 0;  // the clip of `playing`
};

}  // namespace kelp::bench
