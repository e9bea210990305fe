// SPDX-License-Identifier: MIT
// A framebuffer of integers that programs count into, one ray for each pixel, and the sum of what they
// counted.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

namespace kelp::render {

// Rays that met the box of a part, and the steps that they took. A ray counts once for each part.
struct StepCount {
  std::uint64_t rays = 0, steps = 0;

  StepCount& operator+=(const StepCount& other) {
    rays += other.rays;
    steps += other.steps;
    return *this;
  }
};

class CountTarget {
 public:
  explicit CountTarget(glm::ivec2 size);
  ~CountTarget();
  CountTarget(const CountTarget&) = delete;
  CountTarget& operator=(const CountTarget&) = delete;

  glm::ivec2 size() const { return size_; }
  // Bound from here on, viewport set, depth test off.
  void bind() const;
  // Sets all counts to 0.
  void clear() const;
  // The sum over the pixels that a rectangle of clip space covers. Programs write steps to red, rays to
  // green.
  StepCount read(const glm::vec4& rectangle);

 private:
  glm::ivec2 size_;
  unsigned framebuffer_ = 0;
  unsigned buffer_ = 0;
  std::vector<std::uint32_t> pixels_;
};

}  // namespace kelp::render
