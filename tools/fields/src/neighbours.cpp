// SPDX-License-Identifier: MIT
// What depends on the 26 neighbours: dilation, and the voxels of the surface.
#include <algorithm>
#include <cstring>
#include <memory>

#include "check.h"
#include "kelp/fields/fields.h"
#include "kernels.h"
#include "parallel.h"

namespace kelp::fields {
namespace {

// The (up to nine) rows around row (y, z), those outside the volume left out.
int rowsAround(const Occupancy& occupancy, int y, int z, const std::uint8_t* (&rows)[9]) {
  int count = 0;
  for (int nz = std::max(z - 1, 0); nz <= std::min(z + 1, occupancy.size.z - 1); ++nz) {
    for (int ny = std::max(y - 1, 0); ny <= std::min(y + 1, occupancy.size.y - 1); ++ny) {
      rows[count++] = occupancy.solid.data() + occupancy.index({0, ny, nz});
    }
  }
  return count;
}

// Whether any of eight bytes is 0.
bool holdsZero(std::uint64_t bytes) {
  return ((bytes - 0x0101010101010101u) & ~bytes & 0x8080808080808080u) != 0;
}

// Adds the solid voxels of a row that are not inner. Eight at a time: most are all empty, or all inner.
void addOuter(const std::uint8_t* solid, const std::vector<std::uint8_t>& inner, std::size_t first,
              std::vector<std::uint64_t>& surface) {
  std::size_t x = 0;
  const auto addOne = [&] {
    if (solid[x] && !inner[x]) surface.push_back(first + x);
  };
  for (; x + 8 <= inner.size();) {
    std::uint64_t solids, inners;
    std::memcpy(&solids, solid + x, 8);
    std::memcpy(&inners, inner.data() + x, 8);
    if (solids == 0 || !holdsZero(inners)) {
      x += 8;
      continue;
    }
    for (const std::size_t end = x + 8; x < end; ++x) addOne();
  }
  for (; x < inner.size(); ++x) addOne();
}

}  // namespace

std::vector<std::uint8_t> dilate26(const Occupancy& occupancy, int threads) {
  std::vector<std::uint8_t> dilated(checkedVolume(occupancy.solid.size(), occupancy.size));
  const glm::ivec3 size = occupancy.size;
  const Kernels& kernels = fastKernels();
  parallelFor(
      size.z, grainOf(std::int64_t{size.x} * size.y), threads, [&](std::int64_t begin, std::int64_t end) {
        const std::unique_ptr<std::uint8_t[]> scratch(new std::uint8_t[neighbourScratch(size.x)]);
        const std::uint8_t* rows[9];
        for (int z = static_cast<int>(begin); z < end; ++z) {
          for (int y = 0; y < size.y; ++y) {
            const int count = rowsAround(occupancy, y, z, rows);
            kernels.largest(rows, count, size.x, scratch.get(), dilated.data() + occupancy.index({0, y, z}));
          }
        }
      });
  return dilated;
}

std::vector<std::uint64_t> surfaceVoxels(const Occupancy& occupancy, int threads) {
  checkedVolume(occupancy.solid.size(), occupancy.size);
  const glm::ivec3 size = occupancy.size;
  const Kernels& kernels = fastKernels();
  std::vector<std::vector<std::uint64_t>> slices(static_cast<std::size_t>(size.z));
  parallelFor(size.z, grainOf(std::int64_t{size.x} * size.y), threads,
              [&](std::int64_t begin, std::int64_t end) {
                const std::unique_ptr<std::uint8_t[]> scratch(new std::uint8_t[neighbourScratch(size.x)]);
                std::vector<std::uint8_t> inner(static_cast<std::size_t>(size.x));
                const std::uint8_t* rows[9];
                for (int z = static_cast<int>(begin); z < end; ++z) {
                  std::vector<std::uint64_t>& surface = slices[static_cast<std::size_t>(z)];
                  for (int y = 0; y < size.y; ++y) {
                    // Where a row around is outside the volume, nothing of this row is inner.
                    const int count = rowsAround(occupancy, y, z, rows);
                    if (count == 9) {
                      kernels.smallest(rows, count, size.x, scratch.get(), inner.data());
                    } else {
                      std::fill(inner.begin(), inner.end(), std::uint8_t{0});
                    }
                    const std::size_t first = occupancy.index({0, y, z});
                    addOuter(occupancy.solid.data() + first, inner, first, surface);
                  }
                }
              });
  std::size_t total = 0;
  for (const auto& surface : slices) total += surface.size();
  std::vector<std::uint64_t> all;
  all.reserve(total);
  for (auto& surface : slices) {
    all.insert(all.end(), surface.begin(), surface.end());
    surface = {};
  }
  return all;
}

}  // namespace kelp::fields
