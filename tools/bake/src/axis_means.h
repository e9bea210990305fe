// SPDX-License-Identifier: MIT
// Means over voxels that stand along a grid's axes.
#pragma once

#include <array>
#include <vector>

#include <glm/glm.hpp>

namespace kelp::bake {

// Whether every axis of one matrix's linear part runs along one of the other space's.
bool alongAxes(const glm::dmat4& m);

// The voxels of a grid, along one of its axes, that one of the part's is the mean of: those from `first` on, and how much of each. The sum is 1, less what lies outside.
struct Taps {
  int first = 0;
  std::vector<double> weights;
  std::vector<double> before;  // the sum of those before each, and of all

  int count() const { return static_cast<int>(weights.size()); }
  int end() const { return first + count(); }
  double share(int low, int end) const;  // of the voxels from low to before end
};

// Those of every voxel of a part whose axes run along a grid's: the mean over one is the product of three exact ones. A value is a box as wide as its voxel if the part's voxels are
// larger, else a tent between its neighbours.
class AxisMeans {
 public:
  // to_index: alongAxes(). Outside of the grid's voxels from `first` to before `end` there is nothing.
  AxisMeans(const glm::dmat4& to_index, const glm::ivec3& size, const glm::ivec3& first, const glm::ivec3& end);

  using Taken = std::array<const Taps*, 3>;  // by axis of the grid
  Taken of(const glm::ivec3& voxel) const;

 private:
  glm::ivec3 index_axis_{0};                 // of each axis of the part
  std::array<std::vector<Taps>, 3> taps_;    // of each axis of the part, by voxel
};

}  // namespace kelp::bake
