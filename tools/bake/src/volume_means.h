// SPDX-License-Identifier: MIT
// Means of a sparse grid over the voxels of a part, so that what there is of it in all stays the same.
#pragma once

#include <array>
#include <vector>

#include "volume_lattice.h"

namespace kelp::bake {

// What counts of a density or a heat: the rest of the numbers is nothing.
inline double amount(double value) { return value > 0 && std::isfinite(value) ? value : 0; }

// Where an axis of the part runs along one of the grid's, a value is a box as wide as its voxel if the part's voxels are larger, else a tent between its
// neighbours: the mean over a part's voxel is then a product of three exact ones. Otherwise it is that of trilinear samples half a voxel
// apart, but no more than 16 along an axis.
// One for each thread; the grid and the lattice outlive it.
class VolumeMeans {
 public:
  // to_index: of the grid that is looked up, which need not be the one that the lattice was made for.
  VolumeMeans(const SparseGrid& grid, const glm::dmat4& to_index, const glm::ivec3& size);

  double at(const glm::ivec3& voxel) const;

 private:
  struct Taps {
    int first = 0;
    std::vector<double> weights;
    std::vector<double> before;  // the sum of those before each, and of all

    double share(int low, int end) const;  // of the voxels from low to before end
  };
  using Taken = std::array<const Taps*, 3>;  // by axis of the grid

  void makeTaps(const glm::dmat4& to_index, const glm::ivec3& size);
  double within(const Taken& taps, const glm::ivec3& low, int side) const;
  double sampled(const glm::ivec3& voxel) const;

  SparseSampler sampler_;
  glm::dmat4 to_index_;
  bool along_axes_ = false;
  glm::ivec3 index_axis_{0};                // of each axis of the part
  std::array<std::vector<Taps>, 3> taps_;   // of each axis of the part, by voxel
  glm::ivec3 samples_{1};
};

// Whether every axis of one matrix's linear part runs along one of the other space's.
bool alongAxes(const glm::dmat4& m);

}  // namespace kelp::bake
