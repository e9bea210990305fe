// SPDX-License-Identifier: MIT
// The order of chunks: INFO PART MATL FOGS RIGS CLIP SOCK JNTS CAGE; then for each level, coarse to fine, and
// for each part, GRID and BRCK or FOGB; then for each level of distances and each solid part, DGRD and DIST,
// or none of these. Unknown optional chunks may stand anywhere between.
#include <algorithm>

#include "container.h"
#include "kelp/formats/distance.h"
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
         fourcc == kClip || fourcc == kSock || fourcc == kJnts || fourcc == kCage;
}

bool isLevel(std::uint32_t fourcc) { return layout::isGrid(fourcc) || layout::isPages(fourcc); }

// Goes through the chunks of levels, and skips the others.
class LevelWalk {
 public:
  explicit LevelWalk(std::span<const ChunkInfo> chunks) : chunks_(chunks) {}

  std::size_t index() {
    while (at_ < chunks_.size() && !isLevel(chunks_[at_].fourcc)) ++at_;
    return at_;
  }
  bool done() { return index() == chunks_.size(); }
  // Takes the next chunk if it is this one.
  bool take(std::uint32_t fourcc, int level, std::size_t part, std::uint32_t& index_out) {
    if (done()) return false;
    const ChunkInfo& chunk = chunks_[at_];
    if (chunk.fourcc != fourcc || chunk.level != static_cast<std::uint32_t>(level) || chunk.part != part)
      return false;
    index_out = static_cast<std::uint32_t>(at_++);
    return true;
  }

 private:
  std::span<const ChunkInfo> chunks_;
  std::size_t at_ = 0;
};

Result<void> findDistances(LevelWalk& walk, std::span<const ChunkInfo> chunks, std::span<const Part> parts,
                           LevelChunks& out) {
  const auto levelsOf = [](const Part& part) {
    return part.kind == PartKind::kSolid ? distanceLevels(part.size, part.levels) : 0;
  };
  std::size_t levels = 0;
  int coarsest = 0;
  for (const Part& part : parts) {
    levels += static_cast<std::size_t>(levelsOf(part));
    coarsest = std::max(coarsest, levelsOf(part) - 1);
  }
  if (levels > chunks.size()) return wrongOrder("distances of some levels are missing", walk.index());
  if (!out.first_distances.reset(parts.size()) || !out.distance_grids.reset(levels) ||
      !out.distance_pages.reset(levels))
    return Error{ErrorCode::kOutOfMemory, "no memory for the table of levels"};
  for (std::size_t p = 1; p < parts.size(); ++p)
    out.first_distances[p] = out.first_distances[p - 1] + static_cast<std::uint32_t>(levelsOf(parts[p - 1]));
  for (int level = coarsest; level >= 0; --level) {
    for (std::size_t p = 0; p < parts.size(); ++p) {
      if (level >= levelsOf(parts[p])) continue;
      const std::size_t slot = out.first_distances[p] + static_cast<std::size_t>(level);
      if (!walk.take(layout::kDgrd, level, p, out.distance_grids[slot]) ||
          !walk.take(layout::kDist, level, p, out.distance_pages[slot]))
        return wrongOrder("distances are missing or out of order", walk.index());
    }
  }
  return {};
}

}  // namespace

Result<MetadataChunks> findMetadata(std::span<const ChunkInfo> chunks, const PackLimits& limits) {
  MetadataChunks found;
  struct Slot {
    std::uint32_t fourcc;
    std::size_t* index;
  };
  const Slot slots[] = {
      {layout::kInfo, &found.info}, {layout::kPart, &found.part}, {layout::kMatl, &found.matl},
      {layout::kFogs, &found.fogs}, {layout::kRigs, &found.rigs}, {layout::kClip, &found.clip},
      {layout::kSock, &found.sock}, {layout::kJnts, &found.jnts}, {layout::kCage, &found.cage}};
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

  LevelWalk walk(chunks);
  for (int level = coarsest; level >= 0; --level) {
    for (std::size_t p = 0; p < parts.size(); ++p) {
      if (level >= parts[p].levels) continue;
      const std::size_t slot = out.first[p] + static_cast<std::size_t>(level);
      if (!walk.take(layout::kGrid, level, p, out.grids[slot]))
        return wrongOrder("a grid is missing or out of order", walk.index());
      if (!walk.take(parts[p].kind == PartKind::kFog ? layout::kFogb : layout::kBrck, level, p,
                     out.bricks[slot]))
        return wrongOrder("bricks are missing or out of order", walk.index());
    }
  }
  if (!walk.done() && chunks[walk.index()].fourcc == layout::kDgrd) {
    if (const Result<void> found = findDistances(walk, chunks, parts, out); !found) return found;
  }
  if (!walk.done()) return wrongOrder("there are more levels than the parts have", walk.index());
  return {};
}

}  // namespace kelp
