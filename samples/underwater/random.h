// SPDX-License-Identifier: MIT
// Numbers that look random and are the same on every machine, which those of <random>'s distributions are
// not.
#pragma once

#include <cstdint>

#include <glm/glm.hpp>

namespace underwater {

class Random {
 public:
  explicit Random(std::uint32_t seed) : state_(seed) {}

  // In [0, 1).
  float next() {
    state_ = state_ * 747796405u + 2891336453u;  // O'Neill's PCG, the variant RXS M XS
    std::uint32_t word = ((state_ >> ((state_ >> 28) + 4)) ^ state_) * 277803737u;
    word ^= word >> 22;
    return static_cast<float>(word >> 8) * 0x1p-24f;
  }
  float between(float low, float high) { return low + (high - low) * next(); }

  // Uniform in the disc about the origin.
  glm::vec2 inDisc(float radius) {
    const float distance = radius * glm::sqrt(next()), angle = between(0, 6.2831853f);
    return distance * glm::vec2(glm::cos(angle), glm::sin(angle));
  }

 private:
  std::uint32_t state_;
};

}  // namespace underwater
