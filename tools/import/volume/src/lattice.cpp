// SPDX-License-Identifier: MIT
#include "lattice.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "grid_choice.h"
#include "kelp/import/core/frame.h"

namespace kelp::bake {
namespace {

// True if a matrix permutes and flips the axes, up to rounding.
bool isSignedPermutation(const glm::dmat3& m) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (const double a = std::abs(m[i][j]); a > 1e-6 && std::abs(a - 1) > 1e-6) return false;
  return std::abs(std::abs(glm::determinant(m)) - 1) < 1e-5;
}

}  // namespace

double shortestEdge(const glm::dmat4& to_world) {
  return std::min({glm::length(glm::dvec3(to_world[0])), glm::length(glm::dvec3(to_world[1])),
                   glm::length(glm::dvec3(to_world[2]))});
}

double voxelEdge(const glm::dmat4& to_world) {
  return std::cbrt(std::abs(glm::determinant(glm::dmat3(to_world))));
}

double cubeEdge(const VolumeGrid& grid, const glm::dmat4& to_world) {
  return grid.isDense() ? shortestEdge(to_world) : voxelEdge(to_world);
}

bool keepsVoxels(const VolumeGrid& grid, const glm::dmat4& index_to_rig, const ImportSettings& settings) {
  return (grid.as_asked || (!settings.voxel_size && !settings.resolution_given)) &&
         isSignedPermutation(glm::dmat3(index_to_rig) / voxelEdge(index_to_rig));
}

Lattice ownLattice(const IndexBox& box, const glm::dmat4& index_to_rig) {
  const glm::dmat3 turn = glm::dmat3(index_to_rig) / voxelEdge(index_to_rig);
  glm::dmat3 rounded;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) rounded[i][j] = std::round(turn[i][j]);
  const glm::dvec3 a = rounded * (glm::dvec3(box.first) - 0.5), b = rounded * (glm::dvec3(box.last) + 0.5);
  const glm::dvec3 low = glm::min(a, b), high = glm::max(a, b);
  Lattice lattice;
  lattice.size = glm::ivec3(glm::round(high - low));
  lattice.exact = true;
  const glm::dmat3 back = glm::transpose(rounded);
  lattice.to_index = glm::dmat4(back);
  lattice.to_index[3] = glm::dvec4(back * low, 1);
  return lattice;
}

Lattice newLattice(const InputFiles& files, const IndexBox& box, const VolumeGrid& grid,
                   const glm::dmat4& index_to_rig, const ImportSettings& settings) {
  glm::dvec3 low(INFINITY), high(-INFINITY);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 at(corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y,
                        corner & 4 ? box.high.z : box.low.z);
    const glm::dvec3 rig = glm::dvec3(index_to_rig * glm::dvec4(at, 1));
    low = glm::min(low, rig);
    high = glm::max(high, rig);
  }
  const glm::dvec3 extent = high - low;
  const double longest = std::max({extent.x, extent.y, extent.z});
  const double step = settings.voxel_size         ? *settings.voxel_size
                      : settings.resolution_given ? longest / settings.resolution
                                                  : cubeEdge(grid, index_to_rig);
  if (!(step > 0) || !std::isfinite(longest / step))
    refuse(Exit::kInvalid, files.input(), "",
           "has no extent; choose another --isovalue, or give the edge of a voxel with --voxel-size");
  if (longest / step > kMaxResolution + 0.5)
    refuse(
        settings.voxel_size || settings.resolution_given ? Exit::kUsage : Exit::kUnsupported, files.input(),
        "",
        fmt::format("makes more than {0} voxels along a side; give a --resolution of at most {0}, or larger "
                    "voxels (--voxel-size)",
                    kMaxResolution));
  Lattice lattice;
  lattice.size = glm::max(glm::ivec3(glm::ceil(extent / step - 1e-4)), glm::ivec3(1));
  const glm::dvec3 margin = (glm::dvec3(lattice.size) * step - extent) * 0.5;
  glm::dmat4 to_rig(step);
  to_rig[3] = glm::dvec4(low - margin, 1);
  lattice.to_index = glm::inverse(index_to_rig) * to_rig;
  return lattice;
}

void checkSides(const InputFiles& files, const glm::dvec3& size) {
  if (std::max({size.x, size.y, size.z}) > kMaxResolution)
    refuse(Exit::kUnsupported, files.input(), "",
           fmt::format("has more than {0} voxels along a side ({1:.0f} x {2:.0f} x {3:.0f}); give a "
                       "--resolution of at most {0}",
                       kMaxResolution, size.x, size.y, size.z));
}

void checkTransform(const InputFiles& files, const GridHeader& grid) {
  bool finite = true;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      finite =
          finite && std::isfinite(grid.to_world[i][j]) && (j < 3 || grid.to_world[i][j] == (i < 3 ? 0 : 1));
  const double edge = voxelEdge(grid.to_world);
  if (!finite || !std::isfinite(edge) || !(edge > 0))
    refuse(Exit::kInvalid, files.input(), gridPlace(grid),
           "has a transform that flattens it or is not finite; export the volume again");
  // Edges of a voxel against each other: beyond it, sampling one finds nothing of the other.
  const glm::dmat3 linear(grid.to_world);
  const double longest = std::max({glm::length(linear[0]), glm::length(linear[1]), glm::length(linear[2])});
  if (!(longest < 1e6 * edge))
    refuse(Exit::kInvalid, files.input(), gridPlace(grid),
           "has a transform that flattens it; export the volume again");
  if (edge < kSmallestVoxel || edge > kLargestVoxel)
    refuse(
        Exit::kInvalid, files.input(), gridPlace(grid),
        fmt::format(
            "has voxels of {:.4g} units, beyond what 32-bit floats can draw ({:g} to {:g}); scale the volume",
            edge, kSmallestVoxel, kLargestVoxel));
}

double VolumeSampler::between(const glm::dvec3& point) const {
  if (!onLattice(point)) return grid_->background;
  // On a voxel's center, up to rounding: its own value, so that one equal to the isovalue stays so.
  const glm::dvec3 nearest = glm::round(point);
  const glm::dvec3 place =
      glm::mix(point, nearest, glm::lessThan(glm::abs(point - nearest), glm::dvec3(1e-6)));
  const glm::dvec3 floor = glm::floor(place), f = place - floor;
  const glm::ivec3 low(floor);
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 step(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
    const double weight = (step.x ? f.x : 1 - f.x) * (step.y ? f.y : 1 - f.y) * (step.z ? f.z : 1 - f.z);
    if (weight > 0) sum += weight * at(low + step);
  }
  return sum;
}

}  // namespace kelp::bake
