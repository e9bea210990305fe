// SPDX-License-Identifier: MIT
// Voxels with a color index each, kept as they are: shared by the importers of voxel files.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "kelp/fields/fields.h"
#include "kelp/import/core/import_settings.h"
#include "kelp/import/core/input_files.h"
#include "kelp/import/core/memory_estimate.h"
#include "kelp/import/core/source_model.h"

namespace kelp::bake {

using VoxelTurn = glm::mat<3, 3, std::int64_t>;  // permutes and flips axes
using VoxelPoint = glm::vec<3, std::int64_t>;

// The file's axes -> the axes of a rig along `axis`.
VoxelTurn turnOf(Axis axis);
// The place of a voxel after its cube has turned about the origin.
inline VoxelPoint turned(const VoxelTurn& turn, const VoxelPoint& voxel) {
  return (turn * (voxel * std::int64_t{2} + VoxelPoint(1)) - VoxelPoint(1)) / std::int64_t{2};
}

// From the first to the last voxel, both inclusive.
struct VoxelBox {
  VoxelPoint low{std::numeric_limits<std::int64_t>::max()}, high{std::numeric_limits<std::int64_t>::min()};

  void add(const VoxelPoint& voxel) {
    low = glm::min(low, voxel);
    high = glm::max(high, voxel);
  }
  bool empty() const { return low.x > high.x; }
  VoxelPoint size() const { return high - low + VoxelPoint(1); }
};

// The material of solid voxels without a color: a light gray.
inline const Material kUnpainted{glm::vec4(0.6f, 0.6f, 0.6f, 1), glm::vec3(0), 0, 1};

// A box of voxels in the axes of a part's rig.
struct IndexedVoxels {
  glm::ivec3 size{0};
  glm::mat4x3 to_node{1};           // voxels -> the node's space
  std::vector<std::uint8_t> index;  // dense, x fastest, then y, then z; 0: nothing
};

// The voxels of `box` in the axes of the rig, all empty. In the file's axes, `edge` is the length of a voxel
// and `origin` is where voxel 0 begins.
IndexedVoxels emptyVoxels(const VoxelBox& box, const VoxelTurn& to_rig, double edge,
                          const glm::dvec3& origin = glm::dvec3(0));

// kDetailed: for models built of cubes; kSmooth: for scans
enum class VoxelNormals : std::uint8_t { kDetailed, kSmooth };

// The outward unit normals of these voxels, all of which are solid. The same on any number of threads. Takes
// one more byte for each voxel of the volume.
std::vector<glm::vec3> smoothedNormals(const fields::Occupancy& occupancy,
                                       std::span<const std::uint64_t> voxels, VoxelNormals kind, int threads);

// 1 where a voxel is solid, or empty and enclosed: no path over faces of empty voxels leads out of the
// volume.
std::vector<std::uint8_t> withoutCavities(const fields::Occupancy& occupancy);

// The materials of a grid's voxels.
struct VoxelPaint {
  VoxelNormals normals = VoxelNormals::kDetailed;
  // By the voxels' index.
  std::array<Material, 256> material;
  std::array<std::uint32_t, 256> source{};  // see SurfaceSample
};

// Checks the memory for the parts of a voxel file before it is taken: ToolError kRuntime if it is too much,
// kUnsupported if a side is too long.
class VolumeMemory {
 public:
  VolumeMemory(const InputFiles& files, const ImportSettings& settings)
      : files_(files), settings_(settings) {}
  // Adds a part of which only the box is known; its sides may be far too large.
  void add(const SourcePart& part, const VoxelPoint& size);
  // Sets the number of surface voxels of the part that was added last.
  void know(std::uint64_t surface);

 private:
  struct Known {
    glm::ivec3 size{0}, padded{0};  // padded: 1 along the axes that get padding
    std::uint64_t surface = 0;
  };
  void require() const;

  const InputFiles& files_;
  const ImportSettings& settings_;
  std::vector<Known> parts_;
};

// The grid of the part that was added to `memory` last: solid where the index is not 0, with smoothedNormals.
// Consumes `voxels`. The same on any number of threads.
VoxelGrid paintVoxels(IndexedVoxels voxels, const VoxelPaint& paint, VolumeMemory& memory, int threads);

}  // namespace kelp::bake
