// SPDX-License-Identifier: MIT
#include "share.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kelp/common/dense_index.h"
#include "kelp/common/parallel.h"
#include "kelp/fields/fields.h"
#include "kelp/voxelize/surface/triangle_bvh.h"

namespace kelp::bake {
namespace {

// The refined triangles as a mesh whose nearest points can be asked for.
Topology meshOf(const SkinSamples& samples, const SkinSpace& space) {
  Topology mesh;
  for (const glm::dvec3& at : samples.positions)
    mesh.lattice.emplace_back(glm::round(at * (space.voxels / kLatticeStep)));
  for (const auto& corners : samples.triangles) {
    SolidTriangle& triangle = mesh.triangles.emplace_back();
    triangle.vertex = corners;
  }
  return mesh;
}

}  // namespace

VoxelOwners shareVoxels(const SkinSamples& samples, const SkinSpace& space, const SkinLabels& labels,
                        const VoxelGrid& whole, int threads) {
  const Topology mesh = meshOf(samples, space);
  const TriangleBvh bvh(mesh);
  std::vector<std::uint16_t> of_surface(whole.surface.size());
  parallelRanges(whole.surface.size(), 256, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const glm::dvec3 centre = glm::dvec3(voxelAt(whole.size, whole.surface[i].index)) + 0.5;
      const Nearest nearest = bvh.nearest(centre);
      std::size_t corner = 0;
      for (std::size_t c = 1; c < 3; ++c)
        if (nearest.weights[static_cast<int>(c)] > nearest.weights[static_cast<int>(corner)]) corner = c;
      of_surface[i] =
          static_cast<std::uint16_t>(labels.parts[mesh.triangles[nearest.triangle].vertex[corner]]);
    }
  });
  VoxelOwners out;
  {
    std::vector<std::uint8_t> is_surface(whole.solid.size(), 0);
    for (const SurfaceSample& sample : whole.surface) is_surface[sample.index] = 1;
    out.surface = fields::nearestSet(is_surface, whole.size, threads);
  }
  // From a surface voxel's place to its number.
  const auto numberOf = [&](std::uint32_t index) {
    const auto at = std::lower_bound(
        whole.surface.begin(), whole.surface.end(), index,
        [](const SurfaceSample& sample, std::uint32_t wanted) { return sample.index < wanted; });
    return static_cast<std::uint32_t>(at - whole.surface.begin());
  };
  out.owner.assign(whole.solid.size(), VoxelOwners::kEmpty);
  parallelRanges(whole.solid.size(), 1 << 16, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (!whole.solid[i]) continue;
      out.surface[i] = numberOf(out.surface[i]);
      out.owner[i] = of_surface[out.surface[i]];
    }
  });
  out.counts.assign(labels.joints.size(), 0);
  for (const std::uint16_t part : out.owner)
    if (part != VoxelOwners::kEmpty) ++out.counts[part];
  return out;
}

bool joinSmallParts(const SkinSamples& samples, const SourceSkin& skin,
                    const std::vector<std::uint64_t>& counts, std::uint64_t least, SkinLabels& labels) {
  const std::size_t parts = counts.size();
  const std::vector<Seam> seams = findSeams(samples, labels);
  // The part that each part becomes; a part that stays is itself.
  std::vector<std::uint32_t> into(parts);
  const std::uint64_t largest = *std::max_element(counts.begin(), counts.end());
  bool joined = false;
  for (std::uint32_t p = 0; p < parts; ++p) {
    into[p] = p;
    if (counts[p] >= least || counts[p] == largest) continue;
    const auto isGood = [&](std::uint32_t other) { return other != p && counts[other] >= least; };
    double longest = 0;
    for (const Seam& seam : seams) {
      if (seam.a != p && seam.b != p) continue;
      const std::uint32_t other = seam.a == p ? seam.b : seam.a;
      if (!isGood(other) || seam.length <= longest) continue;
      longest = seam.length;
      into[p] = other;
    }
    for (int above = static_cast<int>(labels.joints[p]); above >= 0 && into[p] == p;
         above = skin.joints[static_cast<std::size_t>(above)].parent)
      for (std::uint32_t other = 0; other < parts && into[p] == p; ++other)
        if (labels.joints[other] == static_cast<std::uint32_t>(above) && isGood(other)) into[p] = other;
    if (into[p] == p)
      into[p] = static_cast<std::uint32_t>(std::max_element(counts.begin(), counts.end()) - counts.begin());
    joined = true;
  }
  if (!joined) return false;
  std::vector<std::uint32_t> place(parts, 0), joints;
  std::vector<SkinChain> chains;
  for (std::uint32_t p = 0; p < parts; ++p) {
    if (into[p] != p) continue;
    place[p] = static_cast<std::uint32_t>(joints.size());
    joints.push_back(labels.joints[p]);
    chains.push_back(std::move(labels.chains[p]));
  }
  for (std::uint32_t& part : labels.parts) part = place[into[part]];
  labels.joints = std::move(joints);
  labels.chains = std::move(chains);
  return true;
}

}  // namespace kelp::bake
