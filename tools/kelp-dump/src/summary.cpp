// SPDX-License-Identifier: MIT
#include "summary.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "text.h"

namespace kelp::dump {
namespace {

LevelSummary summarizeLevel(PackFile& file, int part, int level, std::array<std::uint64_t, 256>& palette_use) {
  const Pack& pack = file.pack();
  const auto where = [&] { return fmt::format("part {} '{}', level {}", part, nameText(pack.parts()[static_cast<std::size_t>(part)].name), level); };
  const Result<LevelGrid> grid = pack.readGrid(part, level);
  if (!grid) file.fail(grid.error(), where());
  LevelSummary summary;
  summary.size = grid->size;
  summary.cells = grid->cells.size();
  summary.bricks = grid->bricks;
  summary.pages = grid->pages.size();
  PageData page;
  for (const PageInfo& info : grid->pages) {
    summary.page_bytes += info.raw;
    if (const Result<void> read = pack.readPage(info, page); !read) file.fail(read.error(), where());
    summary.solid += static_cast<std::uint64_t>(std::count_if(page.codes.begin(), page.codes.end(), isSolidCode));
    summary.surface += page.attributes.size();
    if (level > 0) continue;
    for (const std::uint32_t attribute : page.attributes) ++palette_use[attributePalette(attribute)];
  }
  for (const Pack::ChunkInfo& chunk : pack.chunks()) {
    const std::string kind = fourccText(chunk.fourcc);
    if ((kind == "GRID" || kind == "BRCK") && chunk.part == static_cast<std::uint32_t>(part) && chunk.level == static_cast<std::uint32_t>(level))
      summary.stored += chunk.stored;
  }
  return summary;
}

// page_bytes: what the pages of all BRCK chunks decode to; the index counts these chunks as they are stored, each page being a frame of its own.
std::vector<ChunkSummary> summarizeChunks(const Pack& pack, std::uint64_t page_bytes) {
  std::vector<ChunkSummary> kinds;
  std::uint64_t in_chunks = 0;
  for (const Pack::ChunkInfo& chunk : pack.chunks()) {
    const std::string kind = fourccText(chunk.fourcc);
    auto same = std::find_if(kinds.begin(), kinds.end(), [&](const ChunkSummary& c) { return c.kind == kind; });
    if (same == kinds.end()) same = kinds.insert(same, ChunkSummary{kind, 0, 0, 0});
    ++same->count;
    same->stored += chunk.stored;
    same->raw = kind == "BRCK" ? page_bytes : same->raw + chunk.raw;
    in_chunks += chunk.stored;
  }
  const std::uint64_t other = pack.fileSize() - std::min(pack.fileSize(), in_chunks);
  kinds.push_back({"other", 1, other, other});
  return kinds;
}

}  // namespace

std::uint64_t Summary::rawBytes() const {
  return std::accumulate(chunks.begin(), chunks.end(), std::uint64_t{0}, [](std::uint64_t sum, const ChunkSummary& c) { return sum + c.raw; });
}

std::uint64_t Summary::surfaceVoxels() const {
  return std::accumulate(parts.begin(), parts.end(), std::uint64_t{0}, [](std::uint64_t sum, const PartSummary& p) { return sum + p.levels[0].surface; });
}

Summary summarize(PackFile& file) {
  const Pack& pack = file.pack();
  Summary summary;
  summary.path = file.path();
  summary.pack = &pack;
  for (std::size_t p = 0; p < pack.parts().size(); ++p) {
    const Part& part = pack.parts()[p];
    PartSummary& out = summary.parts.emplace_back();
    out.part = &part;
    for (int axis = 0; axis < 3; ++axis) out.voxel[axis] = glm::length(glm::dvec3(part.to_object[axis]));
    for (int level = 0; level < part.levels; ++level) out.levels.push_back(summarizeLevel(file, static_cast<int>(p), level, summary.palette_use));
  }
  std::uint64_t page_bytes = 0;
  for (const PartSummary& part : summary.parts) {
    for (const LevelSummary& level : part.levels) page_bytes += level.page_bytes;
  }
  summary.chunks = summarizeChunks(pack, page_bytes);
  return summary;
}

}  // namespace kelp::dump
