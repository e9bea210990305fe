// SPDX-License-Identifier: MIT
#include "info/summary.h"

#include <algorithm>
#include <numeric>
#include <unordered_map>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "kelp/common/dense_index.h"
#include "kelp/formats/fog.h"
#include "kelp/formats/level.h"
#include "pack/level_grid.h"
#include "text/text.h"

namespace kelp::dump {
namespace {

// Counts the cubes in a page of fog that are not clear and within the level. `positions`: of the bricks, by
// slot.
std::uint64_t foggyCubes(const PageData& page, int channels, const std::vector<glm::ivec3>& positions,
                         const glm::ivec3& cubes) {
  std::uint64_t foggy = 0;
  const std::size_t bricks = page.info.count;
  for (std::size_t brick = 0; brick < bricks; ++brick) {
    const glm::ivec3 room =
        glm::min(cubes - kBrickSide * positions[page.info.first_slot + brick], glm::ivec3(kBrickSide));
    for (std::size_t i = 0; i < denseCount(room); ++i) {
      const glm::ivec3 cube = voxelAt(room, i);
      bool any = false;
      for (std::size_t channel = 0; channel < static_cast<std::size_t>(channels); ++channel) {
        const std::uint8_t* const samples = page.fog.data() + (channel * bricks + brick) * kFogSamples;
        for (int corner = 0; corner < 8; ++corner) {
          const glm::ivec3 at = cube + glm::ivec3(corner & 1, corner >> 1 & 1, corner >> 2);
          any = any || samples[denseIndex(glm::ivec3(kFogSide), at)] != 0;
        }
      }
      foggy += any;
    }
  }
  return foggy;
}

// A grid holds its cells, then 32 bytes for each page (SPEC.md, 5.2 and 5.4). So the number of pages is known
// before the grid is read.
std::uint64_t pagesOf(const Pack::ChunkInfo& grid, std::uint64_t cell_bytes) {
  const std::uint64_t table_at = (cell_bytes + 7) / 8 * 8;
  return grid.raw > table_at ? (grid.raw - table_at) / 32 : 0;
}

std::vector<PartSummary> summarizeTables(const Pack& pack) {
  std::vector<PartSummary> parts;
  for (const Part& part : pack.parts()) {
    PartSummary& out = parts.emplace_back();
    out.part = &part;
    for (int axis = 0; axis < 3; ++axis) out.voxel[axis] = glm::length(glm::dvec3(part.to_object[axis]));
    for (int l = 0; l < part.levels; ++l) {
      LevelSummary& level = out.levels.emplace_back();
      level.size = levelSize(part.size, l);
      level.cells = denseCount(brickGrid(latticeSize(part.kind, level.size)));
    }
  }
  for (const Pack::ChunkInfo& chunk : pack.chunks()) {
    const std::string kind = fourccText(chunk.fourcc);
    if (kind == "DGRD" || kind == "DIST") {
      const glm::ivec3 size = levelSize(pack.parts()[chunk.part].size, static_cast<int>(chunk.level));
      auto& distances = parts.at(chunk.part).distances;
      if (!distances) distances.emplace();
      distances->stored += chunk.stored;
      if (kind == "DIST") continue;
      ++distances->levels;
      distances->pages += pagesOf(chunk, 8 + denseCount(brickGrid(size)));
      continue;
    }
    if (kind != "GRID" && kind != "BRCK" && kind != "FOGB") continue;
    LevelSummary& level = parts.at(chunk.part).levels.at(chunk.level);
    if (kind == "GRID") level.pages = pagesOf(chunk, level.cells);
    level.stored += chunk.stored;
  }
  return parts;
}

LevelSummary::Counted countLevel(PackFile& file, std::uint32_t part, int level,
                                 std::array<std::uint64_t, 256>& palette_use) {
  const LevelReader reader = openLevel(file, part, level);
  const LevelGrid& grid = reader.grid();
  LevelSummary::Counted counted;
  const Part& of = file.pack().parts()[part];
  std::vector<glm::ivec3> positions;
  if (of.fog) {
    counted.cubes = denseCount(grid.size);
    positions = bricksBySlot(grid);
  }
  counted.bricks = grid.bricks.size();
  counted.solid += kBrickVoxels * static_cast<std::uint64_t>(
                                      std::count_if(grid.cells.begin(), grid.cells.end(),
                                                    [&](std::uint32_t cell) { return grid.isInside(cell); }));
  PageData page;
  for (std::size_t i = 0; i < grid.pages.size(); ++i) {
    const PageInfo& info = grid.pages[i];
    counted.page_bytes += info.raw;
    readLevelPage(file, reader, i, page);
    if (of.fog) counted.foggy += foggyCubes(page, info.channels, positions, grid.size);
    for (std::uint32_t brick = 0; !of.fog && brick < page.info.count; ++brick) {
      const std::span<const std::uint8_t> codes = page.codes(brick);
      counted.solid += static_cast<std::uint64_t>(std::count_if(codes.begin(), codes.end(), isSolidCode));
    }
    counted.surface += page.attributes().size();
    if (level > 0) continue;
    for (const std::uint32_t attribute : page.attributes()) ++palette_use[attributePalette(attribute)];
  }
  return counted;
}

std::uint64_t distanceBytes(PackFile& file, std::uint32_t part, int level) {
  const Result<LevelGrid> grid = file.pack().readDistanceGrid(static_cast<int>(part), level);
  if (!grid) file.fail(grid.error(), levelText(file.pack(), part, level) + ", distances");
  std::uint64_t bytes = 0;
  for (const PageInfo& page : grid->pages) bytes += page.raw;
  return bytes;
}

// The decoded bytes of all pages. The index only has their stored bytes, as each page is compressed on its
// own.
struct PageBytes {
  std::uint64_t solid = 0, fog = 0, distances = 0;
};

std::vector<ChunkSummary> summarizeChunks(const Pack& pack, const std::optional<PageBytes>& pages) {
  std::vector<ChunkSummary> kinds;
  std::unordered_map<std::string, std::size_t> index;
  std::uint64_t in_chunks = 0;
  for (const Pack::ChunkInfo& chunk : pack.chunks()) {
    const std::string kind = fourccText(chunk.fourcc);
    const auto [at, fresh] = index.try_emplace(kind, kinds.size());
    if (fresh) kinds.push_back({kind, 0, 0, 0});
    ChunkSummary& same = kinds[at->second];
    ++same.count;
    same.stored += chunk.stored;
    if (kind == "BRCK" || kind == "FOGB" || kind == "DIST")
      same.raw = pages ? std::optional(kind == "BRCK"   ? pages->solid
                                       : kind == "FOGB" ? pages->fog
                                                        : pages->distances)
                       : std::nullopt;
    else
      same.raw = *same.raw + chunk.raw;
    in_chunks += chunk.stored;
  }
  const std::uint64_t other = pack.fileSize() - std::min(pack.fileSize(), in_chunks);
  kinds.push_back({"other", 1, other, other});
  return kinds;
}

}  // namespace

CageSummary summarize(const Cage& cage) {
  CageSummary out;
  for (std::uint32_t i = 0; i < cage.cells(); ++i) out.pieces += cage.cell(i)[1] != 0 ? 1 : 0;
  out.memory = cage.bytes();
  return out;
}

std::set<std::uint16_t> followedParts(const Part& part) {
  std::set<std::uint16_t> parts;
  if (part.cages.empty()) return parts;
  for (const Influences& node : part.cages[0].influences)
    for (int i = 0; i < 4 && node.weights[i] > 0; ++i) parts.insert(node.parts[i]);
  return parts;
}

std::uint64_t PartSummary::stored() const {
  return std::accumulate(levels.begin(), levels.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const LevelSummary& l) { return sum + l.stored; });
}

std::optional<std::uint64_t> Summary::rawBytes() const {
  std::uint64_t sum = 0;
  for (const ChunkSummary& chunk : chunks) {
    if (!chunk.raw) return std::nullopt;
    sum += *chunk.raw;
  }
  return sum;
}

std::uint64_t Summary::voxels() const {
  return std::accumulate(parts.begin(), parts.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const PartSummary& p) {
                           return sum + (p.levels.empty() ? 0 : denseCount(p.part->size));
                         });
}

std::uint64_t Summary::surfaceVoxels() const {
  return std::accumulate(parts.begin(), parts.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const PartSummary& p) {
                           const bool counted = !p.levels.empty() && p.levels[0].counted;
                           return sum + (counted ? p.levels[0].counted->surface : 0);
                         });
}

Summary summarize(PackFile& file, bool count) {
  const Pack& pack = file.pack();
  Summary summary;
  summary.path = file.path();
  summary.pack = &pack;
  summary.counted = count;
  summary.parts = summarizeTables(pack);
  PageBytes pages;
  for (std::size_t p = 0; count && p < summary.parts.size(); ++p) {
    PartSummary& part = summary.parts[p];
    for (std::size_t l = 0; l < part.levels.size(); ++l) {
      part.levels[l].counted =
          countLevel(file, static_cast<std::uint32_t>(p), static_cast<int>(l), summary.palette_use);
      (part.part->fog ? pages.fog : pages.solid) += part.levels[l].counted->page_bytes;
    }
    for (int l = 0; l < pack.distanceLevels(static_cast<int>(p)); ++l)
      pages.distances += distanceBytes(file, static_cast<std::uint32_t>(p), l);
  }
  summary.chunks = summarizeChunks(pack, count ? std::optional(pages) : std::nullopt);
  return summary;
}

}  // namespace kelp::dump
