// SPDX-License-Identifier: MIT
#include "axis_means.h"

#include <algorithm>
#include <cmath>

namespace kelp::bake {
namespace {

constexpr double kFarthestCell = 1 << 29;

// The integral up to x of a tent about 0 with width 2 and area 1.
double tentBefore(double x) {
  if (x <= -1) return 0;
  if (x >= 1) return 1;
  return x < 0 ? 0.5 * (x + 1) * (x + 1) : 1 - 0.5 * (1 - x) * (1 - x);
}
double boxBefore(double x) { return std::clamp(x + 0.5, 0.0, 1.0); }

// True if centers of two lattices coincide along an axis, up to rounding.
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

AxisMeans::AxisMeans(const glm::dmat4& to_index, const glm::ivec3& size, const glm::ivec3& first,
                     const glm::ivec3& end) {
  for (int i = 0; i < 3; ++i) {
    const int axis = index_axis_[i] = dominantAxis(glm::dvec3(to_index[i]));
    const double scale = to_index[i][axis], origin = to_index[3][axis], width = std::abs(scale);
    auto& all = taps_[static_cast<std::size_t>(i)];
    for (int voxel = 0; voxel < size[i]; ++voxel) {
      Taps& taps = all.emplace_back();
      const double center = std::clamp(origin + scale * (voxel + 0.5), -kFarthestCell, kFarthestCell),
                   low = center - width / 2, high = center + width / 2;
      if (std::abs(width - 1) < 1e-6 && isWhole(center)) {
        taps = {static_cast<int>(std::round(center)), {1.0}, {0.0, 1.0}};
        continue;
      }
      const auto before = width < 1 - 1e-6 ? tentBefore : boxBefore;
      const auto within = [&](double at) {
        return static_cast<int>(std::clamp(at, 1.0 * first[axis], 1.0 * end[axis]));
      };
      taps.first = within(std::floor(low) - 1);
      for (int j = taps.first; j < within(std::ceil(high) + 2); ++j) {
        const double weight = (before(high - j) - before(low - j)) / width;
        if (weight == 0 && taps.weights.empty())
          taps.first = j + 1;
        else
          taps.weights.push_back(weight);
      }
      while (taps.weights.size() > 1 && taps.weights.back() == 0) taps.weights.pop_back();
      taps.before.assign(1, 0.0);
      for (const double weight : taps.weights) taps.before.push_back(taps.before.back() + weight);
    }
  }
}

AxisMeans::Taken AxisMeans::of(const glm::ivec3& voxel) const {
  Taken taken{};
  for (int i = 0; i < 3; ++i)
    taken[static_cast<std::size_t>(index_axis_[i])] =
        &taps_[static_cast<std::size_t>(i)][static_cast<std::size_t>(voxel[i])];
  return taken;
}

double Taps::share(int low, int end) const {
  return before[static_cast<std::size_t>(std::clamp(end - first, 0, count()))] -
         before[static_cast<std::size_t>(std::clamp(low - first, 0, count()))];
}

}  // namespace kelp::bake
