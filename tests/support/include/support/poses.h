// SPDX-License-Identifier: MIT
// The poses of the paper's Figure 6, and shapes to pose.
#pragma once

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include <glm/glm.hpp>

#include "kelp/fields/fields.h"
#include "kelp/formats/spline.h"

namespace kelp::test {

// Tangents of the two ends, in units of the volume's height. Figure 6: (a) none, (b) three, (c) three.
struct FigurePose {
  const char* name;
  glm::vec3 first, second;
};
inline constexpr std::array<FigurePose, 7> kFigure6{{
    {"rest", {0, 1, 0}, {0, 1, 0}},
    {"(3,0,1)(3,0,2)", {3, 0, 1}, {3, 0, 2}},
    {"(-2,0,0)(2,0,3)", {-2, 0, 0}, {2, 0, 3}},
    {"(0,0,3)(-3,0,4)", {0, 0, 3}, {-3, 0, 4}},
    {"(13,0,7)(14,0,-4)", {13, 0, 7}, {14, 0, -4}},
    {"(-40,0,0)(20,0,-13)", {-40, 0, 0}, {20, 0, -13}},
    {"(0,0,-3)(-54,0,-10)", {0, 0, -3}, {-54, 0, -10}},
}};

inline std::vector<Knot> figureKnots(const FigurePose& pose) {
  return {{0, glm::vec3(0), pose.first}, {1, glm::vec3(0, 1, 0), pose.second}};
}

// Solid where `solid(voxel)`.
template <class Solid>
fields::Occupancy voxelsWhere(const glm::ivec3& size, Solid&& solid) {
  fields::Occupancy volume{
      size, std::vector<std::uint8_t>(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
                                      static_cast<std::size_t>(size.z))};
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) volume.solid[volume.index({x, y, z})] = solid(glm::ivec3(x, y, z));
  return volume;
}

// A clump of balls: smooth, with gaps and thin necks. Never empty.
inline fields::Occupancy ballClump(const glm::ivec3& size, int balls, unsigned seed) {
  fields::Occupancy volume{
      size, std::vector<std::uint8_t>(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
                                      static_cast<std::size_t>(size.z))};
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  for (int i = 0; i < balls; ++i) {
    glm::vec3 center;
    // in this order, whatever the compiler
    for (const int axis : {2, 1, 0}) center[axis] = static_cast<float>(size[axis]) * unit(random);
    const float radius =
        (0.04f + 0.14f * unit(random)) * static_cast<float>(std::min({size.x, size.y, size.z}));
    const glm::ivec3 low = glm::max(glm::ivec3(center - radius), glm::ivec3(0));
    const glm::ivec3 high = glm::min(glm::ivec3(center + radius), size - 1);
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x)
          if (glm::distance(glm::vec3(x, y, z) + 0.5f, center) <= radius)
            volume.solid[volume.index({x, y, z})] = 1;
  }
  volume.solid[volume.index(size / 2)] = 1;
  return volume;
}

// Single voxels, one in `one_in`: what a step that is too long skips first.
inline fields::Occupancy dust(const glm::ivec3& size, unsigned one_in, unsigned seed) {
  fields::Occupancy volume{
      size, std::vector<std::uint8_t>(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
                                      static_cast<std::size_t>(size.z))};
  std::mt19937 random(seed);
  for (auto& voxel : volume.solid) voxel = random() % one_in == 0;
  volume.solid[volume.index(size / 2)] = 1;
  return volume;
}

// One-voxel plates and rods, in every direction, also on the faces of the box.
inline fields::Occupancy platesAndRods(const glm::ivec3& size) {
  return voxelsWhere(size, [&](const glm::ivec3& v) {
    const bool plate = (v.x == size.x / 3 && v.y % 7 < 4) || (v.y == size.y - 1 && v.x % 5 == 0) ||
                       (v.z == size.z / 2 && v.x > size.x / 2);
    const bool rod = (v.x % 11 == 0 && v.y % 13 == 0) || (v.y % 17 == 3 && v.z % 9 == 0) ||
                     (v.x % 19 == 5 && v.z % 15 == 0);
    return plate || rod;
  });
}

// The surface voxels of a volume with one palette entry and one normal: enough to trace.
inline std::vector<fields::SurfaceVoxel> plainSurface(const fields::Occupancy& volume) {
  std::vector<fields::SurfaceVoxel> surface;
  for (const std::uint64_t index : fields::surfaceVoxels(volume, 1))
    surface.push_back({index, makeAttribute(0, encodeNormal({0, 1, 0}))});
  return surface;
}

}  // namespace kelp::test
