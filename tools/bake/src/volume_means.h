// SPDX-License-Identifier: MIT
// Means of a sparse grid over the voxels of a part, so that what there is of it in all stays the same.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "volume_lattice.h"

namespace kelp::bake {

// What counts of a density or a heat: the rest of the numbers is nothing.
inline double amount(double value) { return value > 0 && std::isfinite(value) ? value : 0; }

// Where an axis of the part runs along one of the grid's, a value is a box as wide as its voxel if the part's voxels are larger, else a tent between its
// neighbours: the mean over a part's voxel is then a product of three exact ones. Otherwise it is that of trilinear samples half a voxel
// apart, but no more than 16 along an axis and a billion in all.
// One for each thread, copies of one, which share what is large; the grid and the lattice outlive it.
class VolumeMeans {
 public:
  // to_index: of the grid that is looked up, which need not be the one that the lattice was made for.
  VolumeMeans(const SparseGrid& grid, const glm::dmat4& to_index, const glm::ivec3& size);

  double at(const glm::ivec3& voxel) const;

  // That all copies take together.
  static std::uint64_t bytes(const glm::dmat4& to_index, const glm::ivec3& size);

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
  double sumOf(const glm::ivec3& voxel, const glm::ivec3& low, const glm::ivec3& end) const;

  SparseSampler sampler_;
  glm::dmat4 to_index_;
  bool along_axes_ = false;
  glm::ivec3 index_axis_{0};                // of each axis of the part
  using AllTaps = std::array<std::vector<Taps>, 3>;  // of each axis of the part, by voxel
  std::shared_ptr<const AllTaps> taps_;
  glm::ivec3 samples_{1};
};

// BakeError kUnsupported where a voxel of the part would be the mean of more than kMostMeant of the grid's along an axis: so fine a grid, whose file may be a few
// bytes, would take memory and time without end. `place` is the grid.
inline constexpr double kMostMeant = 4096;
void checkMeans(const InputFiles& files, const std::string& place, const glm::dmat4& to_index);

// Whether every axis of one matrix's linear part runs along one of the other space's.
bool alongAxes(const glm::dmat4& m);

}  // namespace kelp::bake
