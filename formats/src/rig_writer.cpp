// SPDX-License-Identifier: MIT
// Writes a pack again with other rigs: new INFO, RIGS, CLIP, SOCK and CAGE; all other chunks are copied.
#include <algorithm>
#include <cstring>
#include <memory>
#include <new>

#include "coding_libraries.h"
#include "container.h"
#include "kelp/formats/raw_pack.h"
#include "layout.h"
#include "metadata.h"
#include "metadata_writer.h"
#include "page_writer.h"

namespace kelp {
namespace {

// A chunk to write: new bytes, or a copy from the source.
struct ChunkOrigin {
  Pack::ChunkInfo info;    // offset: in the new file
  std::uint64_t from = 0;  // in the source, if it is copied
  const Packed* own = nullptr;
};

class RigWriter {
 public:
  RigWriter(const Source& source, const RawRigs& rigs, const Sink& sink, const PackLimits& limits)
      : source_(source), rigs_(rigs), sink_(sink), limits_(limits) {}

  Result<void> run() {
    if (const Result<void> r = readContainer(source_, limits_, Allocator(), container_); !r) return r;
    const Result<MetadataChunks> found = findMetadata(container_.chunks.span(), limits_);
    if (!found) return found.error();
    if (const Result<void> r = readParts(*found); !r) return r;
    if (const Result<void> r = checkCounts(); !r) return r;
    if (const Result<void> r = packTables(); !r) return r;
    if (const Result<void> r = plan(*found); !r) return r;
    return write();
  }

 private:
  // Reads the parts, which the new tables must fit, and refuses a source whose parts and levels do not
  // match.
  Result<void> readParts(const MetadataChunks& found) {
    const auto readTable = [&](std::size_t index, auto parse) -> Result<void> {
      Buffer<std::byte> bytes;
      const Pack::ChunkInfo& chunk = container_.chunks[index];
      if (const Result<void> r = readChunk(source_, chunk, limits_, bytes, Allocator()); !r) return r;
      if (const Result<void> r = parse(std::span<const std::byte>(bytes.span())); !r)
        return inFile(r.error(), chunk);
      return {};
    };
    using Bytes = std::span<const std::byte>;
    if (const Result<void> r =
            readTable(found.part, [&](Bytes b) { return parseParts(b, limits_, parsed_); });
        !r)
      return r;
    if (const Result<void> r = readTable(found.matl, [&](Bytes b) { return parsePalette(b, parsed_); }); !r)
      return r;
    if (found.jnts != MetadataChunks::kNone)
      if (const Result<void> r = readTable(found.jnts, [&](Bytes b) { return parseJoints(b, parsed_); }); !r)
        return r;
    if (found.cage != MetadataChunks::kNone && !rigs_.cages)
      if (const Result<void> r = readTable(found.cage, [&](Bytes b) { return parseCages(b, parsed_); }); !r)
        return r;
    if (found.fogs == MetadataChunks::kNone) {
      if (const Result<void> r = parseFogs({}, parsed_); !r) return r;
    } else if (const Result<void> r = readTable(found.fogs, [&](Bytes b) { return parseFogs(b, parsed_); });
               !r) {
      return r;
    }
    LevelChunks levels{Allocator()};
    return findLevels(container_.chunks.span(), parsed_.parts.span(), levels);
  }

  static Result<void> judged(const Result<void>& verdict) {
    if (verdict || verdict.error().code == ErrorCode::kOutOfMemory) return verdict;
    return Error{ErrorCode::kMisuse, verdict.error().detail};
  }

  Result<void> checkCounts() {
    if (rigs_.parts.size() != parsed_.parts.size() ||
        (rigs_.cages && rigs_.cages->size() != parsed_.parts.size()))
      return Error{ErrorCode::kMisuse, "there is not a rig, or not a list of cages, for each part"};
    for (const RawRig& rig : rigs_.parts)
      if (rig.knots.size() > static_cast<std::size_t>(kMaxKnots))
        return Error{ErrorCode::kMisuse, "a part has more than 64 knots"};
    std::size_t entries = rigs_.clips.size();
    for (const RawClip& clip : rigs_.clips) {
      if (clip.name.size() > layout::kMaxNameBytes)
        return Error{ErrorCode::kMisuse, "a clip's name is longer than 255 bytes"};
      entries += clip.waves.size() + clip.tracks.size();
      for (const RawTrack& track : clip.tracks) entries += track.keys.size();
    }
    for (const RawSocket& socket : rigs_.sockets)
      if (socket.name.size() > layout::kMaxNameBytes)
        return Error{ErrorCode::kMisuse, "a socket's name is longer than 255 bytes"};
    // The names then fit into 32 bits too.
    if (entries + rigs_.sockets.size() > ~std::uint32_t{0} / 256)
      return Error{ErrorCode::kMisuse, "too many clips, waves, tracks, keys or sockets"};
    return {};
  }

  // Builds the new tables and checks them with the functions of the reader.
  Result<void> packTables() {
    RawPack pack;  // the builders used here read only rigs, clips and sockets
    pack.parts.resize(rigs_.parts.size());
    for (std::size_t i = 0; i < pack.parts.size(); ++i) {
      pack.parts[i].knots = rigs_.parts[i].knots;
      pack.parts[i].automatic_tangents = rigs_.parts[i].automatic_tangents;
      pack.parts[i].parent_at = rigs_.parts[i].parent_at;
      pack.parts[i].bend = rigs_.parts[i].bend;
      pack.parts[i].roll = rigs_.parts[i].roll;
    }
    pack.clips = rigs_.clips;
    pack.sockets = rigs_.sockets;
    Buffer<std::byte> table;
    if (!rigs_.info_json.empty()) {
      if (!table.reset(rigs_.info_json.size())) return kNoMemory;
      std::memcpy(table.data(), rigs_.info_json.data(), rigs_.info_json.size());
      if (const Result<void> r = judged(parseInfo(table.span(), parsed_)); !r) return r;
      if (!packBytes(table.span(), info_)) return kNoMemory;
    }
    if (!buildRigs(pack, table)) return kNoMemory;
    if (const Result<void> r = judged(parseRigs(table.span(), parsed_)); !r) return r;
    if (!packBytes(table.span(), knots_)) return kNoMemory;
    if (!pack.clips.empty()) {
      if (!buildClips(pack, table)) return kNoMemory;
      if (const Result<void> r = judged(parseClips(table.span(), parsed_)); !r) return r;
      if (!packBytes(table.span(), clips_)) return kNoMemory;
    }
    if (!pack.sockets.empty()) {
      if (!buildSockets(pack, table)) return kNoMemory;
      if (const Result<void> r = judged(parseSockets(table.span(), parsed_)); !r) return r;
      if (!packBytes(table.span(), sockets_)) return kNoMemory;
    }
    return packCages(pack, table);
  }

  Result<void> packCages(RawPack& pack, Buffer<std::byte>& table) {
    if (!rigs_.cages) return {};
    for (std::size_t i = 0; i < pack.parts.size(); ++i) {
      RawPart& part = pack.parts[i];
      part.size = parsed_.parts[i].size;
      part.levels.resize(static_cast<std::size_t>(parsed_.parts[i].levels));
      part.cell = (*rigs_.cages)[i].cell;
      part.cages = (*rigs_.cages)[i].cages;
      part.influences = (*rigs_.cages)[i].influences;
      part.morphs = (*rigs_.cages)[i].morphs;
      part.sections = (*rigs_.cages)[i].sections;
      has_new_cages_ = has_new_cages_ || !part.cages.empty();
    }
    if (!has_new_cages_) return {};
    if (const Result<void> r = buildCages(pack, table); !r) return r;
    if (const Result<void> r = judged(parseCages(table.span(), parsed_)); !r) return r;
    return packBytes(table.span(), cages_) ? Result<void>() : kNoMemory;
  }

  void add(std::uint32_t fourcc, std::uint32_t flags, const Packed& own) {
    ChunkOrigin& chunk = chunks_[count_++];
    chunk.own = &own;
    chunk.info.fourcc = fourcc;
    chunk.info.flags = flags | (own.compressed ? layout::kFlagZstd : 0);
    chunk.info.stored = own.stored.size();
    chunk.info.raw = own.raw;
    chunk.info.checksum = own.checksum;
  }

  Result<void> plan(const MetadataChunks& found) {
    chunks_.reset(new (std::nothrow) ChunkOrigin[container_.chunks.size() + 4]);
    if (!chunks_) return kNoMemory;
    if (!rigs_.info_json.empty()) add(layout::kInfo, 0, info_);
    for (std::size_t i = 0; i < container_.chunks.size(); ++i) {
      if (i == found.info || i == found.clip || i == found.sock || (i == found.cage && rigs_.cages)) continue;
      if (i == found.rigs) {
        add(layout::kRigs, layout::kFlagRequired, knots_);
        if (!rigs_.clips.empty()) add(layout::kClip, 0, clips_);
        if (!rigs_.sockets.empty()) add(layout::kSock, 0, sockets_);
      } else {
        chunks_[count_].info = container_.chunks[i];
        chunks_[count_++].from = container_.chunks[i].offset;
      }
      const bool joints = found.jnts != MetadataChunks::kNone;
      if (has_new_cages_ && i == (joints ? found.jnts : found.rigs)) add(layout::kCage, 0, cages_);
    }
    minor_ = container_.minor;
    if (rigs_.cages && minor_ <= kFormatMinor)
      minor_ = minorVersionOf(has_new_cages_, found.jnts != MetadataChunks::kNone,
                              std::any_of(parsed_.parts.begin(), parsed_.parts.end(),
                                          [](const Part& part) { return part.kind == PartKind::kEmpty; }));
    return {};
  }

  Result<void> write() {
    Buffer<std::byte> head;
    if (!head.reset(layout::kHeaderBytes + count_ * layout::kIndexEntryBytes) ||
        !block_.reset(std::size_t{1} << 16))
      return kNoMemory;
    std::uint64_t end = head.size();
    for (std::size_t i = 0; i < count_; ++i) {
      chunks_[i].info.offset = layout::align(end, layout::kAlignment);
      end = chunks_[i].info.offset + chunks_[i].info.stored;
      layout::storeIndexEntry(head.span(), layout::kHeaderBytes + i * layout::kIndexEntryBytes,
                              chunks_[i].info);
    }
    layout::store(head.span(), 0, layout::kIdentifier);
    layout::store(head.span(), 12, kFormatMajor);
    layout::store(head.span(), 14, minor_);
    layout::store(head.span(), 16, end);
    layout::store(head.span(), 24, static_cast<std::uint32_t>(count_));
    layout::store(head.span(), layout::kHeaderChecksum, checksum(head.span()));
    if (const Result<void> r = send(head.span()); !r) return r;
    for (std::size_t i = 0; i < count_; ++i) {
      static constexpr std::byte kZeros[layout::kAlignment] = {};
      if (const Result<void> r =
              send(std::span(kZeros).first(static_cast<std::size_t>(chunks_[i].info.offset - written_)));
          !r)
        return r;
      if (const Result<void> r = chunks_[i].own ? send(chunks_[i].own->stored.span()) : copy(chunks_[i]); !r)
        return r;
    }
    return {};
  }

  Result<void> copy(const ChunkOrigin& chunk) {
    RunningChecksum running;
    for (std::uint64_t done = 0; done < chunk.info.stored;) {
      const auto block = block_.span().first(
          static_cast<std::size_t>(std::min<std::uint64_t>(block_.size(), chunk.info.stored - done)));
      if (const Result<void> r = readBytes(source_, chunk.from + done, block); !r) return r;
      running.add(block);
      if (const Result<void> r = send(block); !r) return r;
      done += block.size();
    }
    if (running.value() != chunk.info.checksum)
      return Error{ErrorCode::kChecksum, "a chunk differs from its checksum", chunk.from};
    return {};
  }

  Result<void> send(std::span<const std::byte> bytes) {
    if (bytes.empty()) return {};
    if (const Result<void> r = sink_.write(sink_.user, bytes); !r)
      return Error{r.error().code, r.error().detail, written_};
    written_ += bytes.size();
    return {};
  }

  const Source& source_;
  const RawRigs& rigs_;
  const Sink& sink_;
  const PackLimits& limits_;
  Container container_{Allocator()};
  Metadata parsed_{Allocator(), limits_.max_metadata_bytes};
  Packed info_, knots_, clips_, sockets_, cages_;
  bool has_new_cages_ = false;
  std::uint16_t minor_ = 0;
  std::unique_ptr<ChunkOrigin[]> chunks_;
  std::size_t count_ = 0;
  Buffer<std::byte> block_;
  std::uint64_t written_ = 0;
};

}  // namespace

Result<void> writeRigs(const Source& source, const RawRigs& rigs, const Sink& sink,
                       const PackLimits& limits) {
  if (!sink.write) return Error{ErrorCode::kMisuse, "the sink has no write function"};
  return RigWriter(source, rigs, sink, limits).run();
}

}  // namespace kelp
