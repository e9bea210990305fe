// SPDX-License-Identifier: MIT
// The nearest set voxel of every voxel. Separable lower envelopes as in edt.cpp, but each pass keeps the
// nearest voxel instead of the distance.
#include <cmath>
#include <memory>

#include "check.h"
#include "kelp/fields/fields.h"
#include "parallel.h"

namespace kelp::fields {
namespace {

// As voxelAt, in 32 bits: it is asked for every voxel.
glm::ivec3 voxelOf(const glm::ivec3& size, std::uint32_t index) {
  const auto x = static_cast<std::uint32_t>(size.x), y = static_cast<std::uint32_t>(size.y);
  return {static_cast<int>(index % x), static_cast<int>(index / x % y), static_cast<int>(index / x / y)};
}

// Squared distance of two voxels along the first `axes` axes.
double squaredBetween(const glm::ivec3& a, const glm::ivec3& b, int axes) {
  double sum = 0;
  for (int axis = 0; axis < axes; ++axis) {
    const double gap = a[axis] - b[axis];
    sum += gap * gap;
  }
  return sum;
}

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
void nearestInPencil(const glm::ivec3& size, int axis, glm::ivec3 start, std::uint32_t* nearest,
                     std::size_t stride, Parabola* stack) {
  const int count = size[axis];
  int top = -1;
  for (int i = 0; i < count; ++i) {
    const std::uint32_t feature = nearest[static_cast<std::size_t>(i) * stride];
    if (feature == kNoFeature) continue;
    const double height = squaredBetween(start, voxelOf(size, feature), axis);
    int from = 0;
    for (; top >= 0; --top) {
      // From here on the new one is below the top.
      const Parabola& below = stack[top];
      const double crossing = 0.5 * ((height - below.height) / (i - below.at) + i + below.at);
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

}  // namespace

std::vector<std::uint32_t> nearestSet(std::span<const std::uint8_t> set, const glm::ivec3& size,
                                      int threads) {
  checkedVolume(set.size(), size);
  if (set.size() >= kNoFeature)
    throw std::invalid_argument("a volume of " + std::to_string(set.size()) +
                                " voxels has more than 32 bits can tell apart");
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
            nearestInPencil(size, 1, {x, 0, z}, nearest.data() + first + static_cast<std::size_t>(x), row,
                            stack.get());
        }
      });
  parallelFor(
      size.y, grainOf(std::int64_t{size.x} * size.z), threads, [&](std::int64_t begin, std::int64_t end) {
        const std::unique_ptr<Parabola[]> stack(new Parabola[static_cast<std::size_t>(size.z)]);
        for (auto y = static_cast<int>(begin); y < end; ++y) {
          for (int x = 0; x < size.x; ++x)
            nearestInPencil(size, 2, {x, y, 0},
                            nearest.data() + row * static_cast<std::size_t>(y) + static_cast<std::size_t>(x),
                            slice, stack.get());
        }
      });
  return nearest;
}

}  // namespace kelp::fields
