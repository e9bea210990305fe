// SPDX-License-Identifier: MIT
#include "reference_fields.h"

#include <algorithm>
#include <limits>

namespace kelp::test {
namespace {

std::vector<glm::ivec3> setVoxels(const std::vector<std::uint8_t>& set, const glm::ivec3& size) {
  std::vector<glm::ivec3> voxels;
  std::size_t i = 0;
  for (int z = 0; z < size.z; ++z) {
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x, ++i) {
        if (set[i]) voxels.emplace_back(x, y, z);
      }
    }
  }
  return voxels;
}

template <class Distance>
std::vector<std::uint32_t> leastOfAll(const std::vector<std::uint8_t>& set, const glm::ivec3& size,
                                      Distance distance) {
  const std::vector<glm::ivec3> voxels = setVoxels(set, size);
  std::vector<std::uint32_t> result;
  result.reserve(set.size());
  for (int z = 0; z < size.z; ++z) {
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) {
        std::int64_t least = fields::kNoFeature;
        for (const glm::ivec3& voxel : voxels) least = std::min(least, distance(glm::ivec3(x, y, z), voxel));
        result.push_back(static_cast<std::uint32_t>(least));
      }
    }
  }
  return result;
}

// Felzenszwalb and Huttenlocher 2012, algorithm 1.
void transformPencil(std::vector<double>& f, std::vector<int>& v, std::vector<double>& z) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const int n = static_cast<int>(f.size());
  int k = -1;
  for (int q = 0; q < n; ++q) {
    if (f[static_cast<std::size_t>(q)] == kInfinity) continue;
    double s = -kInfinity;
    while (k >= 0) {
      const int p = v[static_cast<std::size_t>(k)];
      s = ((f[static_cast<std::size_t>(q)] + double(q) * q) -
           (f[static_cast<std::size_t>(p)] + double(p) * p)) /
          (2.0 * (q - p));
      if (s > z[static_cast<std::size_t>(k)]) break;
      --k;
      s = -kInfinity;
    }
    ++k;
    v[static_cast<std::size_t>(k)] = q;
    z[static_cast<std::size_t>(k)] = s;
    z[static_cast<std::size_t>(k) + 1] = kInfinity;
  }
  if (k < 0) return;
  const std::vector<double> old = f;
  k = 0;
  for (int q = 0; q < n; ++q) {
    while (z[static_cast<std::size_t>(k) + 1] < q) ++k;
    const int p = v[static_cast<std::size_t>(k)];
    f[static_cast<std::size_t>(q)] = double(q - p) * (q - p) + old[static_cast<std::size_t>(p)];
  }
}

}  // namespace

std::vector<std::uint32_t> bruteSquaredDistance(const std::vector<std::uint8_t>& set,
                                                const glm::ivec3& size) {
  return leastOfAll(set, size, [](const glm::ivec3& a, const glm::ivec3& b) {
    const std::int64_t dx = a.x - b.x, dy = a.y - b.y, dz = a.z - b.z;
    return dx * dx + dy * dy + dz * dz;
  });
}

std::int64_t squaredGap(const glm::ivec3& low, int extent, const glm::ivec3& solid) {
  std::int64_t sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    // the solid begins so far after the box ends
    const std::int64_t before = solid[axis] - (low[axis] + extent);
    const std::int64_t after = low[axis] - (solid[axis] + 1);  // or ends so far before the box begins
    const std::int64_t gap = std::max<std::int64_t>({before, after, 0});
    sum += gap * gap;
  }
  return sum;
}

std::vector<std::uint32_t> bruteSquaredClearance(const fields::Occupancy& occupancy) {
  return leastOfAll(occupancy.solid, occupancy.size,
                    [](const glm::ivec3& a, const glm::ivec3& b) { return squaredGap(a, 1, b); });
}

std::vector<std::uint32_t> naiveSeparable(const std::vector<std::uint8_t>& set, const glm::ivec3& size) {
  std::vector<double> values(set.size());
  std::transform(set.begin(), set.end(), values.begin(),
                 [](std::uint8_t s) { return s ? 0.0 : std::numeric_limits<double>::infinity(); });
  const std::size_t strides[3] = {1, static_cast<std::size_t>(size.x),
                                  static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y)};
  for (int axis = 0; axis < 3; ++axis) {
    const auto n = static_cast<std::size_t>(size[axis]);
    std::vector<double> pencil(n), z(n + 1);
    std::vector<int> v(n);
    const std::size_t stride = strides[axis];
    for (std::size_t outer = 0; outer < values.size(); outer += stride * n) {
      for (std::size_t inner = 0; inner < stride; ++inner) {
        double* const first = values.data() + outer + inner;
        for (std::size_t i = 0; i < n; ++i) pencil[i] = first[i * stride];
        transformPencil(pencil, v, z);
        for (std::size_t i = 0; i < n; ++i) first[i * stride] = pencil[i];
      }
    }
  }
  std::vector<std::uint32_t> squared(set.size());
  std::transform(values.begin(), values.end(), squared.begin(), [](double d) {
    return d == std::numeric_limits<double>::infinity() ? fields::kNoFeature : static_cast<std::uint32_t>(d);
  });
  return squared;
}

}  // namespace kelp::test
