// SPDX-License-Identifier: MIT
#include "current.h"

#include <cmath>

namespace underwater {

glm::vec2 currentAt(const glm::vec2& at, double seconds) {
  const auto wave = [&](float x, float z, double period) {
    return static_cast<float>(std::sin(6.283185307 * (seconds / period - (x * at.x + z * at.y))));
  };
  const float surge = 0.07f + 0.10f * wave(0.045f, 0.02f, 7.0) + 0.035f * wave(-0.06f, 0.11f, 3.1);
  return {surge, 0.35f * surge + 0.04f * wave(0.09f, -0.05f, 4.3)};
}

}  // namespace underwater
