// SPDX-License-Identifier: MIT
// What importers of files that are voxels already have in common: a colour index a voxel, kept as it is.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "import_files.h"
#include "import_voxels_normals.h"
#include "memory_estimate.h"

namespace kelp::bake {

using VoxelTurn = glm::mat<3, 3, std::int64_t>;  // permutes and flips axes
using VoxelPoint = glm::vec<3, std::int64_t>;

// The file's axes -> those of a rig along `axis`.
VoxelTurn turnOf(Axis axis);
// The voxel that a voxel becomes, when it turns about the origin with its cube.
inline VoxelPoint turned(const VoxelTurn& turn, const VoxelPoint& voxel) { return (turn * (voxel * std::int64_t{2} + VoxelPoint(1)) - VoxelPoint(1)) / std::int64_t{2}; }

// From the first to the last voxel, both of them inside.
struct VoxelBox {
  VoxelPoint low{std::numeric_limits<std::int64_t>::max()}, high{std::numeric_limits<std::int64_t>::min()};

  void add(const VoxelPoint& voxel) {
    low = glm::min(low, voxel);
    high = glm::max(high, voxel);
  }
  bool empty() const { return low.x > high.x; }
  VoxelPoint size() const { return high - low + VoxelPoint(1); }
};

// What is solid and has no colour: a light grey.
inline const Material kUnpainted{glm::vec4(0.6f, 0.6f, 0.6f, 1), glm::vec3(0), 0, 1};

// A box of voxels in the axes of a part's rig.
struct IndexedVoxels {
  glm::ivec3 size{0};
  glm::mat4x3 to_node{1};           // voxels -> the node's space
  std::vector<std::uint8_t> index;  // dense, x fastest, then y, then z; 0: nothing
};

// The voxels of `box`, in the axes of the rig, all of them empty. In the file's axes voxels have edges of this length, and the lattice's origin is there.
IndexedVoxels emptyVoxels(const VoxelBox& box, const VoxelTurn& to_rig, double edge, const glm::dvec3& origin = glm::dvec3(0));

// What the voxels of a grid look like.
struct VoxelPaint {
  VoxelNormals normals = VoxelNormals::kDetailed;
  // By the voxels' index.
  std::array<Material, 256> material;
  std::array<std::uint32_t, 256> source{};  // see SurfaceSample
};

// The memory that the parts of a volume file take, asked for before it is taken: BakeError kRuntime where it is too much, kUnsupported where a side is too long.
class VolumeMemory {
 public:
  VolumeMemory(const InputFiles& files, const Settings& settings) : files_(files), settings_(settings) {}
  // The next part, of which the box alone is known so far; its sides may be far too large.
  void add(const SourcePart& part, const VoxelPoint& size);
  // The voxels of the part that was added last.
  void know(std::uint64_t surface, std::uint64_t solid);

 private:
  struct Known {
    glm::ivec3 size{0}, padded{0};  // padded: 1 along the axes that padding makes longer
    std::uint64_t surface = 0, solid = 0;
  };
  void require() const;

  const InputFiles& files_;
  const Settings& settings_;
  std::vector<Known> parts_;
};

// Of the part that `memory` was told of last: solid where the index is not 0; the voxels' normals are smoothedNormals. Uses `voxels` up. The same on any number of threads.
VoxelGrid paintVoxels(IndexedVoxels voxels, const VoxelPaint& paint, VolumeMemory& memory, int threads);

}  // namespace kelp::bake
