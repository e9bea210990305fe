// SPDX-License-Identifier: MIT
// Levels of fog: the finest from the grid, each coarser one from the stored values of the level below.
#include <utility>

#include "kelp/bake/bake.h"
#include "kelp/common/parallel.h"
#include "kelp/fields/fields.h"
#include "kelp/formats/fog.h"
#include "levels.h"

namespace kelp::bake {
namespace {

template <class Code>
std::vector<std::uint8_t> rounded(const std::vector<std::uint16_t>& values, int threads, Code&& codeOf) {
  std::vector<std::uint8_t> codes(values.size());
  parallelRanges(codes.size(), 1 << 16, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) codes[i] = codeOf(values[i]);
  });
  return codes;
}

}  // namespace

std::vector<RawLevel> buildFogLevels(FogGrid grid, int levels, int threads, const Progress& progress) {
  fields::FogSamples samples;
  samples.size = grid.size;
  samples.density =
      rounded(grid.density, threads, [](std::uint16_t value) { return fogCode(value / 65535.0); });
  samples.heat = rounded(grid.heat, threads,
                         [](std::uint16_t value) { return static_cast<std::uint8_t>((value + 128) / 257); });
  grid = {glm::ivec3(0), grid.to_node, grid.extinction, {}, {}};  // its arrays are the largest there are
  float extinction = grid.extinction;
  std::vector<RawLevel> built;
  const int count = levelCount(samples.size, levels);
  for (int level = 0; level < count; ++level) {
    if (progress && !progress("levels", static_cast<double>(level) / count))
      throw ToolError(Exit::kInterrupted, "interrupted");
    if (level > 0) samples = fields::coarserFog(samples, extinction, threadCount(threads));
    built.push_back(fields::buildFogLevel(samples, threadCount(threads)));
    built.back().extinction = extinction;
  }
  if (progress && !progress("levels", 1.0)) throw ToolError(Exit::kInterrupted, "interrupted");
  return built;
}

}  // namespace kelp::bake
