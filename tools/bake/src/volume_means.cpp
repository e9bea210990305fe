// SPDX-License-Identifier: MIT
#include "volume_means.h"

#include <algorithm>
#include <cmath>

namespace kelp::bake {
namespace {

// The integral of a tent of width 2 and area 1 about 0, from the left to x.
double tentBefore(double x) {
  if (x <= -1) return 0;
  if (x >= 1) return 1;
  return x < 0 ? 0.5 * (x + 1) * (x + 1) : 1 - 0.5 * (1 - x) * (1 - x);
}
double boxBefore(double x) { return std::clamp(x + 0.5, 0.0, 1.0); }

// Whether a lattice's centres are another's, along an axis: as near as rounding leaves it.
bool isWhole(double x) { return std::abs(x - std::round(x)) < 1e-4; }

int dominantAxis(const glm::dvec3& v) {
  const glm::dvec3 a = glm::abs(v);
  return a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
}

}  // namespace

bool alongAxes(const glm::dmat4& m) {
  int used = 0;
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 column(m[i]);
    const int axis = dominantAxis(column);
    for (int j = 0; j < 3; ++j)
      if (j != axis && std::abs(column[j]) > 1e-6 * std::abs(column[axis])) return false;
    used |= 1 << axis;
  }
  return used == 7;
}

VolumeMeans::VolumeMeans(const SparseGrid& grid, const glm::dmat4& to_index, const glm::ivec3& size) : sampler_(grid), to_index_(to_index), along_axes_(alongAxes(to_index)) {
  if (along_axes_) {
    makeTaps(to_index, size);
  } else {
    for (int i = 0; i < 3; ++i) samples_[i] = static_cast<int>(std::clamp(std::ceil(2 * glm::length(glm::dvec3(to_index[i])) - 1e-6), 1.0, 64.0));
  }
}

void VolumeMeans::makeTaps(const glm::dmat4& to_index, const glm::ivec3& size) {
  for (int i = 0; i < 3; ++i) {
    const int axis = index_axis_[i] = dominantAxis(glm::dvec3(to_index[i]));
    const double scale = to_index[i][axis], origin = to_index[3][axis], width = std::abs(scale);
    auto& all = taps_[static_cast<std::size_t>(i)];
    for (int voxel = 0; voxel < size[i]; ++voxel) {
      Taps& taps = all.emplace_back();
      const double centre = std::clamp(origin + scale * (voxel + 0.5), -1.0 * kMaxCoordinate, 1.0 * kMaxCoordinate), low = centre - width / 2, high = centre + width / 2;
      if (std::abs(width - 1) < 1e-6 && isWhole(centre)) {
        taps = {static_cast<int>(std::round(centre)), {1.0}};
        continue;
      }
      const auto before = width < 1 - 1e-6 ? tentBefore : boxBefore;
      taps.first = static_cast<int>(std::floor(low)) - 1;
      for (int j = taps.first; j <= static_cast<int>(std::ceil(high)) + 1; ++j) taps.weights.push_back((before(high - j) - before(low - j)) / width);
      while (taps.weights.size() > 1 && taps.weights.back() == 0) taps.weights.pop_back();
    }
  }
}

double VolumeMeans::at(const glm::ivec3& voxel) const {
  if (!along_axes_) return sampled(voxel);
  const Taps& a = taps_[0][static_cast<std::size_t>(voxel.x)];
  const Taps& b = taps_[1][static_cast<std::size_t>(voxel.y)];
  const Taps& c = taps_[2][static_cast<std::size_t>(voxel.z)];
  double sum = 0;
  glm::ivec3 place, last;
  const std::array<const Taps*, 3> all = {&a, &b, &c};
  for (int i = 0; i < 3; ++i) {
    const Taps& taps = *all[static_cast<std::size_t>(i)];
    place[index_axis_[i]] = taps.first;
    last[index_axis_[i]] = taps.first + static_cast<int>(taps.weights.size()) - 1;
  }
  // Most of a box is nothing.
  const SparseCell cell = sampler_.cellAt(place);
  if (cell.side > 1 && amount(sampler_.value(cell)) == 0 && glm::all(glm::lessThan(last, cell.low + cell.side))) return 0;
  for (std::size_t k = 0; k < c.weights.size(); ++k) {
    place[index_axis_.z] = c.first + static_cast<int>(k);
    for (std::size_t j = 0; j < b.weights.size(); ++j) {
      place[index_axis_.y] = b.first + static_cast<int>(j);
      const double weight = c.weights[k] * b.weights[j];
      if (weight == 0) continue;
      for (std::size_t i = 0; i < a.weights.size(); ++i) {
        if (a.weights[i] == 0) continue;
        place[index_axis_.x] = a.first + static_cast<int>(i);
        sum += weight * a.weights[i] * amount(sampler_.at(place));
      }
    }
  }
  return sum;
}

double VolumeMeans::sampled(const glm::ivec3& voxel) const {
  double sum = 0;
  for (int z = 0; z < samples_.z; ++z)
    for (int y = 0; y < samples_.y; ++y)
      for (int x = 0; x < samples_.x; ++x) {
        const glm::dvec3 inside = (glm::dvec3(x, y, z) + 0.5) / glm::dvec3(samples_);
        const glm::dvec3 place = glm::dvec3(to_index_ * glm::dvec4(glm::dvec3(voxel) + inside, 1));
        if (!onLattice(place)) continue;
        const glm::dvec3 floor = glm::floor(place), f = place - floor;
        for (int corner = 0; corner < 8; ++corner) {
          const glm::ivec3 step(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
          const double weight = (step.x ? f.x : 1 - f.x) * (step.y ? f.y : 1 - f.y) * (step.z ? f.z : 1 - f.z);
          sum += weight * amount(sampler_.at(glm::ivec3(floor) + step));
        }
      }
  return sum / (static_cast<double>(samples_.x) * samples_.y * samples_.z);
}

}  // namespace kelp::bake
