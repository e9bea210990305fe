// SPDX-License-Identifier: MIT
// Caged items, traced on the CPU by the C++ build of the tracing core: the same calls as Gpu's.
#pragma once

#include <memory>

#include "bench_trace_check.h"
#include "bench_trace_views.h"
#include "reference/cage_trials.h"

namespace kelp::bench {

// At rest; the sheared pose of Figure 6; bent, twisted, scaled; nodes moved at random within half a cell, and
// within a whole one.
std::vector<reference::CagePose> cagedPoses(const glm::ivec3& size);

// An item in its cage in a pose, with the rays of a view.
class CagedItem {
 public:
  // The volume must outlive it.
  CagedItem(const reference::CagedVolume& volume, const reference::CagePose& pose);
  ~CagedItem();
  CagedItem(const CagedItem&) = delete;
  CagedItem& operator=(const CagedItem&) = delete;

  int inverted() const;  // tetrahedra
  Box bounds() const;
  void setView(const Rays& rays, int threads);  // which must outlive its drawing
  std::vector<RayCheck> check(int nth, int threads) const;
  std::vector<Count> count(Method method, int threads) const;
  // Milliseconds of the processor, on one thread.
  double frame(Method method) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kelp::bench
