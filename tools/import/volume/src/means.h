// SPDX-License-Identifier: MIT
// Means of a sparse grid over the voxels of a part, so that what there is of it in all stays the same.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "axis_means.h"
#include "lattice.h"

namespace kelp::bake {

// Densities and heat that are negative or not finite count as 0.
inline double amount(double value) { return value > 0 && std::isfinite(value) ? value : 0; }

// Means are exact if the part's axes run along the grid's (AxisMeans). Otherwise they are those of
// trilinear samples half a voxel apart, but no more than 16 along an axis and a billion in all. One for each
// thread, copies of one, which share what is large; the grid and the lattice outlive it.
class VolumeMeans {
 public:
  // to_index: of the grid that is looked up, which need not be the one that the lattice was made for.
  VolumeMeans(const VolumeGrid& grid, const glm::dmat4& to_index, const glm::ivec3& size);

  double at(const glm::ivec3& voxel) const;

  // That all copies take together.
  static std::uint64_t bytes(const VolumeGrid& grid, const glm::dmat4& to_index, const glm::ivec3& size);

 private:
  double within(const AxisMeans::Taken& taps, const glm::ivec3& low, int side) const;
  double sumOfVoxels(const AxisMeans::Taken& taps, const glm::ivec3& from, const glm::ivec3& end) const;
  double sampled(const glm::ivec3& voxel) const;
  double sumOf(const glm::ivec3& voxel, const glm::ivec3& low, const glm::ivec3& end) const;

  VolumeSampler sampler_;
  bool dense_;
  glm::dmat4 to_index_;
  std::shared_ptr<const AxisMeans> means_;  // if the axes run along each other
  glm::ivec3 samples_{1};
};

// ToolError kUnsupported where a voxel of the part would be the mean of more than kMostMeant of the grid's
// along an axis: so fine a grid, whose file may be a few bytes, would take memory and time without end.
// `place` is the grid. Raw volumes have no such limit: each of their voxels is a byte of the file at least.
inline constexpr double kMostMeant = 4096;
void checkMeans(const InputFiles& files, const std::string& place, const VolumeGrid& grid,
                const glm::dmat4& to_index);

}  // namespace kelp::bake
