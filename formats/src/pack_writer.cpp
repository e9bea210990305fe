// SPDX-License-Identifier: MIT
// Checks everything, packs everything, then writes from the first byte to the last.
#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>
#include <new>

#include "coding_libraries.h"
#include "kelp/formats/fog.h"
#include "kelp/formats/raw_pack.h"
#include "layout.h"
#include "metadata.h"
#include "metadata_writer.h"
#include "morton_walk.h"
#include "page_writer.h"
#include "voxels.h"

namespace kelp {
namespace {

// A chunk to write: bytes of its own, or pages.
struct ChunkPlan {
  Pack::ChunkInfo info;
  Packed own;
  std::span<const Packed> pages;
};

// A level of distances to write.
struct DistancePlan {
  std::size_t index = 0, part = 0;
  const RawDistances* raw = nullptr;
  DistanceLevel level;
  Buffer<std::uint32_t> bricks;  // of `level`
};

class Writer {
 public:
  Writer(const RawPack& pack, const Sink& sink, int threads, Effort effort)
      : pack_(pack), sink_(sink), threads_(threads), effort_(effort) {}

  Result<void> run() {
    if (const Result<void> r = checkSizes(); !r) return r;
    if (const Result<void> r = packMetadata(); !r) return r;
    if (const Result<void> r = packLevels(); !r) return r;
    return write();
  }

 private:
  // Checks that counts fit the 32 bits of the format, and what later steps rely on.
  Result<void> checkSizes() {
    // The bytes of every table then fit into 32 bits too.
    constexpr std::size_t kMost = std::numeric_limits<std::uint32_t>::max() / 64;
    if (pack_.parts.size() > kMost || pack_.clips.size() > kMost) return misuse("too many parts or clips");
    std::size_t entries = 0;
    for (const RawPart& part : pack_.parts) {
      if (part.name.size() > layout::kMaxNameBytes) return misuse("a part's name is longer than 255 bytes");
      if (part.knots.size() > static_cast<std::size_t>(kMaxKnots))
        return misuse("a part has more than 64 knots");
      levels_ += part.levels.size();
      distance_levels_ += part.distances.size();
    }
    for (const RawClip& clip : pack_.clips) {
      if (clip.name.size() > layout::kMaxNameBytes) return misuse("a clip's name is longer than 255 bytes");
      entries += clip.waves.size() + clip.tracks.size();
      for (const RawTrack& track : clip.tracks) entries += track.keys.size();
    }
    for (const RawSocket& socket : pack_.sockets)
      if (socket.name.size() > layout::kMaxNameBytes)
        return misuse("a socket's name is longer than 255 bytes");
    if (entries > kMost || levels_ > kMost || distance_levels_ > kMost || pack_.sockets.size() > kMost)
      return misuse("too many levels, waves, tracks, keys or sockets");
    return {};
  }

  // Builds the tables and checks them with the functions of the reader.
  Result<void> packMetadata() {
    chunks_.reset(new (std::nothrow) ChunkPlan[kMetadataChunks + 2 * (levels_ + distance_levels_)]);
    if (!chunks_) return kNoMemory;
    Limits limits;
    limits.max_side = layout::kMaxSide;
    limits.max_parts = std::numeric_limits<std::uint32_t>::max();
    Metadata parsed(Allocator(), std::numeric_limits<std::uint64_t>::max());
    Buffer<std::byte> table;
    const auto add = [&](std::uint32_t fourcc, bool required, const Result<void>& verdict) -> Result<void> {
      if (!verdict)
        return verdict.error().code == ErrorCode::kOutOfMemory ? verdict.error()
                                                               : misuse(verdict.error().detail);
      ChunkPlan& chunk = chunks_[chunk_count_++];
      if (!packBytes(table.span(), chunk.own)) return kNoMemory;
      describe(chunk, fourcc, required ? layout::kFlagRequired : 0, 0, 0);
      return {};
    };
    if (!pack_.info_json.empty()) {
      if (!table.reset(pack_.info_json.size())) return kNoMemory;
      std::memcpy(table.data(), pack_.info_json.data(), pack_.info_json.size());
      if (const Result<void> r = add(layout::kInfo, false, parseInfo(table.span(), parsed)); !r) return r;
    }
    if (!buildParts(pack_, table)) return kNoMemory;
    if (const Result<void> r = add(layout::kPart, true, parseParts(table.span(), limits, parsed)); !r)
      return r;
    if (!buildPalette(pack_, table)) return kNoMemory;
    if (const Result<void> r = add(layout::kMatl, true, parsePalette(table.span(), parsed)); !r) return r;
    if (!buildFogs(pack_, table)) return kNoMemory;
    if (!table.empty()) {
      if (const Result<void> r = add(layout::kFogs, true, parseFogs(table.span(), parsed)); !r) return r;
    }
    if (!buildRigs(pack_, table)) return kNoMemory;
    if (const Result<void> r = add(layout::kRigs, true, parseRigs(table.span(), parsed)); !r) return r;
    if (!pack_.clips.empty()) {
      if (!buildClips(pack_, table)) return kNoMemory;
      if (const Result<void> r = add(layout::kClip, false, parseClips(table.span(), parsed)); !r) return r;
    }
    if (pack_.sockets.empty()) return {};
    if (!buildSockets(pack_, table)) return kNoMemory;
    return add(layout::kSock, false, parseSockets(table.span(), parsed));
  }

  Result<void> packLevels() {
    if (const Result<void> r = planDistances(); !r) return r;
    levels_of_.reset(new (std::nothrow) LevelPlan[levels_]);
    if (!levels_of_) return kNoMemory;
    std::size_t page_count = 0, plan_count = 0, coarsest = 0;
    for (const RawPart& part : pack_.parts) {
      for (std::size_t level = 0; level < part.levels.size(); ++level) {
        if (const Result<void> r = checkRawLevel(part, level, pack_.palette.size()); !r) return r;
        LevelPlan& plan = levels_of_[plan_count++];
        if (const Result<void> r = planLevel(part, level, plan); !r) return r;
        const std::size_t pages = planPages(plan, {});
        if (pages >= kMaxPages) return misuse("a level has more than 131071 pages");
        page_count += pages;
      }
      coarsest = std::max(coarsest, part.levels.size());
    }
    for (const DistancePlan& plan : distances()) page_count += planPages(plan.level, plan.raw->codes, {});
    plans_.reset(new (std::nothrow) PagePlan[page_count]);
    packed_.reset(new (std::nothrow) Packed[page_count]);
    if (!plans_ || !packed_) return kNoMemory;
    const std::span<PagePlan> plans(plans_.get(), page_count);

    // In the order of the file: levels coarse to fine, then parts; voxels, then distances.
    std::size_t first = 0;
    for (std::size_t level = coarsest; level-- > 0;) {
      std::size_t of_part = 0;  // its first level
      for (std::size_t part = 0; part < pack_.parts.size(); ++part) {
        const std::size_t count = pack_.parts[part].levels.size();
        if (level < count)
          first += addLevel(level, part, first, planPages(levels_of_[of_part + level], plans.subspan(first)));
        of_part += count;
      }
    }
    for (const DistancePlan& plan : distances())
      first += addLevel(plan.index, plan.part, first,
                        planPages(plan.level, plan.raw->codes, plans.subspan(first)));
    if (const Result<void> r = packPages(plans, {packed_.get(), page_count}, threads_, effort_); !r) return r;
    return packGrids();
  }

  // The level was checked.
  Result<void> planLevel(const RawPart& part, std::size_t index, LevelPlan& plan) const {
    plan.raw = &part.levels[index];
    plan.above = part.fog || index + 1 == part.levels.size() ? nullptr : &part.levels[index + 1];
    plan.size = levelSize(part.size, static_cast<int>(index));
    plan.palette = pack_.palette.size();
    if (part.fog) return {};
    if (!plan.bricks.reset(plan.raw->codes.size() / kBrickVoxels)) return kNoMemory;
    std::size_t slot = 0;
    for (MortonWalk walk(brickGrid(plan.size)); !walk.done(); walk.next()) {
      if (isStoredCell(plan.raw->cells[static_cast<std::size_t>(walk.index())]))
        plan.bricks[slot++] = walk.cell();
    }
    return {};
  }

  // All solid parts have distances, in the order of the file, or none has.
  Result<void> planDistances() {
    std::size_t coarsest = 0;
    const bool any = std::any_of(pack_.parts.begin(), pack_.parts.end(),
                                 [](const RawPart& part) { return !part.distances.empty(); });
    for (const RawPart& part : pack_.parts) {
      const int wanted = any && !part.fog && !part.levels.empty()
                             ? distanceLevels(part.size, static_cast<int>(part.levels.size()))
                             : 0;
      if (part.distances.size() != static_cast<std::size_t>(wanted))
        return misuse("a part does not have the levels of distances that it needs");
      coarsest = std::max(coarsest, part.distances.size());
    }
    distances_.reset(new (std::nothrow) DistancePlan[distance_levels_]);
    if (!distances_) return kNoMemory;
    for (std::size_t level = coarsest; level-- > 0;) {
      for (std::size_t part = 0; part < pack_.parts.size(); ++part) {
        if (level >= pack_.parts[part].distances.size()) continue;
        DistancePlan& plan = distances_[distance_count_++];
        plan.index = level;
        plan.part = part;
        plan.raw = &pack_.parts[part].distances[level];
        const glm::ivec3 size = levelSize(pack_.parts[part].size, static_cast<int>(level));
        plan.level = {size, brickGrid(size), plan.raw->band, plan.raw->cells, {}};
        const Result<std::uint32_t> bricks = checkRawDistances(*plan.raw, plan.level.grid);
        if (!bricks) return bricks.error();
        if (!plan.bricks.reset(*bricks)) return kNoMemory;
        listBricks(plan.raw->cells, plan.level.grid, plan.bricks.span());
        plan.level.bricks = plan.bricks.span();
      }
    }
    return {};
  }

  // Adds the two chunks of a level; returns the number of its pages.
  std::size_t addLevel(std::size_t level, std::size_t part, std::size_t first, std::size_t pages) {
    ChunkPlan& grid = chunks_[chunk_count_++];
    ChunkPlan& bricks = chunks_[chunk_count_++];
    bricks.pages = {packed_.get() + first, pages};
    grid.info.level = bricks.info.level = static_cast<std::uint32_t>(level);
    grid.info.part = bricks.info.part = static_cast<std::uint32_t>(part);
    return pages;
  }

  Result<void> packGrids() {
    for (std::size_t i = 0; i < chunk_count_; ++i) {
      if (chunks_[i].pages.empty()) continue;
      ChunkPlan& grid = chunks_[i - 1];
      ChunkPlan& bricks = chunks_[i];
      const std::size_t page = static_cast<std::size_t>(bricks.pages.data() - packed_.get());
      if (!packGrid({plans_.get() + page, bricks.pages.size()}, bricks.pages, grid.own)) return kNoMemory;
      const bool distances = plans_[page].distances != nullptr;
      describe(grid, distances ? layout::kDgrd : layout::kGrid, distances ? 0 : layout::kFlagRequired,
               grid.info.level, grid.info.part);
      describe(bricks,
               distances                           ? layout::kDist
               : pack_.parts[bricks.info.part].fog ? layout::kFogb
                                                   : layout::kBrck,
               distances ? 0 : layout::kFlagRequired, bricks.info.level, bricks.info.part);
    }
    return {};
  }

  // Cells, padding to 8 bytes, page table.
  static bool packGrid(std::span<const PagePlan> plans, std::span<const Packed> pages, Packed& out) {
    const DistanceLevel* const distances = plans.front().distances;
    const LevelPlan* const level = plans.front().level;
    const std::size_t cells = distances ? layout::kDgrdHeader + distances->cells.size()
                                        : level->raw->cells.size(),
                      table_at = static_cast<std::size_t>(layout::align(cells, 8));
    Buffer<std::byte> raw;
    if (!raw.reset(table_at + pages.size() * layout::kPageEntryBytes)) return false;
    if (distances)
      storeDistanceCells(*distances, raw.span());
    else
      storeCells(level->raw->cells,
                 brickGrid(latticeSize(level->raw->density.empty() ? PartKind::kSolid : PartKind::kFog,
                                       level->size)),
                 raw.span());
    std::uint64_t offset = 0;
    for (std::size_t i = 0; i < pages.size(); ++i) {
      const std::size_t at = table_at + i * layout::kPageEntryBytes;
      layout::store(raw.span(), at, offset);
      layout::store(raw.span(), at + 8, static_cast<std::uint32_t>(pages[i].stored.size()));
      layout::store(raw.span(), at + 12, static_cast<std::uint32_t>(pages[i].raw));
      layout::store(raw.span(), at + 16, pages[i].checksum);
      layout::store(raw.span(), at + 24, plans[i].first_slot);
      layout::store(raw.span(), at + 28, plans[i].count);
      offset += pages[i].stored.size();
    }
    return packBytes(raw.span(), out);
  }

  // Fills the index entry of a chunk whose bytes are known, except for its offset.
  static void describe(ChunkPlan& chunk, std::uint32_t fourcc, std::uint32_t flags, std::uint32_t level,
                       std::uint32_t part) {
    Pack::ChunkInfo& info = chunk.info;
    info.fourcc = fourcc;
    info.flags = flags | (chunk.own.compressed ? layout::kFlagZstd : 0);
    info.level = level;
    info.part = part;
    if (chunk.pages.empty()) {
      info.stored = chunk.own.stored.size();
      info.raw = chunk.own.raw;
      info.checksum = chunk.own.checksum;
      return;
    }
    RunningChecksum running;
    for (const Packed& page : chunk.pages) {
      info.stored += page.stored.size();
      running.add(page.stored.span());
    }
    info.raw = info.stored;
    info.checksum = running.value();
  }

  Result<void> write() {
    Buffer<std::byte> head;
    if (!head.reset(layout::kHeaderBytes + chunk_count_ * layout::kIndexEntryBytes)) return kNoMemory;
    std::uint64_t end = head.size();
    for (std::size_t i = 0; i < chunk_count_; ++i) {
      Pack::ChunkInfo& info = chunks_[i].info;
      info.offset = layout::align(end, layout::kAlignment);
      end = info.offset + info.stored;
      layout::storeIndexEntry(head.span(), layout::kHeaderBytes + i * layout::kIndexEntryBytes, info);
    }
    layout::store(head.span(), 0, layout::kIdentifier);
    layout::store(head.span(), 12, kFormatMajor);
    const bool any_empty = std::any_of(pack_.parts.begin(), pack_.parts.end(),
                                       [](const RawPart& part) { return part.levels.empty(); });
    layout::store(head.span(), 14, static_cast<std::uint16_t>(any_empty ? 1 : 0));
    layout::store(head.span(), 16, end);
    layout::store(head.span(), 24, static_cast<std::uint32_t>(chunk_count_));
    layout::store(head.span(), layout::kHeaderChecksum, checksum(head.span()));

    bool taken = send(head.span());
    for (std::size_t i = 0; i < chunk_count_ && taken; ++i) {
      const ChunkPlan& chunk = chunks_[i];
      taken = pad(chunk.info.offset) && (chunk.pages.empty() ? send(chunk.own.stored.span()) : true);
      for (std::size_t page = 0; page < chunk.pages.size() && taken; ++page)
        taken = send(chunk.pages[page].stored.span());
    }
    if (!taken) return refusal_;
    return {};
  }

  std::span<const DistancePlan> distances() const { return {distances_.get(), distance_count_}; }

  bool send(std::span<const std::byte> bytes) {
    if (const Result<void> r = sink_.write(sink_.user, bytes); !r) {
      refusal_ = {r.error().code, r.error().detail, written_};
      return false;
    }
    written_ += bytes.size();
    return true;
  }

  bool pad(std::uint64_t offset) {
    static constexpr std::byte kZeros[layout::kAlignment] = {};
    return offset == written_ || send(std::span(kZeros).first(static_cast<std::size_t>(offset - written_)));
  }

  static constexpr std::size_t kMetadataChunks = 7;

  const RawPack& pack_;
  const Sink& sink_;
  const int threads_;
  const Effort effort_;
  std::size_t levels_ = 0, distance_levels_ = 0;
  std::unique_ptr<ChunkPlan[]> chunks_;
  std::size_t chunk_count_ = 0;
  std::unique_ptr<DistancePlan[]> distances_;
  std::size_t distance_count_ = 0;
  std::unique_ptr<LevelPlan[]> levels_of_;  // part by part, finest first
  std::unique_ptr<PagePlan[]> plans_;
  std::unique_ptr<Packed[]> packed_;
  std::uint64_t written_ = 0;
  Error refusal_;  // of the sink
};

}  // namespace

Result<void> writePack(const RawPack& pack, const Sink& sink, int threads, Effort effort) {
  if (!sink.write) return misuse("the sink has no write function");
  if (threads < 1) return misuse("the number of threads is less than 1");
  return Writer(pack, sink, threads, effort).run();
}

}  // namespace kelp
