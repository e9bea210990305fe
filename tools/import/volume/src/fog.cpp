// SPDX-License-Identifier: MIT
#include "fog.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "kelp/common/dense_index.h"
#include "kelp/common/parallel.h"
#include "means.h"

namespace kelp::bake {
namespace {

constexpr double kCodes = 65535;

std::uint16_t codeOf(double value, double most) {
  return static_cast<std::uint16_t>(std::lround(std::clamp(value / most, 0.0, 1.0) * kCodes));
}

// The greatest mean over the lattice's voxels.
double mostOf(const VolumeGrid& grid, const Lattice& lattice, int threads) {
  const auto depth = static_cast<std::size_t>(lattice.size.z);
  std::vector<double> most(depth, 0.0);
  const VolumeMeans whole(grid, lattice.to_index, lattice.size);
  parallelRanges(depth, 1, threads, [&](std::size_t begin, std::size_t end) {
    const VolumeMeans means =
        whole;  // NOLINT(performance-unnecessary-copy-initialization): it remembers where it looked last
    for (std::size_t z = begin; z < end; ++z)
      for (int y = 0; y < lattice.size.y; ++y)
        for (int x = 0; x < lattice.size.x; ++x)
          most[z] = std::max(most[z], means.at({x, y, static_cast<int>(z)}));
  });
  return *std::max_element(most.begin(), most.end());
}

std::vector<std::uint16_t> codesOf(const VolumeGrid& grid, const glm::dmat4& to_index, const glm::ivec3& size,
                                   double most, int threads) {
  const glm::u64vec3 side(size);
  std::vector<std::uint16_t> codes(denseCount(size));
  const VolumeMeans whole(grid, to_index, size);
  parallelRanges(side.z, 1, threads, [&](std::size_t begin, std::size_t end) {
    const VolumeMeans means =
        whole;  // NOLINT(performance-unnecessary-copy-initialization): it remembers where it looked last
    for (std::size_t z = begin; z < end; ++z)
      for (std::size_t y = 0; y < side.y; ++y)
        for (std::size_t x = 0; x < side.x; ++x)
          codes[denseIndex(size, x, y, z)] = codeOf(means.at(glm::ivec3(x, y, z)), most);
  });
  return codes;
}

}  // namespace

FogBox fogBox(const VolumeGrid& grid) {
  FogBox result;
  const auto include = [&](const glm::ivec3& low, int side, double value) {
    const auto voxels = static_cast<std::uint64_t>(side) * static_cast<std::uint64_t>(side) *
                        static_cast<std::uint64_t>(side);
    if (!std::isfinite(value))
      result.not_finite += voxels;
    else if (value < 0)
      result.negative += voxels;
    if (!(amount(value) > 0)) return;
    result.voxels += static_cast<double>(voxels);
    result.most = std::max(result.most, value);
    result.box.first = glm::min(result.box.first, low);
    result.box.last = glm::max(result.box.last, low + (side - 1));
  };
  grid.tree->visit([&](const VolumeCell& cell) { include(cell.low, cell.side, cell.value.x); },
                   [&](const VolumeLeaf& leaf) {
                     for (std::size_t i = 0; i < VolumeGrid::kLeafVoxels; ++i)
                       include(leaf.voxel(i), 1, leaf.values[i]);
                   });
  result.box.low = glm::dvec3(result.box.first) - 0.5;
  result.box.high = glm::dvec3(result.box.last) + 0.5;
  return result;
}

Lattice fogLattice(const InputFiles& files, const FogBox& box, const VolumeGrid& grid,
                   const glm::dmat4& index_to_rig, const ImportSettings& settings) {
  if (keepsVoxels(grid, index_to_rig, settings)) {
    checkSides(files, glm::dvec3(box.box.last) - glm::dvec3(box.box.first) + 1.0);
    return ownLattice(box.box, index_to_rig);
  }
  if (!grid.isDense()) {
    const Lattice lattice = newLattice(files, box.box, grid, index_to_rig, settings);
    if (alongAxes(lattice.to_index) && shortestEdge(lattice.to_index) >= 1 - 1e-6) return lattice;
  }
  // Between voxels the density falls to 0 over half a voxel more. Raw volumes have that margin in any case.
  IndexBox wider = box.box;
  wider.low -= 0.5;
  wider.high += 0.5;
  return newLattice(files, wider, grid, index_to_rig, settings);
}

glm::dmat4 indexOf(const VolumeGrid& other, const VolumeGrid& grid, const Lattice& lattice) {
  return glm::inverse(other.to_world) * grid.to_world * lattice.to_index;
}

FogGrid sampleFog(const InputFiles& files, const std::string& place, const VolumeGrid& grid,
                  const FogBox& box, const Lattice& lattice, const VolumeGrid* heat, double most_heat,
                  const ImportSettings& settings) {
  const double most = lattice.exact ? box.most : mostOf(grid, lattice, settings.threads);
  const double edge = cubeEdge(grid, grid.to_world * lattice.to_index),
               extinction = most * edge * settings.density;
  FogGrid fog;
  fog.size = lattice.size;
  fog.extinction = static_cast<float>(extinction);
  if (!std::isnormal(fog.extinction))
    refuse(Exit::kInvalid, files.input(), place,
           fmt::format("has densities up to {:.4g} in voxels of {:.4g}: an optical depth of {:.4g} each, "
                       "beyond what a float holds; scale them with --density",
                       most, edge, extinction));
  fog.density = codesOf(grid, lattice.to_index, lattice.size, most, settings.threads);
  if (heat != nullptr)
    fog.heat = codesOf(*heat, indexOf(*heat, grid, lattice), lattice.size, most_heat, settings.threads);
  return fog;
}

}  // namespace kelp::bake
