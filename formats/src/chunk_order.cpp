// SPDX-License-Identifier: MIT
// The order of chunks: INFO PART MATL FOGS RIGS CLIP SOCK; then for each level, coarse to fine, and for each
// part, GRID and BRCK or FOGB. Unknown optional chunks may stand anywhere between.
#include <algorithm>

#include "container.h"
#include "layout.h"

namespace kelp {
namespace {

using ChunkInfo = Pack::ChunkInfo;

Error wrongOrder(const char* detail, std::size_t index) {
  return {ErrorCode::kCorrupt, detail, layout::kHeaderBytes + index * layout::kIndexEntryBytes};
}

bool isMetadata(std::uint32_t fourcc) {
  using namespace layout;
  return fourcc == kInfo || fourcc == kPart || fourcc == kMatl || fourcc == kFogs || fourcc == kRigs ||
         fourcc == kClip || fourcc == kSock;
}

bool isLevel(std::uint32_t fourcc) { return fourcc == layout::kGrid || layout::isPages(fourcc); }

}  // namespace

Result<MetadataChunks> findMetadata(std::span<const ChunkInfo> chunks, const Limits& limits) {
  MetadataChunks found;
  struct Slot {
    std::uint32_t fourcc;
    std::size_t* index;
  };
  const Slot slots[] = {{layout::kInfo, &found.info}, {layout::kPart, &found.part},
                        {layout::kMatl, &found.matl}, {layout::kFogs, &found.fogs},
                        {layout::kRigs, &found.rigs}, {layout::kClip, &found.clip},
                        {layout::kSock, &found.sock}};
  const Slot* next = std::begin(slots);
  bool levels = false;
  std::uint64_t total = 0;
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    levels = levels || isLevel(chunks[i].fourcc);
    if (!isMetadata(chunks[i].fourcc)) continue;
    if (levels) return wrongOrder("a metadata chunk comes after the levels", i);
    const Slot* slot =
        std::find_if(next, std::end(slots), [&](const Slot& s) { return s.fourcc == chunks[i].fourcc; });
    if (slot == std::end(slots)) return wrongOrder("a metadata chunk is repeated or out of order", i);
    *slot->index = i;
    next = slot + 1;
    if (chunks[i].raw > limits.max_metadata_bytes - total) {
      return Error{ErrorCode::kLimit, "the metadata are larger than the limits allow", chunks[i].offset};
    }
    total += chunks[i].raw;
  }
  if (found.part == MetadataChunks::kNone) return wrongOrder("the PART chunk is missing", 0);
  if (found.matl == MetadataChunks::kNone) return wrongOrder("the MATL chunk is missing", 0);
  if (found.rigs == MetadataChunks::kNone) return wrongOrder("the RIGS chunk is missing", 0);
  return found;
}

Result<void> findLevels(std::span<const ChunkInfo> chunks, std::span<const Part> parts, LevelChunks& out) {
  std::size_t levels = 0;
  int coarsest = 0;
  for (const Part& part : parts) {
    levels += static_cast<std::size_t>(part.levels);
    coarsest = std::max(coarsest, part.levels - 1);
  }
  // Checked before memory is allocated.
  if (levels > chunks.size()) return wrongOrder("the parts have more levels than there are chunks", 0);
  if (!out.first.reset(parts.size()) || !out.grids.reset(levels) || !out.bricks.reset(levels)) {
    return Error{ErrorCode::kOutOfMemory, "no memory for the table of levels"};
  }
  for (std::size_t p = 1; p < parts.size(); ++p)
    out.first[p] = out.first[p - 1] + static_cast<std::uint32_t>(parts[p - 1].levels);

  std::size_t i = 0;
  const auto expect = [&](std::uint32_t fourcc, int level, std::size_t part) {
    while (i < chunks.size() && !isLevel(chunks[i].fourcc)) ++i;
    if (i == chunks.size() || chunks[i].fourcc != fourcc) return false;
    return chunks[i].level == static_cast<std::uint32_t>(level) && chunks[i].part == part;
  };
  for (int level = coarsest; level >= 0; --level) {
    for (std::size_t p = 0; p < parts.size(); ++p) {
      if (level >= parts[p].levels) continue;
      const std::size_t slot = out.first[p] + static_cast<std::size_t>(level);
      if (!expect(layout::kGrid, level, p)) return wrongOrder("a grid is missing or out of order", i);
      out.grids[slot] = static_cast<std::uint32_t>(i++);
      if (!expect(parts[p].kind == PartKind::kFog ? layout::kFogb : layout::kBrck, level, p))
        return wrongOrder("bricks are missing or out of order", i);
      out.bricks[slot] = static_cast<std::uint32_t>(i++);
    }
  }
  while (i < chunks.size() && !isLevel(chunks[i].fourcc)) ++i;
  if (i < chunks.size()) return wrongOrder("there are more levels than the parts have", i);
  return {};
}

}  // namespace kelp
