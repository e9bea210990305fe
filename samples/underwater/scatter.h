// SPDX-License-Identifier: MIT
// Where plants grow, and which: the same places for the same seed, on every machine.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace underwater {

enum class Plant : std::uint8_t { kKelp, kGrass, kDulse, kCount };

struct Site {
  glm::vec2 at{0};  // x, z; meters
  Plant plant = Plant::kKelp;
  float scale = 1;    // of the model
  float yaw = 0;      // radians
  float phase = 0;    // seconds into its clips
  glm::vec3 tint{1};  // of the base color
};

// `count` sites in the disc of kReefRadius: kelp in groves, grass between them and in the glade, dulse in
// spots. Mitchell's best candidate (1991), with room for each kind: close to Poisson discs, any number, and
// the first sites stay where they are when the number grows. Time grows with the square of count: 2,000 take
// some 50 ms.
std::vector<Site> scatter(int count, std::uint32_t seed);

}  // namespace underwater
