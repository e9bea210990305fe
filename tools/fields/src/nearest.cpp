// SPDX-License-Identifier: MIT
// The nearest set voxel of every voxel, for voxels of any shape, and what follows from it. Separable lower
// envelopes as in edt.cpp, but what is kept from pass to pass is which voxel is nearest: the distance follows
// from that, rounded once, whatever the spacing.
#include <cmath>
#include <limits>
#include <memory>

#include "check.h"
#include "kelp/fields/fields.h"
#include "parallel.h"

namespace kelp::fields {
namespace {

struct Lattice {
  glm::ivec3 size;
  glm::dvec3 spacing;

  // As voxelAt, in 32 bits: it is asked for every voxel.
  glm::ivec3 at(std::uint32_t index) const {
    const auto x = static_cast<std::uint32_t>(size.x), y = static_cast<std::uint32_t>(size.y);
    return {static_cast<int>(index % x), static_cast<int>(index / x % y), static_cast<int>(index / x / y)};
  }
  // Squared distance of two voxels' centres along the first `axes` axes.
  double squared(const glm::ivec3& a, const glm::ivec3& b, int axes) const {
    double sum = 0;
    for (int axis = 0; axis < axes; ++axis) {
      const double gap = spacing[axis] * (a[axis] - b[axis]);
      sum += gap * gap;
    }
    return sum;
  }
};

// Along a row: the nearer of the set voxels before and after, the one before if both are as near.
void nearestInRow(const std::uint8_t* set, int count, std::uint32_t first, std::uint32_t* nearest) {
  int before = -1;
  for (int x = 0; x < count; ++x) {
    if (set[x]) before = x;
    nearest[x] = before < 0 ? kNoFeature : first + static_cast<std::uint32_t>(before);
  }
  int after = -1;
  for (int x = count - 1; x >= 0; --x) {
    if (set[x]) after = x;
    if (after >= 0 && (nearest[x] == kNoFeature || after - x < x - static_cast<int>(nearest[x] - first)))
      nearest[x] = first + static_cast<std::uint32_t>(after);
  }
}

struct Parabola {
  int at;         // its lowest point
  double height;  // there
  int from;       // the first voxel of the pencil at which it is the lowest
  std::uint32_t nearest;
};

// One pencil along `axis` through `start`: nearest[i * stride] knows the axes before.
void nearestInPencil(const Lattice& lattice, int axis, glm::ivec3 start, std::uint32_t* nearest,
                     std::size_t stride, Parabola* stack) {
  const int count = lattice.size[axis];
  const double square = lattice.spacing[axis] * lattice.spacing[axis];
  int top = -1;
  for (int i = 0; i < count; ++i) {
    const std::uint32_t feature = nearest[static_cast<std::size_t>(i) * stride];
    if (feature == kNoFeature) continue;
    const double height = lattice.squared(start, lattice.at(feature), axis);
    int from = 0;
    for (; top >= 0; --top) {
      // From here on the new one is below the top.
      const Parabola& below = stack[top];
      const double crossing = 0.5 * ((height - below.height) / (square * (i - below.at)) + i + below.at);
      const double first = std::floor(crossing) + 1;
      from = first > count ? count : static_cast<int>(first);
      if (from > below.from) break;
      from = 0;
    }
    if (from < count) stack[++top] = {i, height, from, feature};
  }
  if (top < 0) return;
  for (int i = count - 1; i >= 0; --i) {
    while (stack[top].from > i) --top;
    nearest[static_cast<std::size_t>(i) * stride] = stack[top].nearest;
  }
}

void checkSpacing(const glm::dvec3& spacing) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!(spacing[axis] >= 1e-100 && spacing[axis] <= 1e100))
      throw std::invalid_argument("a voxel's spacing must be above 0 and finite, not " +
                                  std::to_string(spacing[axis]));
  }
}

// distance[i] of voxels whose `set` is 0; others keep theirs.
void distancesOutside(std::span<const std::uint8_t> set, const glm::ivec3& size, const glm::dvec3& spacing,
                      float sign, std::span<float> distance, int threads) {
  const auto grain = grainOf(1);
  const auto voxels = static_cast<std::int64_t>(set.size());
  if (spacing.x == spacing.y && spacing.y == spacing.z) {
    const std::unique_ptr<std::uint32_t[]> squared(new std::uint32_t[set.size()]);
    squaredDistance(set, size, {squared.get(), set.size()}, threads);
    parallelFor(voxels, grain, threads, [&](std::int64_t begin, std::int64_t end) {
      for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
        const double root = squared[i] == kNoFeature ? std::numeric_limits<double>::infinity()
                                                     : spacing.x * std::sqrt(static_cast<double>(squared[i]));
        if (!set[i]) distance[i] = sign * static_cast<float>(root);
      }
    });
    return;
  }
  const std::vector<std::uint32_t> nearest = nearestSet(set, size, spacing, threads);
  const Lattice lattice{size, spacing};
  parallelFor(voxels, grain, threads, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      if (set[i]) continue;
      const double squared =
          nearest[i] == kNoFeature
              ? std::numeric_limits<double>::infinity()
              : lattice.squared(lattice.at(static_cast<std::uint32_t>(i)), lattice.at(nearest[i]), 3);
      distance[i] = sign * static_cast<float>(std::sqrt(squared));
    }
  });
}

}  // namespace

std::vector<std::uint32_t> nearestSet(std::span<const std::uint8_t> set, const glm::ivec3& size,
                                      const glm::dvec3& spacing, int threads) {
  checkedVolume(set.size(), size);
  checkSpacing(spacing);
  if (set.size() >= kNoFeature)
    throw std::invalid_argument("a volume of " + std::to_string(set.size()) +
                                " voxels has more than 32 bits can tell apart");
  const Lattice lattice{size, spacing};
  const auto row = static_cast<std::size_t>(size.x), slice = row * static_cast<std::size_t>(size.y);
  std::vector<std::uint32_t> nearest(set.size());
  parallelFor(
      size.z, grainOf(static_cast<std::int64_t>(slice)), threads, [&](std::int64_t begin, std::int64_t end) {
        const std::unique_ptr<Parabola[]> stack(new Parabola[static_cast<std::size_t>(size.y)]);
        for (auto z = static_cast<int>(begin); z < end; ++z) {
          const std::size_t first = slice * static_cast<std::size_t>(z);
          for (std::size_t at = first; at < first + slice; at += row)
            nearestInRow(set.data() + at, size.x, static_cast<std::uint32_t>(at), nearest.data() + at);
          for (int x = 0; x < size.x; ++x)
            nearestInPencil(lattice, 1, {x, 0, z}, nearest.data() + first + static_cast<std::size_t>(x), row,
                            stack.get());
        }
      });
  parallelFor(
      size.y, grainOf(std::int64_t{size.x} * size.z), threads, [&](std::int64_t begin, std::int64_t end) {
        const std::unique_ptr<Parabola[]> stack(new Parabola[static_cast<std::size_t>(size.z)]);
        for (auto y = static_cast<int>(begin); y < end; ++y) {
          for (int x = 0; x < size.x; ++x)
            nearestInPencil(lattice, 2, {x, y, 0},
                            nearest.data() + row * static_cast<std::size_t>(y) + static_cast<std::size_t>(x),
                            slice, stack.get());
        }
      });
  return nearest;
}

std::vector<float> distance(std::span<const std::uint8_t> set, const glm::ivec3& size,
                            const glm::dvec3& spacing, int threads) {
  checkedVolume(set.size(), size);
  checkSpacing(spacing);
  std::vector<float> out(set.size());
  distancesOutside(set, size, spacing, 1, out, threads);
  return out;
}

std::vector<float> signedDistance(std::span<const std::uint8_t> set, const glm::ivec3& size,
                                  const glm::dvec3& spacing, int threads) {
  std::vector<float> out = distance(set, size, spacing, threads);
  std::vector<std::uint8_t> unset(set.size());
  for (std::size_t i = 0; i < set.size(); ++i) unset[i] = set[i] ? 0 : 1;
  distancesOutside(unset, size, spacing, -1, out, threads);
  return out;
}

}  // namespace kelp::fields
