// SPDX-License-Identifier: MIT
// Checks everything, packs everything, then writes from the first byte to the last.
#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>
#include <new>

#include "coding_libraries.h"
#include "kelp/formats/fog.h"
#include "kelp/formats/page.h"
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
    for (const RawJoint& joint : pack_.joints) {
      if (joint.name.size() > layout::kMaxNameBytes) return misuse("a joint's name is longer than 255 bytes");
      entries += 1 + joint.parts.size();
    }
    if (entries > kMost || levels_ > kMost || distance_levels_ > kMost || pack_.sockets.size() > kMost)
      return misuse("too many levels, waves, tracks, keys, sockets or joints");
    return {};
  }

  // Builds the tables and checks them with the functions of the reader.
  Result<void> packMetadata() {
    chunks_.reset(new (std::nothrow) ChunkPlan[kMetadataChunks + 2 * (levels_ + distance_levels_)]);
    if (!chunks_) return kNoMemory;
    PackLimits limits;
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
    if (!pack_.sockets.empty()) {
      if (!buildSockets(pack_, table)) return kNoMemory;
      if (const Result<void> r = add(layout::kSock, false, parseSockets(table.span(), parsed)); !r) return r;
    }
    if (!pack_.joints.empty()) {
      if (!buildJoints(pack_, table)) return kNoMemory;
      if (const Result<void> r = add(layout::kJnts, false, parseJoints(table.span(), parsed)); !r) return r;
    }
    if (!hasCages()) return {};
    if (const Result<void> r = buildCages(pack_, table); !r) return r;
    return add(layout::kCage, false, parseCages(table.span(), parsed));
  }

  bool hasCages() const {
    return std::any_of(pack_.parts.begin(), pack_.parts.end(),
                       [](const RawPart& part) { return !part.cages.empty(); });
  }

  Result<void> packLevels() {
    plans_.reset(new (std::nothrow) LevelPlan[levels_ + distance_levels_]);
    if (!plans_) return kNoMemory;
    if (const Result<void> r = checkDistanceLevels(); !r) return r;
    // In the order of the file: levels coarse to fine, then parts; voxels, then distances.
    for (const bool distances : {false, true}) {
      const auto countOf = [distances](const RawPart& part) {
        return distances ? part.distances.size() : part.levels.size();
      };
      std::size_t coarsest = 0;
      for (const RawPart& part : pack_.parts) coarsest = std::max(coarsest, countOf(part));
      for (std::size_t level = coarsest; level-- > 0;) {
        for (std::size_t part = 0; part < pack_.parts.size(); ++part) {
          if (level >= countOf(pack_.parts[part])) continue;
          LevelPlan& plan = plans_[plan_count_++];
          plan.index = level;
          plan.part = part;
          if (const Result<void> r = planLevel(pack_.parts[part], distances, plan); !r) return r;
        }
      }
    }
    std::size_t count = 0;
    for (const LevelPlan& plan : plans()) count += plan.pages;
    pages_.reset(new (std::nothrow) PagePlan[count]);
    packed_.reset(new (std::nothrow) Packed[count]);
    if (!pages_ || !packed_) return kNoMemory;
    std::size_t first = 0;
    for (const LevelPlan& plan : plans()) first += planPages(plan, {pages_.get() + first, plan.pages});
    if (const Result<void> r = packPages({pages_.get(), count}, {packed_.get(), count}, threads_, effort_);
        !r)
      return r;
    first = 0;
    for (const LevelPlan& plan : plans()) {
      if (!addLevel(plan, first)) return kNoMemory;
      first += plan.pages;
    }
    return {};
  }

  // All solid parts have distances, or none has.
  Result<void> checkDistanceLevels() const {
    const bool any = std::any_of(pack_.parts.begin(), pack_.parts.end(),
                                 [](const RawPart& part) { return !part.distances.empty(); });
    for (const RawPart& part : pack_.parts) {
      const int wanted = any && !part.fog && !part.levels.empty()
                             ? distanceLevels(part.size, static_cast<int>(part.levels.size()))
                             : 0;
      if (part.distances.size() != static_cast<std::size_t>(wanted))
        return misuse("a part does not have the levels of distances that it needs");
    }
    return {};
  }

  // Checks a level, and finds its bricks and how many pages they take.
  Result<void> planLevel(const RawPart& part, bool distances, LevelPlan& plan) const {
    const glm::ivec3 size = levelSize(part.size, static_cast<int>(plan.index));
    if (distances) {
      plan.distances = &part.distances[plan.index];
      plan.lattice = {size, PageInfo::kDistances};
      if (const Result<void> r = checkRawDistances(*plan.distances, size); !r) return r;
    } else {
      plan.raw = &part.levels[plan.index];
      plan.above = part.fog || plan.index + 1 == part.levels.size() ? nullptr : &part.levels[plan.index + 1];
      plan.lattice = {latticeSize(part.fog ? PartKind::kFog : PartKind::kSolid, size),
                      part.fog ? part.fog->ramp.empty() ? 1 : 2 : 0};
      plan.palette = pack_.palette.size();
      if (const Result<void> r = checkRawLevel(part, plan.index, plan.palette); !r) return r;
    }
    const auto isStored = [&](std::uint64_t cell) {
      return isStoredCell(plan.cells()[static_cast<std::size_t>(cell)]);
    };
    std::size_t count = 0;
    for (std::size_t cell = 0; cell < plan.cells().size(); ++cell) count += isStored(cell) ? 1 : 0;
    if (!plan.bricks.reset(count)) return kNoMemory;
    std::size_t slot = 0;
    for (MortonWalk walk(brickGrid(plan.lattice.size)); !walk.done(); walk.next())
      if (isStored(walk.index())) plan.bricks[slot++] = walk.cell();
    plan.pages = planPages(plan, {});
    return plan.pages < kMaxPages ? Result<void>() : misuse("a level has more than 131071 pages");
  }

  // Adds the two chunks of a level, whose pages begin with `first`. False: no memory.
  bool addLevel(const LevelPlan& plan, std::size_t first) {
    ChunkPlan& grid = chunks_[chunk_count_++];
    ChunkPlan& bricks = chunks_[chunk_count_++];
    bricks.pages = {packed_.get() + first, plan.pages};
    if (!packGrid(plan, {pages_.get() + first, plan.pages}, bricks.pages, grid.own)) return false;
    const bool distances = plan.lattice.distances();
    const std::uint32_t flags = distances ? 0 : layout::kFlagRequired;
    const auto level = static_cast<std::uint32_t>(plan.index), part = static_cast<std::uint32_t>(plan.part);
    describe(grid, distances ? layout::kDgrd : layout::kGrid, flags, level, part);
    describe(bricks,
             distances                   ? layout::kDist
             : plan.lattice.channels > 0 ? layout::kFogb
                                         : layout::kBrck,
             flags, level, part);
    return true;
  }

  // Cells, padding to 8 bytes, page table.
  static bool packGrid(const LevelPlan& level, std::span<const PagePlan> plans, std::span<const Packed> pages,
                       Packed& out) {
    const std::size_t cells_at = level.distances ? layout::kDgrdHeader : 0,
                      table_at = static_cast<std::size_t>(layout::align(cells_at + level.cells().size(), 8));
    Buffer<std::byte> raw;
    if (!raw.reset(table_at + pages.size() * layout::kPageEntryBytes)) return false;
    if (level.distances) {
      layout::store(raw.span(), 0, level.distances->band.outside);
      layout::store(raw.span(), 1, level.distances->band.inside);
    }
    storeCells(level.cells(), level.lattice, raw.span().subspan(cells_at));
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
    layout::store(head.span(), 14, minorVersionOf(hasCages(), !pack_.joints.empty(), any_empty));
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

  std::span<const LevelPlan> plans() const { return {plans_.get(), plan_count_}; }

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

  static constexpr std::size_t kMetadataChunks = 9;

  const RawPack& pack_;
  const Sink& sink_;
  const int threads_;
  const Effort effort_;
  std::size_t levels_ = 0, distance_levels_ = 0;
  std::unique_ptr<ChunkPlan[]> chunks_;
  std::size_t chunk_count_ = 0;
  std::unique_ptr<LevelPlan[]> plans_;
  std::size_t plan_count_ = 0;
  std::unique_ptr<PagePlan[]> pages_;
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
