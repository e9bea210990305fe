// SPDX-License-Identifier: MIT
#include "import_voxels.h"

#include <algorithm>
#include <cmath>

#include "frame.h"
#include "kelp/fields/fields.h"
#include "parallel.h"
#include "placement.h"

namespace kelp::bake {
namespace {

// The gradient of occupancy, smoothed: what is empty around a voxel pulls its normal, the nearer the more. In whole numbers, so that equal neighbourhoods on all
// sides cancel exactly: a flat face has its own normal to the last bit, and no compiler rounds otherwise.
struct Smoothing {
  int reach;
  std::span<const int> weights;  // by squared distance; 64 times a Gaussian
};
// Built models are a few dozen voxels tall: a Gaussian of 1.2. Scanned bodies are round: one of 2. A ball of radius 30 gets normals that are off by 3.6 and 1.1 degrees in the mean.
constexpr int kDetailed[] = {0, 45, 32, 23, 16, 11, 8};
constexpr int kSmooth[] = {0, 56, 50, 44, 39, 34, 30, 27, 24, 21, 18, 16, 14, 13, 11, 10, 9, 8, 7, 6, 5};

Smoothing smoothingOf(VoxelNormals normals) { return normals == VoxelNormals::kDetailed ? Smoothing{2, kDetailed} : Smoothing{4, kSmooth}; }

bool isEmpty(const fields::Occupancy& occupancy, const glm::ivec3& at) {
  if (at.x < 0 || at.y < 0 || at.z < 0 || at.x >= occupancy.size.x || at.y >= occupancy.size.y || at.z >= occupancy.size.z) return true;
  return occupancy.solid[occupancy.index(at)] == 0;
}

glm::ivec3 pullOf(const fields::Occupancy& occupancy, const glm::ivec3& at, const Smoothing& smoothing) {
  const int reach = smoothing.reach;
  glm::ivec3 pull(0);
  for (int z = -reach; z <= reach; ++z)
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x) {
        const auto squared = static_cast<std::size_t>(x * x + y * y + z * z);
        if (squared != 0 && squared < smoothing.weights.size() && isEmpty(occupancy, at + glm::ivec3(x, y, z))) pull += smoothing.weights[squared] * glm::ivec3(x, y, z);
      }
  return pull;
}

// Where the pull vanishes, as within a wall one voxel thick, or points to where no face of the voxel is free, as at such a wall's rim: the free face that it points to most, the
// first of several: up, then sideways, then down.
glm::vec3 normalOf(const fields::Occupancy& occupancy, const glm::ivec3& at, const Smoothing& smoothing) {
  constexpr glm::ivec3 kFaces[] = {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}, {-1, 0, 0}, {0, 0, -1}, {0, -1, 0}};
  const glm::ivec3 pull = pullOf(occupancy, at, smoothing);
  const auto dot = [](const glm::ivec3& a, const glm::ivec3& b) { return std::int64_t{a.x} * b.x + std::int64_t{a.y} * b.y + std::int64_t{a.z} * b.z; };
  const glm::ivec3* free = nullptr;
  for (const glm::ivec3& face : kFaces)
    if (isEmpty(occupancy, at + face) && (!free || dot(pull, face) > dot(pull, *free))) free = &face;
  const std::int64_t squared = dot(pull, pull), towards = free ? dot(pull, *free) : 0;
  if (free && (towards <= 0 || 4 * towards * towards < squared)) return glm::vec3(*free);
  if (squared == 0) return {0, 1, 0};
  return glm::vec3(glm::dvec3(pull) / std::sqrt(static_cast<double>(squared)));
}

}  // namespace

VoxelTurn turnOf(Axis axis) {
  const glm::mat3 rotation = axisRotation(axis);
  VoxelTurn turn;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) turn[i][j] = std::lround(rotation[i][j]);
  return turn;
}

IndexedVoxels emptyVoxels(const VoxelBox& box, const VoxelTurn& to_rig, double edge, const glm::dvec3& origin) {
  IndexedVoxels voxels;
  voxels.size = glm::ivec3(box.size());
  const glm::dmat3 back = glm::transpose(glm::dmat3(to_rig)) * edge;
  voxels.to_node = glm::mat4x3(glm::dmat4x3(back[0], back[1], back[2], back * glm::dvec3(box.low) + origin));
  const auto side = glm::u64vec3(voxels.size);
  voxels.index.assign(side.x * side.y * side.z, 0);
  return voxels;
}

void VolumeMemory::add(const SourcePart& part, const VoxelPoint& size) {
  const std::int64_t longest = std::max({size.x, size.y, size.z});
  if (longest > kMaxResolution)
    refuse(Exit::kUnsupported, files_.input(), "", "spans " + std::to_string(longest) + " voxels, and a part has at most " + std::to_string(kMaxResolution) + " along a side; move its objects together");
  parts_.push_back({glm::ivec3(size), paddingOf(part, 1)});
  checkPadded(parts_.back().size + 2 * paddingOf(part, settings_.pad), settings_.pad, files_.input().filename().string() + ": part '" + part.name + "'");
  require();
}

void VolumeMemory::know(std::uint64_t surface, std::uint64_t solid) {
  parts_.back().surface = surface;
  parts_.back().solid = solid;
  require();
}

void VolumeMemory::require() const {
  const auto sizes = [&](const Settings& changed) {
    std::vector<PartSize> all;
    for (const Known& part : parts_) all.push_back(volumeSize(part.size, changed.pad * part.padded, static_cast<double>(part.surface), static_cast<double>(part.solid)));
    return all;
  };
  requireMemory(sizes, 0, settings_, 1, files_.input());  // the voxels are the file's: no resolution helps
}

VoxelGrid paintVoxels(IndexedVoxels voxels, const VoxelPaint& paint, VolumeMemory& memory, int threads) {
  fields::Occupancy occupancy{voxels.size, std::move(voxels.index)};
  const std::vector<std::uint64_t> surface = fields::surfaceVoxels(occupancy, threadCount(threads));
  const auto solid = std::count_if(occupancy.solid.begin(), occupancy.solid.end(), [](std::uint8_t index) { return index != 0; });
  memory.know(surface.size(), static_cast<std::uint64_t>(solid));
  VoxelGrid grid;
  grid.size = voxels.size;
  grid.to_node = voxels.to_node;
  grid.surface.resize(surface.size());
  const auto side = glm::u64vec3(grid.size);
  const Smoothing smoothing = smoothingOf(paint.normals);
  parallelRanges(surface.size(), 4096, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint64_t at = surface[i];
      const std::uint8_t index = occupancy.solid[at];
      grid.surface[i] = {at, normalOf(occupancy, glm::ivec3(at % side.x, at / side.x % side.y, at / (side.x * side.y)), smoothing), paint.material[index], paint.source[index]};
    }
  });
  for (std::uint8_t& voxel : occupancy.solid) voxel = voxel != 0 ? 1 : 0;
  grid.solid = std::move(occupancy.solid);
  return grid;
}

}  // namespace kelp::bake
