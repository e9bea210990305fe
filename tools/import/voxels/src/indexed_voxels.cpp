// SPDX-License-Identifier: MIT
#include "kelp/import/voxels/indexed_voxels.h"

#include <algorithm>
#include <cmath>

#include "kelp/common/dense_index.h"
#include "kelp/common/parallel.h"
#include "kelp/import/core/frame.h"
#include "kelp/import/core/padding.h"

namespace kelp::bake {
VoxelTurn turnOf(Axis axis) {
  const glm::mat3 rotation = axisRotation(axis);
  VoxelTurn turn;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) turn[i][j] = std::lround(rotation[i][j]);
  return turn;
}

IndexedVoxels emptyVoxels(const VoxelBox& box, const VoxelTurn& to_rig, double edge,
                          const glm::dvec3& origin) {
  IndexedVoxels voxels;
  voxels.size = glm::ivec3(box.size());
  const glm::dmat3 back = glm::transpose(glm::dmat3(to_rig)) * edge;
  voxels.to_node = glm::mat4x3(glm::dmat4x3(back[0], back[1], back[2], back * glm::dvec3(box.low) + origin));
  voxels.index.assign(denseCount(voxels.size), 0);
  return voxels;
}

void VolumeMemory::add(const SourcePart& part, const VoxelPoint& size) {
  const std::int64_t longest = std::max({size.x, size.y, size.z});
  if (longest > kMaxResolution)
    refuse(Exit::kUnsupported, files_.input(), "",
           "spans " + std::to_string(longest) + " voxels, and a part has at most " +
               std::to_string(kMaxResolution) + " along a side; move its objects together");
  parts_.push_back({glm::ivec3(size), paddingOf(part, 1)});
  checkPadded(parts_.back().size + 2 * paddingOf(part, settings_.pad), settings_.pad,
              files_.input().filename().string() + ": part '" + part.name + "'");
  require();
}

void VolumeMemory::know(std::uint64_t surface) {
  parts_.back().surface = surface;
  require();
}

void VolumeMemory::require() const {
  const auto sizes = [&](const ImportSettings& changed) {
    std::vector<PartSize> all;
    for (const Known& part : parts_) {
      PartSize& size = all.emplace_back();
      size.size = part.size + 2 * changed.pad * part.padded;
      size.surface_voxels = static_cast<double>(part.surface);
    }
    return all;
  };
  // the file's voxels are kept: no resolution would help
  requireMemory(sizes(settings_), sizes, 0, settings_, 1, files_.input());
}

VoxelGrid paintVoxels(IndexedVoxels voxels, const VoxelPaint& paint, VolumeMemory& memory, int threads) {
  fields::Occupancy occupancy{voxels.size, std::move(voxels.index)};
  const std::vector<std::uint64_t> surface = fields::surfaceVoxels(occupancy, threadCount(threads));
  memory.know(surface.size());
  VoxelGrid grid;
  grid.size = voxels.size;
  grid.to_node = voxels.to_node;
  grid.surface.resize(surface.size());
  const std::vector<glm::vec3> normals = smoothedNormals(occupancy, surface, paint.normals, threads);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const std::uint8_t index = occupancy.solid[surface[i]];
    grid.surface[i] = {surface[i], normals[i], paint.material[index], paint.source[index]};
  }
  for (std::uint8_t& voxel : occupancy.solid) voxel = voxel != 0 ? 1 : 0;
  grid.solid = std::move(occupancy.solid);
  return grid;
}

}  // namespace kelp::bake
