// SPDX-License-Identifier: MIT
#include <memory>
#include <new>
#include <utility>

#include "container.h"
#include "kelp/formats/level.h"
#include "layout.h"
#include "metadata.h"
#include "voxels.h"

namespace kelp {

struct Pack::Impl {
  Impl(const Source& from, const PackLimits& at_most, const Allocator& memory)
      : source(from),
        limits(at_most),
        allocator(memory),
        container(memory),
        metadata(memory, at_most.max_metadata_bytes),
        levels(memory) {
    if (source.acquire) source.acquire(source.user);
  }
  ~Impl() {
    if (source.release) source.release(source.user);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  Source source;
  PackLimits limits;
  Allocator allocator;
  Container container;
  Metadata metadata;
  LevelChunks levels;

  Result<void> read();
  Result<void> readMetadata();

  // grid, pages: the level's chunks.
  Result<LevelGrid> readGrid(std::size_t grid, std::size_t pages, const Lattice& lattice,
                             bool coarsest) const {
    const ChunkInfo& chunk = container.chunks[grid];
    Result<LevelGrid> read =
        readLevelGrid(source, chunk, container.chunks[pages], lattice, limits, allocator);
    if (!read) return read;
    read->part = static_cast<int>(chunk.part);
    read->level = static_cast<int>(chunk.level);
    read->coarsest = coarsest;
    return read;
  }
};

Result<void> Pack::Impl::readMetadata() {
  const Result<MetadataChunks> found = findMetadata(container.chunks.span(), limits);
  if (!found) return found.error();
  Buffer<std::byte> bytes(allocator);
  const auto readTable = [&](std::size_t index, auto parse) -> Result<void> {
    if (index == MetadataChunks::kNone) return {};
    const ChunkInfo& chunk = container.chunks[index];
    if (const Result<void> read = readChunk(source, chunk, limits, bytes, allocator); !read) return read;
    if (const Result<void> parsed = parse(std::span<const std::byte>(bytes.span())); !parsed)
      return inFile(parsed.error(), chunk);
    return {};
  };
  using Bytes = std::span<const std::byte>;
  if (const Result<void> r = readTable(found->info, [&](Bytes b) { return parseInfo(b, metadata); }); !r)
    return r;
  if (const Result<void> r = readTable(found->part, [&](Bytes b) { return parseParts(b, limits, metadata); });
      !r)
    return r;
  if (const Result<void> r = readTable(found->matl, [&](Bytes b) { return parsePalette(b, metadata); }); !r)
    return r;
  if (found->fogs == MetadataChunks::kNone) {
    if (const Result<void> r = parseFogs({}, metadata); !r) return r;
  }
  if (const Result<void> r = readTable(found->fogs, [&](Bytes b) { return parseFogs(b, metadata); }); !r)
    return r;
  if (const Result<void> r = readTable(found->rigs, [&](Bytes b) { return parseRigs(b, metadata); }); !r)
    return r;
  if (const Result<void> r = readTable(found->clip, [&](Bytes b) { return parseClips(b, metadata); }); !r)
    return r;
  if (const Result<void> r = readTable(found->sock, [&](Bytes b) { return parseSockets(b, metadata); }); !r)
    return r;
  if (const Result<void> r = readTable(found->jnts, [&](Bytes b) { return parseJoints(b, metadata); }); !r)
    return r;
  return readTable(found->cage, [&](Bytes b) { return parseCages(b, metadata); });
}

Result<void> Pack::Impl::read() {
  if (const Result<void> r = readContainer(source, limits, allocator, container); !r) return r;
  if (const Result<void> r = readMetadata(); !r) return r;
  return findLevels(container.chunks.span(), metadata.parts.span(), levels);
}

Pack::Pack(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Pack::Pack(Pack&&) noexcept = default;
Pack& Pack::operator=(Pack&&) noexcept = default;
Pack::~Pack() = default;

Result<Pack> Pack::open(const Source& source, const PackLimits& limits, const Allocator& allocator) {
  if (!allocator.allocate || !allocator.deallocate)
    return Error{ErrorCode::kMisuse, "the allocator lacks a function"};
  std::unique_ptr<Impl> impl(new (std::nothrow) Impl(source, limits, allocator));
  if (!impl) return Error{ErrorCode::kOutOfMemory, "no memory for the pack"};
  if (const Result<void> read = impl->read(); !read) return read.error();
  return Pack(std::move(impl));
}

std::uint16_t Pack::minorVersion() const { return impl_->container.minor; }
std::uint64_t Pack::fileSize() const { return impl_->container.file_size; }
std::string_view Pack::infoJson() const { return {impl_->metadata.info.data(), impl_->metadata.info.size()}; }
std::span<const Part> Pack::parts() const { return impl_->metadata.parts.span(); }
std::span<const Material> Pack::palette() const { return impl_->metadata.palette.span(); }
std::span<const Clip> Pack::clips() const { return impl_->metadata.clips.span(); }
std::span<const Socket> Pack::sockets() const { return impl_->metadata.sockets.span(); }
std::span<const Joint> Pack::joints() const { return impl_->metadata.joints.span(); }
std::span<const Pack::ChunkInfo> Pack::chunks() const { return impl_->container.chunks.span(); }

Result<LevelGrid> Pack::readGrid(int part, int level) const {
  const std::span<const Part> all = parts();
  if (part < 0 || static_cast<std::size_t>(part) >= all.size())
    return Error{ErrorCode::kMisuse, "there is no such part"};
  const Part& of = all[static_cast<std::size_t>(part)];
  if (level < 0 || level >= of.levels) return Error{ErrorCode::kMisuse, "the part has no such level"};
  const std::size_t slot =
      impl_->levels.first[static_cast<std::size_t>(part)] + static_cast<std::size_t>(level);
  return impl_->readGrid(impl_->levels.grids[slot], impl_->levels.bricks[slot], latticeOf(of, level),
                         level + 1 == of.levels);
}

Result<void> Pack::readPage(const LevelGrid& grid, std::size_t index, const LevelAbove& above,
                            std::span<std::uint32_t> words, PageData& out) const {
  const std::uint64_t size = impl_->container.file_size;
  if (index >= grid.pages.size()) return Error{ErrorCode::kMisuse, "the grid has no such page"};
  const PageInfo& page = grid.pages[index];
  if (!isPossiblePage(page) || page.offset > size || page.stored > size - page.offset)
    return Error{ErrorCode::kMisuse, "the page is not from a grid of this pack"};
  if (words.size() != pageWords(page)) return Error{ErrorCode::kMisuse, "a page has other words than given"};
  if (page.channels == PageInfo::kDistances)
    return decodeDistancePage(impl_->source, grid, index, words, out);
  if (page.channels > 0) {
    if (const Result<void> decoded = decodeFogPage(impl_->source, page, out); !decoded) return decoded;
    if (findClearBrick(out.fog.span(), page.channels) >= 0)
      return Error{ErrorCode::kCorrupt, "a stored brick holds no fog", page.offset};
    writeFog(page, out.fog.span(), words);
    return {};
  }
  if (!grid.coarsest &&
      (!above.grid || above.grid->part != grid.part || above.grid->level != grid.level + 1 ||
       above.shapes.size() != above.grid->bricks.size()))
    return Error{ErrorCode::kMisuse, "a page of voxels needs the next coarser level of its part"};
  return decodeSolidPage(impl_->source, grid, index, above, palette().size(), words, out);
}

Result<void> Pack::readPage(const LevelGrid& grid, std::size_t page, const LevelAbove& above,
                            PageData& out) const {
  if (page >= grid.pages.size() || !isPossiblePage(grid.pages[page]))
    return Error{ErrorCode::kMisuse, "the grid has no such page"};
  if (!out.words.reuse(pageWords(grid.pages[page])))
    return Error{ErrorCode::kOutOfMemory, "no memory for a page", grid.pages[page].offset};
  return readPage(grid, page, above, out.words.span(), out);
}

bool Pack::hasDistances() const { return !impl_->levels.distance_grids.empty(); }

int Pack::distanceLevels(int part) const {
  const std::span<const Part> all = parts();
  if (!hasDistances() || part < 0 || static_cast<std::size_t>(part) >= all.size()) return 0;
  const Part& of = all[static_cast<std::size_t>(part)];
  return of.kind == PartKind::kSolid ? kelp::distanceLevels(of.size, of.levels) : 0;
}

Result<LevelGrid> Pack::readDistanceGrid(int part, int level) const {
  const int levels = distanceLevels(part);
  if (level < 0 || level >= levels)
    return Error{ErrorCode::kMisuse, "the pack has no distances of such a part and level"};
  const std::size_t slot =
      impl_->levels.first_distances[static_cast<std::size_t>(part)] + static_cast<std::size_t>(level);
  return impl_->readGrid(impl_->levels.distance_grids[slot], impl_->levels.distance_pages[slot],
                         distanceLattice(parts()[static_cast<std::size_t>(part)], level),
                         level + 1 == levels);
}

}  // namespace kelp
