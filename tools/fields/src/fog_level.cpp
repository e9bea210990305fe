// SPDX-License-Identifier: MIT
// Fog: which cubes are not clear, the bricks that hold them, and coarser levels.
#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "bricks.h"
#include "check.h"
#include "kelp/common/dense_index.h"
#include "kelp/fields/fields.h"
#include "kelp/formats/fog.h"
#include "parallel.h"

namespace kelp::fields {
namespace {

void checkSamples(const FogSamples& fog) {
  checkedVolume(fog.density.size(), fog.size);
  if (!fog.heat.empty() && fog.heat.size() != fog.density.size())
    throw std::invalid_argument("a level of fog has not one heat for each sample");
}

}  // namespace

Occupancy fogCubes(const FogSamples& fog, int threads) {
  checkSamples(fog);
  Occupancy cubes;
  cubes.size = latticeSize(PartKind::kFog, fog.size);
  cubes.solid.resize(checkedVolume(cubes.size));
  const auto wide = static_cast<std::size_t>(fog.size.x), high = static_cast<std::size_t>(fog.size.y);
  // A side of one sample has one cube, which has no far corners.
  const std::size_t far_x = fog.size.x > 1 ? 1 : 0, far_y = fog.size.y > 1 ? wide : 0,
                    far_z = fog.size.z > 1 ? wide * high : 0;
  parallelFor(cubes.size.z, grainOf(std::int64_t{fog.size.x} * fog.size.y), threads,
              [&](std::int64_t begin, std::int64_t end) {
                for (int z = static_cast<int>(begin); z < end; ++z) {
                  for (int y = 0; y < cubes.size.y; ++y) {
                    std::uint8_t* const row = cubes.solid.data() + cubes.index({0, y, z});
                    for (const std::vector<std::uint8_t>* channel : {&fog.density, &fog.heat}) {
                      if (channel->empty()) continue;
                      const std::uint8_t* const at = channel->data() + denseIndex(fog.size, 0, y, z);
                      for (int x = 0; x < cubes.size.x; ++x) {
                        const std::uint8_t* const corner = at + x;
                        const int any = corner[0] | corner[far_x] | corner[far_y] | corner[far_x + far_y] |
                                        corner[far_z] | corner[far_x + far_z] | corner[far_y + far_z] |
                                        corner[far_x + far_y + far_z];
                        row[x] = static_cast<std::uint8_t>(row[x] | (any != 0));
                      }
                    }
                  }
                }
              });
  return cubes;
}

RawLevel buildFogLevel(const FogSamples& fog, int threads) {
  const Occupancy cubes = fogCubes(fog, threads);
  if (std::all_of(cubes.solid.begin(), cubes.solid.end(), [](std::uint8_t any) { return any == 0; }))
    throw std::invalid_argument("a level of fog needs at least one cube that is not clear");
  BrickCells built = buildCells(SolidBits(cubes, threads), {}, threads);
  RawLevel level;
  level.cells = std::move(built.cells);
  const auto take = [&](const std::vector<std::uint8_t>& from, std::vector<std::uint8_t>& to) {
    if (from.empty()) return;
    to.assign(built.stored.size() * kFogSamples, 0);
    parallelFor(
        static_cast<std::int64_t>(built.stored.size()), grainOf(kFogSamples), threads,
        [&](std::int64_t begin, std::int64_t end) {
          for (auto slot = static_cast<std::size_t>(begin); slot < static_cast<std::size_t>(end); ++slot) {
            const glm::ivec3 first = built.stored[slot] * kBrickSide,
                             room = glm::min(fog.size - first, glm::ivec3(kFogSide));
            for (int z = 0; z < room.z; ++z) {
              for (int y = 0; y < room.y; ++y) {
                const std::size_t row = denseIndex(fog.size, first.x, first.y + y, first.z + z);
                std::copy_n(
                    from.data() + row, room.x,
                    to.data() + slot * kFogSamples + static_cast<std::size_t>(kFogSide * (y + kFogSide * z)));
              }
            }
          }
        });
  };
  take(fog.density, level.density);
  take(fog.heat, level.heat);
  return level;
}

FogSamples fogSamplesOf(const RawLevel& level, const glm::ivec3& size) {
  FogSamples fog;
  fog.size = size;
  const glm::ivec3 grid = brickGrid(latticeSize(PartKind::kFog, size));
  if (level.cells.size() != checkedVolume(grid))
    throw std::invalid_argument("a level has not one cell for each brick of its grid");
  const auto give = [&](const std::vector<std::uint8_t>& from, std::vector<std::uint8_t>& to) {
    if (from.empty()) return;
    to.assign(checkedVolume(size), 0);
    glm::ivec3 brick{0};
    std::size_t next = 0;
    for (brick.z = 0; brick.z < grid.z; ++brick.z) {
      for (brick.y = 0; brick.y < grid.y; ++brick.y) {
        for (brick.x = 0; brick.x < grid.x; ++brick.x) {
          const std::uint32_t cell = level.cells[next++];
          if (!(cell & kCellSolid)) continue;
          const std::size_t slot = cell & kCellSlotMask;
          if ((slot + 1) * kFogSamples > from.size())
            throw std::invalid_argument("a cell's slot is out of range");
          const glm::ivec3 first = brick * kBrickSide, room = glm::min(size - first, glm::ivec3(kFogSide));
          for (int z = 0; z < room.z; ++z) {
            for (int y = 0; y < room.y; ++y) {
              const std::size_t row = denseIndex(size, first.x, first.y + y, first.z + z);
              std::copy_n(
                  from.data() + slot * kFogSamples + static_cast<std::size_t>(kFogSide * (y + kFogSide * z)),
                  room.x, to.data() + row);
            }
          }
        }
      }
    }
  };
  give(level.density, fog.density);
  give(level.heat, fog.heat);
  return fog;
}

FogSamples coarserFog(const FogSamples& fine, float& extinction, int threads) {
  FogSamples coarse;
  coarse.size = levelSize(fine.size, 1);
  const std::size_t count = checkedVolume(coarse.size);
  std::vector<double> means(count);
  coarse.density.resize(count);
  if (!fine.heat.empty()) coarse.heat.resize(count);
  const auto overSlabs = [&](auto&& visit) {
    parallelFor(coarse.size.z, grainOf(std::int64_t{coarse.size.x} * coarse.size.y), threads,
                [&](std::int64_t begin, std::int64_t end) {
                  for (int z = static_cast<int>(begin); z < end; ++z)
                    for (int y = 0; y < coarse.size.y; ++y)
                      for (int x = 0; x < coarse.size.x; ++x) visit(glm::ivec3(x, y, z));
                });
  };
  overSlabs([&](const glm::ivec3& at) {
    double sum = 0;
    int heat = 0, there = 0;
    for (int child = 0; child < 8; ++child) {
      const glm::ivec3 v = 2 * at + glm::ivec3(child & 1, child >> 1 & 1, child >> 2);
      if (v.x >= fine.size.x || v.y >= fine.size.y || v.z >= fine.size.z) continue;
      ++there;
      const int code = fine.density[denseIndex(fine.size, v)];
      sum += code * code;  // whole numbers: the order of adding does not matter
      if (!fine.heat.empty()) heat += fine.heat[denseIndex(fine.size, v)];
    }
    means[denseIndex(coarse.size, at)] = sum / there;
    if (!fine.heat.empty())
      coarse.heat[denseIndex(coarse.size, at)] =
          static_cast<std::uint8_t>(heat > 0 ? std::max(1, (2 * heat + there) / (2 * there)) : 0);
  });
  const double greatest = *std::max_element(means.begin(), means.end());
  overSlabs([&](const glm::ivec3& at) {
    const double mean = means[denseIndex(coarse.size, at)];
    coarse.density[denseIndex(coarse.size, at)] =
        mean > 0 ? std::max<std::uint8_t>(1, fogCode(mean / greatest)) : std::uint8_t{0};
  });
  if (greatest > 0)
    extinction = std::max(static_cast<float>(double{extinction} * greatest / 65025.0),
                          std::numeric_limits<float>::min());
  return coarse;
}

}  // namespace kelp::fields
