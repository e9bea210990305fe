// SPDX-License-Identifier: MIT
#include "kelp/formats/verify.h"
#include "kelp/formats/level.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <optional>
#include <utility>

#include "coding_libraries.h"
#include "container.h"
#include "kelp/formats/fog.h"
#include "layout.h"
#include "metadata.h"
#include "voxels.h"
#include "worker_threads.h"

namespace kelp {
namespace {

using ChunkInfo = Pack::ChunkInfo;

class Verifier {
 public:
  Verifier(const Source& source, const PackLimits& limits, void (*report)(void* user, const Issue& issue),
           void* user, const Allocator& allocator, int threads)
      : source_(source),
        limits_(limits),
        report_(report),
        user_(user),
        allocator_(allocator),
        threads_(threads) {}

  std::uint64_t run() {
    if (const Result<void> read = readContainer(source_, limits_, allocator_, container_); !read) {
      issue(IssueId::kUnreadable, read.error());
      return errors_;
    }
    const Result<MetadataChunks> found = findMetadata(chunks(), limits_);
    if (!found) {
      issue(IssueId::kUnreadable, found.error());
      return errors_;
    }
    std::uint64_t end = layout::kHeaderBytes + chunks().size() * layout::kIndexEntryBytes;
    for (std::size_t i = 0; i < chunks().size(); ++i) {
      checkPadding(end, chunks()[i].offset);
      checkChunk(i, *found);
      end = chunks()[i].offset + chunks()[i].stored;
    }
    if (levels_good_) checkVoxels();
    return errors_;
  }

 private:
  std::span<const ChunkInfo> chunks() const { return container_.chunks.span(); }

  void issue(IssueId id, const Error& error, std::int64_t page = -1) {
    Issue found;
    found.id = id;
    found.severity = id == IssueId::kUnknownChunk ? Severity::kWarning : Severity::kError;
    found.error = error;
    found.part = part_;
    found.level = level_;
    found.page = page;
    found.knot = knot_;
    if (found.severity == Severity::kError) ++errors_;
    if (report_) report_(user_, found);
  }

  void checkPadding(std::uint64_t from, std::uint64_t to) {
    std::array<std::byte, layout::kAlignment> bytes;
    const auto gap = std::span(bytes).first(static_cast<std::size_t>(to - from));
    if (const Result<void> read = readBytes(source_, from, gap); !read)
      return issue(IssueId::kUnreadable, read.error());
    const auto stain = std::find_if(gap.begin(), gap.end(), [](std::byte b) { return b != std::byte{0}; });
    if (stain == gap.end()) return;
    issue(IssueId::kPaddingNotZero, {ErrorCode::kCorrupt, "a byte between two chunks is not zero",
                                     from + static_cast<std::uint64_t>(stain - gap.begin())});
  }

  void checkChunk(std::size_t index, const MetadataChunks& metadata) {
    const ChunkInfo& chunk = chunks()[index];
    if (levels_good_ && (layout::isGrid(chunk.fourcc) || layout::isPages(chunk.fourcc))) {
      part_ = static_cast<int>(chunk.part);
      level_ = static_cast<int>(chunk.level);
      if (layout::isPages(chunk.fourcc)) checkStored(chunk);
      const bool fog = model_.parts[chunk.part].fog != nullptr;
      if (chunk.fourcc == layout::kDgrd) {
        checkGrid(chunk, true);
      } else if (chunk.fourcc == layout::kDist) {
        if (grid_good_) checkDistances();
      } else if (fog && chunk.fourcc == layout::kGrid) {
        checkGrid(chunk);
      } else if (fog && grid_good_) {
        for (std::size_t i = 0; i < grid_.pages.size(); ++i) checkFogPage(i);
      }
      part_ = level_ = -1;
    } else if (index == metadata.info) {
      checkTable(chunk, [&](Bytes b) { return parseInfo(b, model_); });
    } else if (index == metadata.part) {
      parts_good_ = checkTable(chunk, [&](Bytes b) { return parseParts(b, limits_, model_); });
      if (parts_good_ && metadata.fogs == MetadataChunks::kNone) parts_good_ = checkNoFog(chunk);
      if (parts_good_) findLevelChunks();
    } else if (index == metadata.matl) {
      palette_good_ = checkTable(chunk, [&](Bytes b) { return parsePalette(b, model_); });
    } else if (index == metadata.fogs && parts_good_) {
      parts_good_ = checkTable(chunk, [&](Bytes b) { return parseFogs(b, model_); });
      levels_good_ = levels_good_ && parts_good_;
    } else if (index == metadata.rigs && parts_good_) {
      rigs_good_ = checkTable(chunk, [&](Bytes b) {
        const Result<void> parsed = parseRigs(b, model_);
        if (!parsed && idOf(parsed.error(), IssueId::kMetadata) != IssueId::kMetadata)
          findKnot(parsed.error().offset);
        return parsed;
      });
      part_ = knot_ = -1;
    } else if (index == metadata.clip && rigs_good_) {
      checkTable(chunk, [&](Bytes b) { return parseClips(b, model_); });
    } else if (index == metadata.sock && parts_good_) {
      checkTable(chunk, [&](Bytes b) { return parseSockets(b, model_); });
    } else if (index == metadata.jnts && parts_good_) {
      checkTable(chunk, [&](Bytes b) { return parseJoints(b, model_); });
    } else if (index == metadata.cage && parts_good_) {
      checkTable(chunk, [&](Bytes b) { return parseCages(b, model_); });
    } else {
      // An unknown kind, or a chunk whose content cannot be checked because an earlier table is wrong.
      checkStored(chunk);
      if (!layout::isKnown(chunk.fourcc)) {
        issue(IssueId::kUnknownChunk,
              {ErrorCode::kUnsupportedFeature, "an optional chunk has an unknown kind", chunk.offset});
      }
    }
  }

  // Compares a chunk with its checksum, block by block.
  void checkStored(const ChunkInfo& chunk) {
    RunningChecksum running;
    for (std::uint64_t done = 0; done < chunk.stored;) {
      const auto block = std::span(block_).first(
          static_cast<std::size_t>(std::min<std::uint64_t>(block_.size(), chunk.stored - done)));
      if (const Result<void> read = readBytes(source_, chunk.offset + done, block); !read)
        return issue(IssueId::kUnreadable, read.error());
      running.add(block);
      done += block.size();
    }
    if (running.value() != chunk.checksum) {
      issue(IssueId::kChunkChecksum,
            {ErrorCode::kChecksum, "a chunk differs from its checksum", chunk.offset});
    }
  }

  using Bytes = std::span<const std::byte>;

  template <class Parse>
  bool checkTable(const ChunkInfo& chunk, Parse parse) {
    Buffer<std::byte> bytes(allocator_);
    if (const Result<void> read = readChunk(source_, chunk, limits_, bytes, allocator_); !read) {
      issue(idOf(read.error(), IssueId::kMetadata), read.error());
      return false;
    }
    const Result<void> parsed = parse(Bytes(bytes.span()));
    if (!parsed) issue(idOf(parsed.error(), IssueId::kMetadata), inFile(parsed.error(), chunk));
    return static_cast<bool>(parsed);
  }

  // Whose knot is at this place of RIGS, which was read.
  void findKnot(std::uint64_t offset) {
    const std::uint64_t knots_at = layout::kRigsHeader + model_.parts.size() * layout::kRigsPerPart;
    const Knot* const knot = model_.knots.data() + (offset - knots_at) / layout::kKnotRecord;
    for (std::size_t i = 0; i < model_.parts.size(); ++i) {
      const std::span<const Knot> knots = model_.parts[i].knots;
      if (knot < knots.data() || knot >= knots.data() + knots.size()) continue;
      part_ = static_cast<int>(i);
      knot_ = static_cast<int>(knot - knots.data());
    }
  }

  // The file has no FOGS: no part may be fog.
  bool checkNoFog(const ChunkInfo& parts) {
    const Result<void> parsed = parseFogs({}, model_);
    if (!parsed) issue(IssueId::kMetadata, inFile(parsed.error(), parts));
    return static_cast<bool>(parsed);
  }

  static IssueId idOf(const Error& error, IssueId otherwise) {
    if (error.code == ErrorCode::kIo) return IssueId::kUnreadable;
    if (error.code == ErrorCode::kChecksum) return IssueId::kChunkChecksum;
    if (error.code == ErrorCode::kNotMonotone) return IssueId::kNotMonotone;
    if (error.code == ErrorCode::kFolds) return IssueId::kFolds;
    return otherwise;
  }

  void findLevelChunks() {
    const Result<void> found = findLevels(chunks(), model_.parts.span(), levels_);
    if (!found) issue(IssueId::kUnreadable, found.error());
    levels_good_ = static_cast<bool>(found);
  }

  // Levels of voxels, part by part from the coarsest: a page is decoded with the level above, and in the file
  // other parts lie between the two.
  void checkVoxels() {
    for (std::size_t part = 0; part < model_.parts.size(); ++part) {
      if (model_.parts[part].fog) continue;
      known_ = {LevelGrid(allocator_), Buffer<BrickShape>(allocator_)};
      part_ = static_cast<int>(part);
      for (level_ = model_.parts[part].levels - 1; level_ >= 0; --level_) {
        const auto level = static_cast<std::size_t>(level_);
        checkGrid(chunks()[levels_.grids[levels_.first[part] + level]]);
        if (grid_good_ && palette_good_) checkSolidPages();  // without a palette nothing can be decoded
      }
    }
    part_ = level_ = -1;
  }

  void checkGrid(const ChunkInfo& chunk, bool distances = false) {
    const Part& of = model_.parts[chunk.part];
    const std::size_t pages = distances
                                  ? levels_.distance_pages[levels_.first_distances[chunk.part] + chunk.level]
                                  : levels_.bricks[levels_.first[chunk.part] + chunk.level];
    grid_ = LevelGrid(allocator_);  // frees the previous one before the next is read
    Result<LevelGrid> grid =
        readLevelGrid(source_, chunk, chunks()[pages],
                      distances ? distanceLattice(of, level_) : latticeOf(of, level_), limits_, allocator_);
    grid_good_ = static_cast<bool>(grid);
    if (!grid) {
      known_.lost = grid.error().code;
      return issue(idOf(grid.error(), distances ? IssueId::kDistanceGrid : IssueId::kGrid), grid.error());
    }
    grid_ = *std::move(grid);
    grid_.part = part_;
    grid_.level = level_;
    grid_.coarsest = level_ + 1 == of.levels;
  }

  // Calls check(page, i) for the pages of the grid on all threads, each with a page of its own that has room
  // for the words, then tell(i, error) for those that are wrong, in their order.
  template <class Check, class Tell>
  void checkPages(const Check& check, const Tell& tell) {
    constexpr std::size_t kAtOnce = 256;
    const std::size_t count = grid_.pages.size();
    for (std::size_t first = 0; first < count; first += kAtOnce) {
      struct Batch {
        const Check& check;
        const LevelGrid& grid;
        const Allocator& allocator;
        std::size_t first, end;
        std::atomic<std::size_t> next;
        std::array<std::optional<Error>, kAtOnce> wrong{};
      } batch{check, grid_, allocator_, first, std::min(count, first + kAtOnce), first};
      runOnThreads(
          static_cast<int>(std::min(static_cast<std::size_t>(threads_), batch.end - first)),
          [](void* user) {
            Batch& its = *static_cast<Batch*>(user);
            PageData page(its.allocator);
            for (std::size_t i = its.next++; i < its.end; i = its.next++) {
              const PageInfo& info = its.grid.pages[i];
              const Result<void> checked =
                  page.words.reuse(pageWords(info))
                      ? its.check(page, i)
                      : Error{ErrorCode::kOutOfMemory, "no memory for a page", info.offset};
              if (!checked) its.wrong[i - its.first] = checked.error();
            }
          },
          &batch);
      for (std::size_t i = first; i < batch.end; ++i)
        if (batch.wrong[i - first]) tell(i, *batch.wrong[i - first]);
    }
  }

  void checkDistances() {
    checkPages([&](PageData& page,
                   std::size_t i) { return decodeDistancePage(source_, grid_, i, page.words.span(), page); },
               [&](std::size_t i, const Error& error) {
                 issue(IssueId::kDistances, error, static_cast<std::int64_t>(i));
               });
  }

  void checkSolidPages() {
    const LevelAbove above{&known_.grid, known_.shapes.span()};
    Buffer<BrickShape> shapes(allocator_);
    const auto atPage = [&](const Error& error, std::int64_t page) { issue(IssueId::kPage, error, page); };
    if (!shapes.reset(grid_.bricks.size())) {
      known_.lost = ErrorCode::kOutOfMemory;
      return atPage({known_.lost, "no memory for a level"}, -1);
    }
    if (!grid_.coarsest && known_.grid.level != level_ + 1)
      return atPage({known_.lost, "the next coarser level cannot be read"}, -1);
    checkPages(
        [&](PageData& page, std::size_t i) {
          const Result<void> decoded =
              decodeSolidPage(source_, grid_, i, above, model_.palette.size(), page.words.span(), page);
          if (decoded)
            std::copy(page.shapes.begin(), page.shapes.end(), shapes.begin() + page.info.first_slot);
          return decoded;
        },
        [&](std::size_t i, const Error& error) {
          const auto number = static_cast<std::int64_t>(i);
          if (error.code == ErrorCode::kMisuse)
            return atPage({known_.lost, "a page of the next coarser level over it cannot be read",
                           grid_.pages[i].offset},
                          number);
          known_.lost = error.code;
          atPage(error, number);
        });
    known_.grid = std::move(grid_);
    known_.shapes = std::move(shapes);
  }

  void checkFogPage(std::size_t index) {
    const PageInfo& page = grid_.pages[index];
    const auto number = static_cast<std::int64_t>(index);
    const Result<void> decoded = decodeFogPage(source_, page, page_);
    if (!decoded) issue(IssueId::kPage, decoded.error(), number);
    bool outside = false;
    for (std::uint32_t brick = 0; brick < page.count; ++brick)
      outside = outside || (decoded && holdsOutside(page, brick, grid_.place(page.first_slot + brick)));
    if (!decoded) return;
    const auto broken = [&](IssueId id, const char* detail) {
      issue(id, {ErrorCode::kCorrupt, detail, page.offset}, number);
    };
    if (findClearBrick(page_.fog.span(), page.channels) >= 0)
      broken(IssueId::kClearBrick, "a stored brick holds no fog");
    if (outside) broken(IssueId::kFogOutside, "a sample of fog lies outside the level");
  }

  // True if a brick of the current page of fog has samples outside the level.
  bool holdsOutside(const PageInfo& page, std::uint32_t brick, const glm::ivec3& at) const {
    const glm::ivec3 samples = levelSize(model_.parts[static_cast<std::size_t>(part_)].size, level_);
    for (int channel = 0; channel < page.channels; ++channel) {
      if (hasFogOutside(fogChannel(page_, channel).subspan(std::size_t{brick} * kFogSamples, kFogSamples), at,
                        samples))
        return true;
    }
    return false;
  }

  // The level of voxels that was read last.
  struct KnownLevel {
    LevelGrid grid;
    Buffer<BrickShape> shapes;
    ErrorCode lost = ErrorCode::kCorrupt;  // why something of it was not read
  };

  const Source& source_;
  const PackLimits& limits_;
  void (*const report_)(void* user, const Issue& issue);
  void* const user_;
  const Allocator& allocator_;
  const int threads_;
  std::uint64_t errors_ = 0;
  int part_ = -1, level_ = -1;  // of the current chunk
  int knot_ = -1;
  Container container_{allocator_};
  Metadata model_{allocator_, limits_.max_metadata_bytes};
  LevelChunks levels_{allocator_};
  bool parts_good_ = false, palette_good_ = false, rigs_good_ = false, levels_good_ = false,
       grid_good_ = false;
  LevelGrid grid_{allocator_};
  KnownLevel known_;
  PageData page_{allocator_};
  std::array<std::byte, 16384> block_;
};

}  // namespace

std::uint64_t verify(const Source& source, const PackLimits& limits,
                     void (*report)(void* user, const Issue& issue), void* user, const Allocator& allocator,
                     int threads) {
  if (!allocator.allocate || !allocator.deallocate) {
    if (report)
      report(
          user,
          {IssueId::kUnreadable, Severity::kError, {ErrorCode::kMisuse, "the allocator lacks a function"}});
    return 1;
  }
  return Verifier(source, limits, report, user, allocator, std::max(threads, 1)).run();
}

}  // namespace kelp
