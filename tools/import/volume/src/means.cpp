// SPDX-License-Identifier: MIT
#include "means.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace kelp::bake {
namespace {

// The box that a grid's voxels can be in.
struct MeansRange {
  explicit MeansRange(const VolumeGrid& grid)
      : first(grid.isDense() ? 0 : -kMaxCoordinate - 4),
        end(grid.isDense() ? grid.dense : glm::ivec3(kMaxCoordinate + 4)) {}
  glm::ivec3 first, end;
};

}  // namespace

VolumeMeans::VolumeMeans(const VolumeGrid& grid, const glm::dmat4& to_index, const glm::ivec3& size)
    : sampler_(grid), dense_(grid.isDense()), to_index_(to_index) {
  if (alongAxes(to_index)) {
    const MeansRange range(grid);
    means_ = std::make_shared<AxisMeans>(to_index, size, range.first, range.end);
  } else {
    // Two along each voxel of the grid, 16 at most, and a billion in all. A shear makes edges long that
    // enclose little: then fewer, up to 64 for each voxel of the grid.
    const double voxels = static_cast<double>(size.x) * size.y * size.z,
                 most = std::clamp(std::floor(std::cbrt(0x1p30 / voxels)), 2.0, 16.0);
    const glm::dvec3 along =
        2.0 * glm::dvec3(glm::length(glm::dvec3(to_index[0])), glm::length(glm::dvec3(to_index[1])),
                         glm::length(glm::dvec3(to_index[2])));
    const double enough = 64 * std::max(std::abs(glm::determinant(glm::dmat3(to_index))), 1.0),
                 fewer = std::min(1.0, std::cbrt(enough / (along.x * along.y * along.z)));
    for (int i = 0; i < 3; ++i)
      samples_[i] = static_cast<int>(std::clamp(std::ceil(fewer * along[i] - 1e-6), 1.0, most));
  }
}

void checkMeans(const InputFiles& files, const std::string& place, const VolumeGrid& grid,
                const glm::dmat4& to_index) {
  if (!alongAxes(to_index) || grid.isDense()) return;
  const double most = std::max({glm::length(glm::dvec3(to_index[0])), glm::length(glm::dvec3(to_index[1])),
                                glm::length(glm::dvec3(to_index[2]))});
  if (!(most <= kMostMeant))
    refuse(Exit::kUnsupported, files.input(), place,
           fmt::format("has {:.4g} voxels along an axis to one of the part, kelp takes the mean of {} at "
                       "most; give a larger --resolution, or resample the grid",
                       most, kMostMeant));
}

std::uint64_t VolumeMeans::bytes(const VolumeGrid& grid, const glm::dmat4& to_index, const glm::ivec3& size) {
  if (!alongAxes(to_index)) return 0;
  const MeansRange range(grid);
  const glm::dvec3 extent = glm::dvec3(range.end) - glm::dvec3(range.first);
  const double most = std::max({extent.x, extent.y, extent.z});
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    const double taps = std::min(glm::length(glm::dvec3(to_index[i])), most) + 5;
    sum += size[i] * (sizeof(Taps) + 2 * sizeof(double) * taps);
  }
  return static_cast<std::uint64_t>(std::min(sum, 1e18));
}

// Of the cube of `side` voxels at low: at once where it is constant.
double VolumeMeans::within(const AxisMeans::Taken& taps, const glm::ivec3& low, int side) const {
  glm::ivec3 from(0), end(0);
  for (int i = 0; i < 3; ++i) {
    const Taps& along = *taps[static_cast<std::size_t>(i)];
    from[i] = std::max(low[i], along.first);
    end[i] = std::min(low[i] + side, along.end());
    if (from[i] >= end[i]) return 0;
  }
  const VolumeCell cell = sampler_.cellAt(from);
  if (cell.side >= side) {
    const double value = amount(cell.value.x);
    return value == 0 ? 0
                      : value * taps[0]->share(from.x, end.x) * taps[1]->share(from.y, end.y) *
                            taps[2]->share(from.z, end.z);
  }
  if (side == VolumeGrid::kLeafSide) return sumOfVoxels(taps, from, end);
  const int part = side == VolumeGrid::kUpperSide ? VolumeGrid::kLowerSide : VolumeGrid::kLeafSide;
  double sum = 0;
  glm::ivec3 at(0);
  const glm::ivec3 first = from & glm::ivec3(~(part - 1));
  for (at.x = first.x; at.x < end.x; at.x += part)
    for (at.y = first.y; at.y < end.y; at.y += part)
      for (at.z = first.z; at.z < end.z; at.z += part) sum += within(taps, at, part);
  return sum;
}

// Of the voxels from `from` to before `end`, one by one.
double VolumeMeans::sumOfVoxels(const AxisMeans::Taken& taps, const glm::ivec3& from,
                                const glm::ivec3& end) const {
  double sum = 0;
  glm::ivec3 at(0);
  for (at.x = from.x; at.x < end.x; ++at.x)
    for (at.y = from.y; at.y < end.y; ++at.y) {
      const double weight = taps[0]->weights[static_cast<std::size_t>(at.x - taps[0]->first)] *
                            taps[1]->weights[static_cast<std::size_t>(at.y - taps[1]->first)];
      for (at.z = from.z; at.z < end.z; ++at.z)
        sum += weight * taps[2]->weights[static_cast<std::size_t>(at.z - taps[2]->first)] *
               amount(sampler_.at(at));
    }
  return sum;
}

double VolumeMeans::at(const glm::ivec3& voxel) const {
  if (!means_) return sampled(voxel);
  const AxisMeans::Taken taps = means_->of(voxel);
  glm::ivec3 first(0), end(0);
  for (int i = 0; i < 3; ++i) {
    first[i] = taps[static_cast<std::size_t>(i)]->first;
    end[i] = taps[static_cast<std::size_t>(i)]->end();
  }
  if (dense_) return sumOfVoxels(taps, first, end);
  first = first & glm::ivec3(~(VolumeGrid::kUpperSide - 1));
  double sum = 0;
  glm::ivec3 low(0);
  for (low.x = first.x; low.x < end.x; low.x += VolumeGrid::kUpperSide)
    for (low.y = first.y; low.y < end.y; low.y += VolumeGrid::kUpperSide)
      for (low.z = first.z; low.z < end.z; low.z += VolumeGrid::kUpperSide)
        sum += within(taps, low, VolumeGrid::kUpperSide);
  return sum;
}

double VolumeMeans::sampled(const glm::ivec3& voxel) const {
  return sumOf(voxel, glm::ivec3(0), samples_) / (static_cast<double>(samples_.x) * samples_.y * samples_.z);
}

// Of the samples from low to end: at once where all that they meet is one cell.
double VolumeMeans::sumOf(const glm::ivec3& voxel, const glm::ivec3& low, const glm::ivec3& end) const {
  constexpr int kFew = 8;
  const glm::ivec3 count = end - low;
  const glm::dvec3 center(
      to_index_ * glm::dvec4(glm::dvec3(voxel) + 0.5 * glm::dvec3(low + end) / glm::dvec3(samples_), 1));
  const glm::dvec3 half = 0.5 * glm::dvec3(count) / glm::dvec3(samples_);
  const glm::dvec3 reach = half.x * glm::abs(glm::dvec3(to_index_[0])) +
                           half.y * glm::abs(glm::dvec3(to_index_[1])) +
                           half.z * glm::abs(glm::dvec3(to_index_[2])) + 1.0;
  if (onLattice(center - reach) && onLattice(center + reach)) {
    const VolumeCell cell = sampler_.cellAt(glm::ivec3(glm::floor(center - reach)));
    if (glm::all(glm::lessThan(glm::ivec3(glm::ceil(center + reach)) - cell.low, glm::ivec3(cell.side))))
      return amount(cell.value.x) * count.x * count.y * count.z;
  }
  if (count.x * count.y * count.z > kFew) {
    const int axis = count.x >= count.y && count.x >= count.z ? 0 : count.y >= count.z ? 1 : 2;
    glm::ivec3 first_end = end, second_low = low;
    first_end[axis] = second_low[axis] = low[axis] + count[axis] / 2;
    return sumOf(voxel, low, first_end) + sumOf(voxel, second_low, end);
  }
  double sum = 0;
  for (int z = low.z; z < end.z; ++z)
    for (int y = low.y; y < end.y; ++y)
      for (int x = low.x; x < end.x; ++x) {
        const glm::dvec3 inside = (glm::dvec3(x, y, z) + 0.5) / glm::dvec3(samples_);
        const glm::dvec3 place = glm::dvec3(to_index_ * glm::dvec4(glm::dvec3(voxel) + inside, 1));
        if (!onLattice(place)) continue;
        const glm::dvec3 floor = glm::floor(place), f = place - floor;
        for (int corner = 0; corner < 8; ++corner) {
          const glm::ivec3 step(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
          const double weight =
              (step.x ? f.x : 1 - f.x) * (step.y ? f.y : 1 - f.y) * (step.z ? f.z : 1 - f.z);
          sum += weight * amount(sampler_.at(glm::ivec3(floor) + step));
        }
      }
  return sum;
}

}  // namespace kelp::bake
