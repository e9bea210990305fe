// SPDX-License-Identifier: MIT
// Coarser levels of fog, and what is lost in them.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "check.h"
#include "kelp/fields/fields.h"
#include "kelp/formats/fog.h"
#include "parallel.h"

namespace kelp::fields {
namespace {

std::size_t indexOf(const glm::ivec3& size, const glm::ivec3& v) {
  return static_cast<std::size_t>(v.x) + static_cast<std::size_t>(size.x) * (static_cast<std::size_t>(v.y) + static_cast<std::size_t>(size.y) * static_cast<std::size_t>(v.z));
}

// One channel of a level as numbers.
struct Channel {
  const glm::ivec3& size;
  const std::vector<std::uint8_t>& codes;
  std::array<double, 256> values;

  double at(const glm::ivec3& v) const { return values[codes[indexOf(size, v)]]; }
  // Between samples; beyond them as at the nearest.
  double between(const glm::dvec3& u) const {
    const glm::dvec3 inside = glm::clamp(u, glm::dvec3(0), glm::dvec3(size - 1));
    const glm::ivec3 low(glm::floor(inside)), high = glm::min(low + 1, size - 1);
    const glm::dvec3 f = inside - glm::dvec3(low);
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::bvec3 up(corner & 1, corner & 2, corner & 4);
      const glm::dvec3 weight = glm::mix(1.0 - f, f, glm::dvec3(up));
      sum += weight.x * weight.y * weight.z * at(glm::mix(low, high, up));
    }
    return sum;
  }
};

Channel densityOf(const FogLevelView& level) {
  Channel channel{level.samples.size, level.samples.density, {}};
  for (int code = 0; code < 256; ++code) channel.values[static_cast<std::size_t>(code)] = double{level.extinction} * double{fogDensity(static_cast<std::uint8_t>(code))};
  return channel;
}
Channel heatOf(const FogLevelView& level, float glow) {
  Channel channel{level.samples.size, level.samples.heat, {}};
  for (int code = 0; code < 256; ++code) channel.values[static_cast<std::size_t>(code)] = double{glow} * code / 255.0;
  return channel;
}

// The greatest error of any stretch of a line of fine samples through the samples first .. end - 1.
double lineError(const Channel& fine, const Channel& coarse, const glm::ivec3& first, const glm::ivec3& end) {
  const glm::ivec3 size = end - first;
  std::vector<double> off(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) * static_cast<std::size_t>(size.z));
  std::size_t next = 0;
  for (int z = first.z; z < end.z; ++z)
    for (int y = first.y; y < end.y; ++y)
      for (int x = first.x; x < end.x; ++x) off[next++] = coarse.between(0.5 * glm::dvec3(x, y, z) - 0.25) - fine.at({x, y, z});
  const std::array<std::size_t, 3> step = {1, static_cast<std::size_t>(size.x), static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y)};
  double most = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    for (int j = 0; j < size[b]; ++j) {
      for (int i = 0; i < size[a]; ++i) {
        // The difference of any two partial sums is that of the greatest and the least.
        std::size_t at = static_cast<std::size_t>(i) * step[static_cast<std::size_t>(a)] + static_cast<std::size_t>(j) * step[static_cast<std::size_t>(b)];
        double sum = 0, low = 0, high = 0;
        for (int k = 0; k < size[axis]; ++k, at += step[static_cast<std::size_t>(axis)]) {
          sum += off[at];
          low = std::min(low, sum);
          high = std::max(high, sum);
        }
        most = std::max(most, high - low);
      }
    }
  }
  return most;
}

}  // namespace

FogSamples coarserFog(const FogSamples& fine, float& extinction, int threads) {
  FogSamples coarse;
  coarse.size = levelSize(fine.size, 1);
  const std::size_t count = checkedVolume(coarse.size);
  std::vector<double> means(count);
  coarse.density.resize(count);
  if (!fine.heat.empty()) coarse.heat.resize(count);
  const auto overSlabs = [&](auto&& visit) {
    parallelFor(coarse.size.z, grainOf(std::int64_t{coarse.size.x} * coarse.size.y), threads, [&](std::int64_t begin, std::int64_t end) {
      for (int z = static_cast<int>(begin); z < end; ++z)
        for (int y = 0; y < coarse.size.y; ++y)
          for (int x = 0; x < coarse.size.x; ++x) visit(glm::ivec3(x, y, z));
    });
  };
  overSlabs([&](const glm::ivec3& at) {
    double sum = 0;
    int heat = 0;
    for (int child = 0; child < 8; ++child) {
      const glm::ivec3 v = 2 * at + glm::ivec3(child & 1, child >> 1 & 1, child >> 2);
      if (v.x >= fine.size.x || v.y >= fine.size.y || v.z >= fine.size.z) continue;
      const int code = fine.density[indexOf(fine.size, v)];
      sum += code * code;  // whole numbers: the order of adding is all one
      if (!fine.heat.empty()) heat += fine.heat[indexOf(fine.size, v)];
    }
    means[indexOf(coarse.size, at)] = sum / 8;
    if (!fine.heat.empty()) coarse.heat[indexOf(coarse.size, at)] = static_cast<std::uint8_t>(heat > 0 ? std::max(1, (heat + 4) / 8) : 0);
  });
  const double greatest = *std::max_element(means.begin(), means.end());
  overSlabs([&](const glm::ivec3& at) {
    const double mean = means[indexOf(coarse.size, at)];
    coarse.density[indexOf(coarse.size, at)] = mean > 0 ? std::max<std::uint8_t>(1, fogCode(mean / greatest)) : std::uint8_t{0};
  });
  if (greatest > 0) extinction = static_cast<float>(double{extinction} * greatest / 65025.0);
  return coarse;
}

std::vector<std::uint8_t> fogErrors(const FogLevelView& fine, const FogLevelView& coarse, int level, float glow, int threads) {
  const glm::ivec3 cubes = latticeSize(PartKind::kFog, coarse.samples.size), grid = brickGrid(cubes);
  const glm::ivec3 fine_grid = brickGrid(latticeSize(PartKind::kFog, fine.samples.size));
  std::vector<std::uint8_t> errors(checkedVolume(grid));
  const Channel fine_density = densityOf(fine), coarse_density = densityOf(coarse);
  const Channel fine_heat = heatOf(fine, glow), coarse_heat = heatOf(coarse, glow);
  const double voxel = std::exp2(level - 1);  // of the finer level
  parallelFor(static_cast<std::int64_t>(errors.size()), 1, threads, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      const auto wide = static_cast<std::size_t>(grid.x), high = static_cast<std::size_t>(grid.y);
      const glm::ivec3 brick(static_cast<int>(i % wide), static_cast<int>(i / wide % high), static_cast<int>(i / (wide * high)));
      // The fine samples in the brick's box, and the fine bricks that it touches; at the volume's faces with the rim.
      glm::ivec3 first, last, from, to;
      for (int axis = 0; axis < 3; ++axis) {
        const bool at_end = brick[axis] == grid[axis] - 1;
        first[axis] = brick[axis] == 0 ? 0 : 16 * brick[axis] + 1;
        last[axis] = at_end ? fine.samples.size[axis] : std::min(16 * brick[axis] + 17, fine.samples.size[axis]);
        from[axis] = std::min(2 * brick[axis], fine_grid[axis] - 1);
        to[axis] = std::min(at_end ? fine_grid[axis] - 1 : 2 * brick[axis] + 2, fine_grid[axis] - 1);
      }
      double error = 0;
      if (glm::all(glm::lessThan(first, last))) {
        error = lineError(fine_density, coarse_density, first, last);
        if (!fine.samples.heat.empty()) error = std::max(error, lineError(fine_heat, coarse_heat, first, last));
      }
      int before = 0;
      if (!fine.errors.empty()) {
        for (int z = from.z; z <= to.z; ++z)
          for (int y = from.y; y <= to.y; ++y)
            for (int x = from.x; x <= to.x; ++x) before = std::max(before, int{fine.errors[indexOf(fine_grid, {x, y, z})]});
      }
      errors[i] = fogErrorCode(fogError(before) + voxel * error);
    }
  });
  return errors;
}

}  // namespace kelp::fields
