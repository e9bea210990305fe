// SPDX-License-Identifier: MIT
// Draws a view of a posed scene with one of the methods, counts, and takes the time. One object at a time: it
// makes the GL context.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "bench_trace_views.h"

namespace kelp::bench {

// kWalk: of caged parts; kUncaged: these at rest, without their cage.
enum class Method { kStandard, kStandardArcsine, kStandardSlices, kDf, kDfWorld, kKelp, kWalk, kUncaged };
inline constexpr std::array<Method, 8> kMethods{Method::kStandard,       Method::kStandardArcsine,
                                                Method::kStandardSlices, Method::kDf,
                                                Method::kDfWorld,        Method::kKelp,
                                                Method::kWalk,           Method::kUncaged};
const char* toString(Method method);
// True if the method draws parts that bend so.
inline bool draws(Method method, Bend bend, bool caged) {
  if (method == Method::kStandard || method == Method::kKelp) return true;
  if (caged || method == Method::kWalk || method == Method::kUncaged)
    return caged && (method == Method::kWalk || method == Method::kUncaged);
  return (bend == Bend::kSweep) == (method == Method::kStandardSlices);
}

// The counts of one ray; all zero and s = -1 where the ray misses the bounds.
struct Count {
  float s = -1;  // of the hit, or -1
  float steps = 0;
  float fetches = 0;
  float outside = 0;
};

class Gpu {
 public:
  // Throws std::runtime_error where there is no OpenGL 3.3.
  explicit Gpu(const glm::ivec2& size);
  ~Gpu();
  Gpu(const Gpu&) = delete;
  Gpu& operator=(const Gpu&) = delete;

  std::string renderer() const;
  void setScene(const Scene& scene);  // which must outlive its drawing
  void setView(const std::vector<PosedItem>& items, const View& view);

  // The rays of one item alone.
  std::vector<Count> count(Method method, std::size_t item);
  // Milliseconds of one whole frame of all items with depth test.
  double frame(Method method);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kelp::bench
