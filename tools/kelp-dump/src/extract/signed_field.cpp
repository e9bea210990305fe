// SPDX-License-Identifier: MIT
// Each surface voxel has a normal, and its neighbors bound the distance of the surface from its center.
// Together they give a plane. The field is the mean of the planes near by. Then the values beside surface
// voxels are changed until the differences along the axes agree with the normals (Kaczmarz 1937: the
// equations of one voxel after the other, each by the least change). No value crosses zero.
#include "extract/signed_field.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "text/checks.h"
#include "text/text.h"

namespace kelp::dump {
namespace {

constexpr int kReach = static_cast<int>(SignedField::kHalfWidth);
constexpr float kNearest = 1.0f / 128;  // to zero that a voxel's center may come
constexpr int kRounds = 32;

// For voxels from -8 on.
glm::ivec3 floorBrick(const glm::ivec3& voxel) { return (voxel + kBrickSide) / kBrickSide - 1; }

// The distance of a surface voxel's center from the surface: the middle of the range that its neighbors
// allow.
float depthOf(const LevelVoxels& level, const glm::ivec3& voxel, const glm::vec3& normal) {
  float low = -2, high = 0;
  for (int z = -1; z <= 1; ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x) {
        const float away = glm::dot(normal, glm::vec3(x, y, z));  // its distance is the voxel's and this
        if (level.solid(voxel + glm::ivec3(x, y, z)))
          high = std::min(high, -away);
        else
          low = std::max(low, -away);
      }
  return std::clamp(0.5f * (low + high), -1.75f, -kNearest);
}

}  // namespace

SignedField::SignedField(const LevelVoxels& level) : level_(level) {
  std::vector<Sample> samples;
  samples.reserve(level.surfaceVoxels());
  level.eachSurface([&](const glm::ivec3& voxel, std::uint32_t attribute) {
    const glm::vec3 normal = decodeNormal(attributeNormal(attribute));
    samples.push_back({voxel, normal, depthOf(level, voxel, normal)});
  });
  makeBricks(samples);
  spread(samples);
  keepSides();
  for (int round = 0; round < kRounds; ++round) followNormals(samples);
}

// Finds all bricks that the samples reach, so that the memory is known before it is allocated.
void SignedField::makeBricks(const std::vector<Sample>& samples) {
  for (const Sample& sample : samples) {
    const glm::ivec3 from = floorBrick(sample.voxel - kReach), to = floorBrick(sample.voxel + kReach);
    for (int z = from.z; z <= to.z; ++z)
      for (int y = from.y; y <= to.y; ++y)
        for (int x = from.x; x <= to.x; ++x)
          if (index_.try_emplace(keyOf({x, y, z}), static_cast<std::uint32_t>(places_.size())).second)
            places_.push_back({x, y, z});
  }
  // The values, the weights, and the grid that is made of them.
  const std::uint64_t needed = std::uint64_t{places_.size()} * kBrickVoxels * 3 * sizeof(float);
  requireMemory(needed, fmt::format("distances around {} surface voxels", countText(samples.size())),
                "extract a coarser --level, or one --part");
  values_.assign(places_.size() * kBrickVoxels, 0.0f);
}

float& SignedField::at(const glm::ivec3& voxel) {
  return values_[std::size_t{index_.find(keyOf(floorBrick(voxel)))->second} * kBrickVoxels +
                 static_cast<std::size_t>(codeIndex(voxel))];
}

void SignedField::spread(const std::vector<Sample>& samples) {
  std::vector<float> weights(values_.size(), 0.0f);
  for (const Sample& sample : samples) {
    const glm::ivec3 first = sample.voxel - kReach, last = sample.voxel + kReach, from = floorBrick(first),
                     to = floorBrick(last);
    for (int bz = from.z; bz <= to.z; ++bz)
      for (int by = from.y; by <= to.y; ++by)
        for (int bx = from.x; bx <= to.x; ++bx) {
          const std::size_t base = std::size_t{index_.find(keyOf({bx, by, bz}))->second} * kBrickVoxels;
          const glm::ivec3 low = glm::max(first, glm::ivec3(bx, by, bz) * kBrickSide),
                           high = glm::min(last, glm::ivec3(bx, by, bz) * kBrickSide + (kBrickSide - 1));
          for (int z = low.z; z <= high.z; ++z)
            for (int y = low.y; y <= high.y; ++y)
              for (int x = low.x; x <= high.x; ++x) {
                const glm::vec3 away(glm::ivec3(x, y, z) - sample.voxel);
                const float near = 1 / (0.5f + glm::dot(away, away)), weight = near * near * near;
                const std::size_t i = base + static_cast<std::size_t>(codeIndex({x, y, z}));
                values_[i] += weight * (sample.value + glm::dot(sample.normal, away));
                weights[i] += weight;
              }
        }
  }
  for (std::size_t i = 0; i < values_.size(); ++i)
    values_[i] = weights[i] > 0 ? values_[i] / weights[i] : kHalfWidth;
}

// Gives every value the sign of its voxel. Values that no sample reached become kHalfWidth with that sign.
void SignedField::keepSides() {
  for (std::size_t brick = 0; brick < places_.size(); ++brick)
    for (int i = 0; i < kBrickVoxels; ++i) {
      float& value = values_[brick * kBrickVoxels + static_cast<std::size_t>(i)];
      const bool solid = level_.solid(places_[brick] * kBrickSide + glm::ivec3(i & 7, (i >> 3) & 7, i >> 6));
      if (solid)
        value = value == kHalfWidth ? -kHalfWidth : std::clamp(value, -kHalfWidth, -kNearest);
      else
        value = std::clamp(value, kNearest, kHalfWidth);
    }
}

void SignedField::followNormals(const std::vector<Sample>& samples) {
  for (const Sample& sample : samples) {
    float* beside[3][2];
    glm::vec3 gradient;
    for (int axis = 0; axis < 3; ++axis) {
      glm::ivec3 step(0);
      step[axis] = 1;
      beside[axis][0] = &at(sample.voxel - step);
      beside[axis][1] = &at(sample.voxel + step);
      gradient[axis] = 0.5f * (*beside[axis][1] - *beside[axis][0]);
    }
    const glm::vec3 missing = std::max(glm::dot(gradient, sample.normal), 0.25f) * sample.normal - gradient;
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) {
        float& value = *beside[axis][side];
        const float moved = value + (side == 1 ? missing[axis] : -missing[axis]);
        value =
            value > 0 ? std::clamp(moved, kNearest, kHalfWidth) : std::clamp(moved, -kHalfWidth, -kNearest);
      }
  }
}

}  // namespace kelp::dump
