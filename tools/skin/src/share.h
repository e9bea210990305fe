// SPDX-License-Identifier: MIT
// How neighboring parts move apart along their seam, and which part has which voxels.
#pragma once

#include <cstdint>
#include <vector>

#include "decompose.h"
#include "tree.h"

namespace kelp::bake {

class MeshSurface;

// How two neighboring parts move apart along their seam. All in voxels of the whole.
struct SeamSteps {
  struct Place {
    glm::dvec3 at{0};
    glm::dvec3 across{0};      // from a to b along the surface; of unit length, or zero
    std::uint32_t motion = 0;  // which of `steps` and `back_steps`
  };
  std::uint32_t a = 0, b = 0;  // parts, a < b
  std::vector<Place> places;
  // The motion of a, seen from b, at each moment; and the other way round. Along a swept part there are
  // several.
  std::vector<std::vector<glm::dmat4x3>> steps, back_steps;

  const Place& nearest(const glm::dvec3& at) const;
  // How far the two parts move apart at such a point near `place`, at the worst moment.
  double opening(const Place& place, const glm::dvec3& at) const;
};

// Of all seams.
std::vector<SeamSteps> stepsAtSeams(const SkinSamples& samples, const SkinMoments& moments,
                                    const SkinSpace& space, const SkinLabels& labels, const PartTree& tree);

// The part of each voxel.
struct VoxelOwners {
  static constexpr std::uint16_t kEmpty = 0xffff;
  std::vector<std::uint16_t> owner;    // dense; kEmpty where nothing is solid
  std::vector<std::uint32_t> surface;  // dense: the surface sample of the nearest surface voxel
  std::vector<std::uint64_t> counts;   // voxels of each part
};

// Each surface voxel belongs to the nearest sample's part, each other solid voxel to that of the nearest
// surface voxel.
VoxelOwners shareVoxels(const SkinSamples& samples, const SkinSpace& space, const SkinLabels& labels,
                        const VoxelGrid& whole, int threads);

// Parts of fewer than `least` voxels go to the part with which they share the longest seam, or to that of a
// joint above. True if there were some; then the voxels must be shared again.
bool joinSmallParts(const SkinSamples& samples, const SourceSkin& skin,
                    const std::vector<std::uint64_t>& counts, std::uint64_t least, SkinLabels& labels);

// The voxels of each part, with those that it shares: as many as close what opens at its seams. A rigid part
// gets a box of the whole grid. A swept part gets its voxels straightened; `surface` says how they look, and
// is null if no part is swept. A part does not share a voxel that would stand out of its neighbor's surface
// at one of the moments, farther than the part itself does there.
std::vector<VoxelGrid> cutGrids(const SkinSpace& space, const PartTree& tree,
                                const std::vector<SeamSteps>& seams, const VoxelOwners& owners,
                                const VoxelGrid& whole, const MeshSurface* surface, int threads);

}  // namespace kelp::bake
