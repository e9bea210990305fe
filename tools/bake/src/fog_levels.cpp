// SPDX-License-Identifier: MIT
// Levels of fog: densities and heat by average, so that the mass of each level is the same; each level's codes use the whole range.
#include <algorithm>
#include <cmath>
#include <utility>

#include "kelp/bake/bake.h"
#include "kelp/fields/fields.h"
#include "kelp/formats/fog.h"
#include "levels.h"
#include "parallel.h"

namespace kelp::bake {
namespace {

// A level before it is rounded; values 0 to 1 of what the finest level's greatest is.
struct Field {
  glm::ivec3 size{0};
  std::vector<float> values;

  std::size_t index(const glm::ivec3& v) const {
    return static_cast<std::size_t>(v.x) + static_cast<std::size_t>(size.x) * (static_cast<std::size_t>(v.y) + static_cast<std::size_t>(size.y) * static_cast<std::size_t>(v.z));
  }
};

Field fieldOf(const glm::ivec3& size, std::vector<std::uint16_t> codes) {
  Field field{size, std::vector<float>(codes.size())};
  std::transform(codes.begin(), codes.end(), field.values.begin(), [](std::uint16_t code) { return static_cast<float>(code) / 65535.0f; });
  return field;
}

// Means of eight; beyond the volume there is nothing.
Field coarser(const Field& fine, int threads) {
  Field coarse;
  coarse.size = levelSize(fine.size, 1);
  coarse.values.resize(static_cast<std::size_t>(coarse.size.x) * static_cast<std::size_t>(coarse.size.y) * static_cast<std::size_t>(coarse.size.z));
  parallelRanges(static_cast<std::size_t>(coarse.size.z), 1, threads, [&](std::size_t begin, std::size_t end) {
    for (int z = static_cast<int>(begin); z < static_cast<int>(end); ++z) {
      for (int y = 0; y < coarse.size.y; ++y) {
        for (int x = 0; x < coarse.size.x; ++x) {
          double sum = 0;
          for (int child = 0; child < 8; ++child) {
            const glm::ivec3 at(2 * x + (child & 1), 2 * y + (child >> 1 & 1), 2 * z + (child >> 2));
            if (at.x < fine.size.x && at.y < fine.size.y && at.z < fine.size.z) sum += static_cast<double>(fine.values[fine.index(at)]);
          }
          coarse.values[coarse.index({x, y, z})] = static_cast<float>(sum / 8);
        }
      }
    }
  });
  return coarse;
}

template <class Code>
std::vector<std::uint8_t> rounded(const Field& field, float greatest, int threads, Code&& codeOf) {
  std::vector<std::uint8_t> codes(field.values.size());
  parallelRanges(codes.size(), 1 << 16, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) codes[i] = codeOf(static_cast<double>(field.values[i]) / static_cast<double>(greatest));
  });
  return codes;
}

}  // namespace

std::vector<RawLevel> buildFogLevels(FogGrid grid, int levels, int threads, const Progress& progress) {
  const bool glows = !grid.heat.empty();
  Field density = fieldOf(grid.size, std::move(grid.density));
  Field heat = fieldOf(grid.size, std::move(grid.heat));
  std::vector<RawLevel> built;
  const int count = levelCount(grid.size, levels);
  for (int level = 0; level < count; ++level) {
    if (progress && !progress("levels", static_cast<double>(level) / count)) throw BakeError(Exit::kInterrupted, "interrupted");
    if (level > 0) {
      density = coarser(density, threads);
      if (glows) heat = coarser(heat, threads);
    }
    const float greatest = *std::max_element(density.values.begin(), density.values.end());
    fields::FogSamples samples{density.size, rounded(density, greatest, threads, [](double value) { return fogCode(value); }), {}};
    if (glows) samples.heat = rounded(heat, 1.0f, threads, [](double value) { return static_cast<std::uint8_t>(std::lround(255 * value)); });
    built.push_back(fields::buildFogLevel(samples, threadCount(threads)));
    built.back().extinction = grid.extinction * greatest;
  }
  if (progress && !progress("levels", 1.0)) throw BakeError(Exit::kInterrupted, "interrupted");
  return built;
}

}  // namespace kelp::bake
