// SPDX-License-Identifier: MIT
// Palettes by request: colors that somebody fixed, and materials that stay apart.
#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "kelp/common/error.h"
#include "kelp/common/parallel.h"
#include "kelp/import/core/source_model.h"
#include "palette.h"

namespace kelp::bake {
namespace {

// The entries are the colors, in their order; what a color says nothing of is the mean over the voxels that
// get it.
Palette fixedPalette(const std::vector<const VoxelGrid*>& grids, const std::vector<glm::vec3>& colors,
                     int threads) {
  Palette palette;
  for (const glm::vec3& color : colors) palette.entries.emplace_back().base_color = glm::vec4(color, 1);
  struct Sum {
    double alpha = 0, metallic = 0, roughness = 0, count = 0;
    glm::dvec3 emissive{0};
  };
  std::vector<Sum> sums(colors.size());
  double error = 0, count = 0;
  for (const VoxelGrid* grid : grids) {
    std::vector<std::uint8_t>& indices = palette.indices.emplace_back(grid->surface.size());
    parallelRanges(indices.size(), 4096, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        std::size_t best = 0;
        double nearest = colorDistance(grid->surface[i].material, palette.entries[0]);
        for (std::size_t e = 1; e < palette.entries.size(); ++e) {
          const double distance = colorDistance(grid->surface[i].material, palette.entries[e]);
          if (distance >= nearest) continue;
          nearest = distance;
          best = e;
        }
        indices[i] = static_cast<std::uint8_t>(best);
      }
    });
    for (std::size_t i = 0; i < indices.size(); ++i) {
      const Material& m = grid->surface[i].material;
      Sum& sum = sums[indices[i]];
      sum.alpha += static_cast<double>(m.base_color.a);
      sum.metallic += static_cast<double>(m.metallic);
      sum.roughness += static_cast<double>(m.roughness);
      sum.emissive += glm::dvec3(m.emissive);
      sum.count += 1;
      error += colorDistance(m, palette.entries[indices[i]]);
      count += 1;
    }
  }
  for (std::size_t e = 0; e < sums.size(); ++e) {
    if (sums[e].count == 0) continue;
    Material& entry = palette.entries[e];
    entry.base_color.a = static_cast<float>(sums[e].alpha / sums[e].count);
    entry.metallic = static_cast<float>(sums[e].metallic / sums[e].count);
    entry.roughness = static_cast<float>(sums[e].roughness / sums[e].count);
    entry.emissive = glm::vec3(sums[e].emissive / sums[e].count);
  }
  palette.mean_error = count > 0 ? error / count : 0.0;
  return palette;
}

// The entries are the file's own, and so are the voxels' indices. Unless they blend each entry is its own
// source: coarser voxels keep the commonest index of their children, so that whoever paints an entry anew
// paints the same places on every level.
Palette givenPalette(const std::vector<const VoxelGrid*>& grids, const std::vector<Material>& entries,
                     bool blends) {
  Palette palette;
  palette.entries = entries;
  for (std::size_t e = 0; !blends && e < entries.size(); ++e)
    palette.sources.push_back(static_cast<std::uint32_t>(e));
  for (const VoxelGrid* grid : grids) {
    std::vector<std::uint8_t>& indices = palette.indices.emplace_back();
    indices.reserve(grid->surface.size());
    for (const SurfaceSample& sample : grid->surface)
      indices.push_back(static_cast<std::uint8_t>(sample.source));
  }
  return palette;
}

// Each source gets as many entries as it has materials; where that is too many, those with the most get equal
// shares of what the others leave.
std::vector<std::size_t> shareEntries(const std::vector<std::size_t>& wanted) {
  std::vector<std::size_t> order(wanted.size()), given(wanted.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return wanted[a] < wanted[b]; });
  std::size_t left = kMaxPalette;
  for (std::size_t i = 0; i < order.size(); ++i) {
    given[order[i]] = std::min(wanted[order[i]], left / (order.size() - i));
    left -= given[order[i]];
  }
  return given;
}

Palette separatePalette(const std::vector<const VoxelGrid*>& grids, int threads) {
  // The samples of each source, as grids of their own.
  std::map<std::uint32_t, std::vector<VoxelGrid>> by_source;
  for (std::size_t g = 0; g < grids.size(); ++g) {
    for (const SurfaceSample& sample : grids[g]->surface) {
      std::vector<VoxelGrid>& its = by_source[sample.source];
      its.resize(grids.size());
      its[g].surface.push_back(sample);
    }
  }
  if (by_source.size() > kMaxPalette) {
    throw ToolError(Exit::kUnsupported, fmt::format("--keep-materials: {} materials are seen, a palette "
                                                    "holds {}; merge some, or leave the option out",
                                                    by_source.size(), kMaxPalette));
  }
  std::vector<std::vector<const VoxelGrid*>> parts;
  std::vector<std::size_t> wanted;
  for (const auto& [source, its] : by_source) {
    std::vector<const VoxelGrid*> part;
    for (const VoxelGrid& grid : its) part.push_back(&grid);
    wanted.push_back(countDistinct(part, kMaxPalette));
    parts.push_back(std::move(part));
  }
  const std::vector<std::size_t> given = shareEntries(wanted);

  Palette palette;
  std::map<std::uint32_t, std::pair<std::size_t, Palette>> chosen;  // first entry, and its own palette
  double error = 0, count = 0;
  std::size_t at = 0;
  for (const auto& [source, its] : by_source) {
    Palette own = clusterPalette(parts[at], given[at], threads);
    const std::size_t first = palette.entries.size();
    palette.entries.insert(palette.entries.end(), own.entries.begin(), own.entries.end());
    palette.sources.resize(palette.entries.size(), source);
    for (const VoxelGrid& grid : its) {
      error += own.mean_error * static_cast<double>(grid.surface.size());
      count += static_cast<double>(grid.surface.size());
    }
    chosen.emplace(source, std::pair(first, std::move(own)));
    ++at;
  }
  palette.mean_error = count > 0 ? error / count : 0.0;
  for (std::size_t g = 0; g < grids.size(); ++g) {
    std::map<std::uint32_t, std::size_t> next;  // of each source's own indices
    std::vector<std::uint8_t>& indices = palette.indices.emplace_back();
    for (const SurfaceSample& sample : grids[g]->surface) {
      const auto& [first, own] = chosen.at(sample.source);
      indices.push_back(static_cast<std::uint8_t>(first + own.indices[g][next[sample.source]++]));
    }
  }
  if (palette.entries.empty()) {  // no sample at all
    palette.entries.emplace_back();
    palette.sources.push_back(0);
  }
  return palette;
}

}  // namespace

Palette choosePalette(const std::vector<const VoxelGrid*>& grids, int threads, const PaletteRules& rules) {
  if (!rules.colors.empty()) return fixedPalette(grids, rules.colors, threads);
  if (!rules.entries.empty()) return givenPalette(grids, rules.entries, rules.blends);
  return rules.keep_materials ? separatePalette(grids, threads) : clusterPalette(grids, kMaxPalette, threads);
}

}  // namespace kelp::bake
