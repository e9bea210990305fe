// SPDX-License-Identifier: MIT
// The transfer function of sRGB (IEC 61966-2-1).
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>

namespace kelp {

// 0..1 to 0..1.
inline float srgbToLinear(float value) {
  return value <= 0.04045f ? value / 12.92f : std::pow((value + 0.055f) / 1.055f, 2.4f);
}

// 0..1 to 0..1, computed in the type of the argument.
template <std::floating_point T>
T linearToSrgb(T value) {
  return value <= T(0.0031308) ? T(12.92) * value : T(1.055) * std::pow(value, 1 / T(2.4)) - T(0.055);
}

// Clamps to 0..1 and rounds to 0..255.
inline std::uint8_t linearToSrgb8(double value) {
  return static_cast<std::uint8_t>(std::lround(255 * linearToSrgb(std::clamp(value, 0.0, 1.0))));
}

}  // namespace kelp
