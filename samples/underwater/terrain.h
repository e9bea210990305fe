// SPDX-License-Identifier: MIT
// The place: the sand's height and triangles, the glade that the camera circles in, the swell. And random
// numbers.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace underwater {

inline constexpr float kReefRadius = 11;    // meters: plants grow within
inline constexpr float kGladeRadius = 4;    // meters: the middle, where only low plants grow
inline constexpr float kCameraRing = 3.6f;  // meters from the middle, more or less: where the camera circles
inline constexpr float kSurface = 7;        // meters: height of the water's surface

// Height of the sand at (x, z), meters: dunes, within half a meter of 0. The ripples are left to the shader.
float sandHeight(const glm::vec2& at);
// Unit, upward.
glm::vec3 sandNormal(const glm::vec2& at);

// Smooth, in [0, 1]: where the tall plants stand close.
float groveDensity(const glm::vec2& at);
// Smooth, in [0, 1]: where hardly anything grows.
float bareSand(const glm::vec2& at);

// How far the swell leans a plant at a place (x, z), in x and z, at a time: heights, at most 0.26.
glm::vec2 currentAt(const glm::vec2& at, double seconds);

// The sand as triangles: rings about the middle, closer together near it.
struct FloorMesh {
  struct Vertex {
    glm::vec3 position, normal;
  };
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;  // triangles, anticlockwise from above
};
FloorMesh makeFloorMesh(float radius, int rings, int spokes);

// Random numbers that are the same on every machine; those of <random>'s distributions are not.
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
