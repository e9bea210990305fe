// SPDX-License-Identifier: MIT
// Volumes to test kelp::fields with.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "kelp/fields/fields.h"

namespace kelp::test {

struct NamedVolume {
  std::string name;
  fields::Occupancy occupancy;
};

inline fields::Occupancy emptyVolume(const glm::ivec3& size) {
  fields::Occupancy volume;
  volume.size = size;
  volume.solid.assign(
      static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) * static_cast<std::size_t>(size.z),
      0);
  return volume;
}

inline glm::ivec3 voxelAt(std::uint64_t index, const glm::ivec3& size) {
  const auto x = static_cast<std::uint64_t>(size.x), y = static_cast<std::uint64_t>(size.y);
  return {static_cast<int>(index % x), static_cast<int>(index / x % y), static_cast<int>(index / x / y)};
}

// Solid where `inside(voxel)` is true.
template <class Inside>
fields::Occupancy volumeWhere(const glm::ivec3& size, Inside inside) {
  fields::Occupancy volume = emptyVolume(size);
  glm::ivec3 v{0};
  for (v.z = 0; v.z < size.z; ++v.z) {
    for (v.y = 0; v.y < size.y; ++v.y) {
      for (v.x = 0; v.x < size.x; ++v.x) volume.solid[volume.index(v)] = inside(v) ? 1 : 0;
    }
  }
  return volume;
}

inline fields::Occupancy randomVolume(const glm::ivec3& size, double density, std::uint32_t seed) {
  std::mt19937 random(seed);
  // mt19937's output is the same everywhere; the distributions of the standard library are not.
  return volumeWhere(size, [&](const glm::ivec3&) { return random() < density * 4294967296.0; });
}

inline std::string nameOf(const glm::ivec3& size) {
  return std::to_string(size.x) + "x" + std::to_string(size.y) + "x" + std::to_string(size.z);
}

// Small enough for brute force over all pairs: shapes that break distance transforms, and noise at several
// densities.
std::vector<NamedVolume> hardVolumes();
// Noise whose rows end before, at and after the end of a word of bits.
std::vector<NamedVolume> wideVolumes();

// Solids that cages cut into pieces, and such that they do not.
std::vector<NamedVolume> cageVolumes();

}  // namespace kelp::test
