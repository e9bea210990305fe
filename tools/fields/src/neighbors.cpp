// SPDX-License-Identifier: MIT
// Operations on the 26 neighbors: dilation, and the voxels of the surface.
#include <algorithm>
#include <bit>
#include <memory>

#include "check.h"
#include "kelp/common/dense_index.h"
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

// Calls visit(x of its first voxel, the surface voxels) for the words of a row that hold any.
template <class Visit>
void forEachSurfaceWord(const SolidBits& bits, int y, int z, const Visit& visit) {
  const std::uint64_t* const middle = bits.row(y, z);
  for (int i = 0; i < bits.words(); ++i) {
    if (middle[i] == 0) continue;
    // True if the columns of nine, at this voxel and at those before and after it, are all solid.
    std::uint64_t all = ~std::uint64_t{0}, before = all, after = all;
    for (int dz = -1; dz <= 1; ++dz) {
      for (int dy = -1; dy <= 1; ++dy) {
        const std::uint64_t* const row = bits.row(y + dy, z + dz) + i;
        all &= row[0];
        before &= row[-1];
        after &= row[1];
      }
    }
    const std::uint64_t inner = all & (all << 1 | before >> 63) & (all >> 1 | after << 63);
    if (const std::uint64_t surface = middle[i] & ~inner) visit(i * SolidBits::kWordVoxels, surface);
  }
}

}  // namespace

std::vector<std::uint8_t> dilate26(const Occupancy& occupancy, int threads) {
  std::vector<std::uint8_t> dilated(checkedVolume(occupancy.solid.size(), occupancy.size));
  const glm::ivec3 size = occupancy.size;
  const Kernels& kernels = fastKernels();
  parallelFor(
      size.z, grainOf(std::int64_t{size.x} * size.y), threads, [&](std::int64_t begin, std::int64_t end) {
        const std::unique_ptr<std::uint8_t[]> scratch(new std::uint8_t[neighborScratch(size.x)]);
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

std::vector<std::uint64_t> surfaceVoxels(const SolidBits& bits, int threads) {
  // Counts, then fills.
  const glm::ivec3& size = bits.size();
  const auto slices = static_cast<std::size_t>(size.z);
  std::vector<std::size_t> first(slices + 1, 0);
  parallelRanges(slices, 1, threads, [&](std::size_t z, std::size_t) {
    std::size_t count = 0;
    for (int y = 0; y < size.y; ++y)
      forEachSurfaceWord(bits, y, static_cast<int>(z), [&](int, std::uint64_t word) {
        count += static_cast<std::size_t>(std::popcount(word));
      });
    first[z + 1] = count;
  });
  for (std::size_t z = 0; z < slices; ++z) first[z + 1] += first[z];
  std::vector<std::uint64_t> surface(first.back());
  parallelRanges(slices, 1, threads, [&](std::size_t z, std::size_t) {
    std::uint64_t* out = surface.data() + first[z];
    for (int y = 0; y < size.y; ++y) {
      const std::size_t row = denseIndex(size, 0, y, static_cast<int>(z));
      forEachSurfaceWord(bits, y, static_cast<int>(z), [&](int x, std::uint64_t word) {
        for (; word != 0; word &= word - 1)
          *out++ = row + static_cast<std::size_t>(x) + static_cast<std::size_t>(std::countr_zero(word));
      });
    }
  });
  return surface;
}

std::vector<std::uint64_t> surfaceVoxels(const Occupancy& occupancy, int threads) {
  return surfaceVoxels(SolidBits(occupancy, threads), threads);
}

}  // namespace kelp::fields
