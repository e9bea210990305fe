// SPDX-License-Identifier: MIT
// Exact means over voxels whose axes are parallel to a grid's axes.
#pragma once

#include <array>
#include <vector>

#include <glm/glm.hpp>

namespace kelp::bake {

// True if each axis of the matrix's linear part is parallel to a coordinate axis.
bool alongAxes(const glm::dmat4& m);

// Along one axis of a grid: the voxels that one voxel of the part is the mean of, from `first` on, and the
// weight of each. The weights add up to 1, less the share outside the grid.
struct Taps {
  int first = 0;
  std::vector<double> weights;
  std::vector<double> before;  // sums of the weights before each, and of all

  int count() const { return static_cast<int>(weights.size()); }
  int end() const { return first + count(); }
  double share(int low, int end) const;  // the weight of the voxels from low to before end
};

// The taps of every voxel of a part whose axes are parallel to a grid's: the mean over a voxel is the product
// of three exact ones. A value counts as a box as wide as its voxel if the part's voxels are larger, else as
// a tent between its neighbors.
class AxisMeans {
 public:
  // to_index must be alongAxes(). Outside the grid's voxels from `first` to before `end` everything is 0.
  AxisMeans(const glm::dmat4& to_index, const glm::ivec3& size, const glm::ivec3& first,
            const glm::ivec3& end);

  using Taken = std::array<const Taps*, 3>;  // by axis of the grid
  Taken of(const glm::ivec3& voxel) const;

 private:
  glm::ivec3 index_axis_{0};               // for each axis of the part
  std::array<std::vector<Taps>, 3> taps_;  // for each axis of the part, by voxel
};

}  // namespace kelp::bake
