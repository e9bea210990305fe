// SPDX-License-Identifier: MIT
#include "page_writer.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <utility>

#include "coding_libraries.h"
#include "distance_pages.h"
#include "kelp/formats/fog.h"
#include "layout.h"
#include "metadata_writer.h"
#include "page_codec.h"
#include "page_frame.h"
#include "worker_threads.h"

namespace kelp {
namespace {

std::uint32_t surfaceVoxels(std::span<const std::uint8_t> codes) {
  return static_cast<std::uint32_t>(std::count_if(codes.begin(), codes.end(), isSurfaceCode));
}

// The bytes of a page before compression.
bool fillFogPage(const PagePlan& page, Buffer<std::byte>& raw) {
  const std::size_t bytes = std::size_t{page.count} * kFogSamples,
                    from = std::size_t{page.first_slot} * kFogSamples;
  const RawLevel& level = *page.level->raw;
  if (!raw.reuse(level.heat.empty() ? bytes : 2 * bytes)) return false;
  std::memcpy(raw.data(), level.density.data() + from, bytes);
  if (!level.heat.empty()) std::memcpy(raw.data() + bytes, level.heat.data() + from, bytes);
  return true;
}

// Bits, and the distances that do not follow from them. False with `fault` set: a code is impossible.
bool fillDistancePage(const PagePlan& page, Buffer<std::byte>& raw, const char*& fault) {
  if (!raw.reuse(std::size_t{page.count} * layout::kDistanceBrick)) return false;
  const LevelPlan& level = *page.level;
  const std::uint8_t* const codes =
      level.distances->codes.data() + std::size_t{page.first_slot} * kBrickVoxels;
  std::array<BrickBits, kMaxPageBricks> bits{};
  for (std::size_t i = 0; i < std::size_t{page.count} * kBrickVoxels; ++i)
    if (isInside(codes[i])) bits[i / kBrickVoxels].slices[i / 64 % 8] |= std::uint64_t{1} << (i % 64);
  std::memcpy(raw.data(), bits.data(), page.count * sizeof(BrickBits));
  std::byte* correction = raw.data() + page.count * sizeof(BrickBits);
  const DistanceBits known{level.lattice.size, level.distances->band,
                           level.bricks.span().subspan(page.first_slot, page.count),
                           std::span(bits).first(page.count)};
  const BrickPlaces finder(known.places);
  for (std::size_t brick = 0; brick < page.count; ++brick) {
    const std::span of(codes + brick * kBrickVoxels, kBrickVoxels);
    std::array<std::uint8_t, kBrickVoxels> predicted;
    predictDistances(known, finder, brick, predicted);
    fault = findDistanceFault(known, brick, of, predicted);
    if (fault) return false;
    for (std::size_t i = 0; i < kBrickVoxels; ++i)
      *correction++ = static_cast<std::byte>(of[i] == predicted[i] ? 0 : squaredOf(of[i]));
  }
  return true;
}

// The memory of a thread that packs one page after the other.
struct Workshop {
  FrameEncoder encoder;
  Buffer<std::byte> raw, frame, workspace;
  Buffer<std::uint8_t> codes;
};

// The blocks of the coarser level over the bricks of a page.
void findBlocks(const LevelPlan& level, std::span<const glm::ivec3> bricks, std::span<CoarseBlock> above) {
  const glm::ivec3 grid = brickGrid(levelSize(level.lattice.size, 1));
  std::uint32_t known = kCellInside;  // the cell whose shape it is
  BrickShape shape;
  for (std::size_t i = 0; i < bricks.size(); ++i) {
    const glm::ivec3 coarse = bricks[i] >> 1;
    const std::uint32_t cell =
        level.above->cells[static_cast<std::size_t>(coarse.x) +
                           static_cast<std::size_t>(grid.x) *
                               (static_cast<std::size_t>(coarse.y) +
                                static_cast<std::size_t>(grid.y) * static_cast<std::size_t>(coarse.z))];
    above[i] = {};  // of a brick that is not stored: the encoder refuses it
    if (!isStoredCell(cell)) continue;
    if (std::exchange(known, cell) != cell)
      shapesOf(std::span(level.above->codes)
                   .subspan(std::size_t{cell & kCellSlotMask} * kBrickVoxels, kBrickVoxels),
               {&shape, 1});
    above[i] = blockOver(shape, bricks[i]);
  }
}

Result<void> encodePage(const PagePlan& page, Effort effort, Workshop& shop) {
  const LevelPlan& level = *page.level;
  const std::span<const std::uint8_t> codes =
      std::span(level.raw->codes)
          .subspan(std::size_t{page.first_slot} * kBrickVoxels, std::size_t{page.count} * kBrickVoxels);
  if (!shop.codes.reuse(codes.size())) return kNoMemory;
  std::transform(codes.begin(), codes.end(), shop.codes.begin(), [](std::uint8_t code) {
    return isSurfaceCode(code) ? kSurfaceCode : isSolidCode(code) ? kInnerCode : std::uint8_t{0};
  });
  std::array<CoarseBlock, kMaxPageBricks> above;
  PageShape shape;
  shape.bricks = level.bricks.span().subspan(page.first_slot, page.count);
  if (level.above) {
    shape.above = std::span(above).first(page.count);
    findBlocks(level, shape.bricks, std::span(above).first(page.count));
  }
  shape.size = level.lattice.size;
  shape.palette = static_cast<std::uint32_t>(level.palette);
  return encodeSolidPage(shape, shop.codes.span(),
                         std::span(level.raw->attributes)
                             .subspan(static_cast<std::size_t>(page.first_attribute), page.attributes),
                         effort, shop.workspace, shop.frame);
}

// The bytes of the page in shop.frame, and its decoded size.
Result<std::size_t> encode(const PagePlan& page, Effort effort, Workshop& shop) {
  if (page.level->lattice.channels == 0) {
    if (const Result<void> encoded = encodePage(page, effort, shop); !encoded) return encoded.error();
    return std::size_t{page.count} * kBrickVoxels + std::size_t{page.attributes} * sizeof(std::uint32_t);
  }
  const char* fault = nullptr;
  if (!(page.level->distances ? fillDistancePage(page, shop.raw, fault) : fillFogPage(page, shop.raw)))
    return fault ? Error{ErrorCode::kMisuse, fault} : kNoMemory;
  if (!shop.frame.reuse(FrameEncoder::bound(layout::kMaxPageRaw))) return kNoMemory;
  const std::size_t size = shop.encoder.encode(shop.raw.span(), shop.frame.span());
  if (size == 0 || !shop.frame.reuse(size)) return kNoMemory;
  return shop.raw.size();
}

struct Work {
  std::span<const PagePlan> pages;
  std::span<Packed> packed;
  Effort effort = Effort::kFast;
  std::atomic<std::size_t> next{0};
  std::atomic<bool> failed{false};
  std::atomic<const char*> fault{nullptr};  // if it was not memory
};

void packNextPages(void* user) {
  Work& work = *static_cast<Work*>(user);
  Workshop shop;
  for (std::size_t i = work.next++; i < work.pages.size() && !work.failed; i = work.next++) {
    Packed& packed = work.packed[i];
    const Result<std::size_t> raw = encode(work.pages[i], work.effort, shop);
    if (!raw && raw.error().code != ErrorCode::kOutOfMemory) work.fault = raw.error().detail;
    if (!raw || !packed.stored.reset(shop.frame.size())) {
      work.failed = true;
      continue;
    }
    std::memcpy(packed.stored.data(), shop.frame.data(), shop.frame.size());
    packed.checksum = checksum(packed.stored.span());
    packed.raw = *raw;
    packed.compressed = true;
  }
}

}  // namespace

std::size_t planPages(const LevelPlan& level, std::span<PagePlan> pages) {
  const int channels = level.lattice.channels;
  const std::size_t brick_bytes = level.lattice.distances() ? layout::kDistanceBrick
                                  : channels > 0            ? static_cast<std::size_t>(channels * kFogSamples)
                                                            : kBrickVoxels;
  std::size_t count = 0;
  PagePlan page;
  page.level = &level;
  const auto close = [&] {
    if (page.count == 0) return;
    if (!pages.empty()) pages[count] = page;
    ++count;
    page.first_slot += page.count;
    page.first_attribute += page.attributes;
    page.count = page.attributes = 0;
  };
  for (std::size_t slot = 0; slot < level.bricks.size(); ++slot) {
    const std::uint32_t surface =
        channels > 0 ? 0
                     : surfaceVoxels(std::span(level.raw->codes).subspan(slot * kBrickVoxels, kBrickVoxels));
    const std::size_t raw = std::size_t{page.count + 1} * brick_bytes +
                            std::size_t{page.attributes + surface} * sizeof(std::uint32_t);
    // The runtime adds 16 bytes to each brick of voxels and keeps pages in rows of 4 KiB: so full pages fill
    // 16 rows, and not a little of one more.
    const std::size_t added = channels > 0 ? 0 : std::size_t{page.count + 1} * 16;
    if (raw + added > layout::kMaxPageRaw) close();
    ++page.count;
    page.attributes += surface;
  }
  close();
  return count;
}

Result<void> packPages(std::span<const PagePlan> pages, std::span<Packed> packed, int threads,
                       Effort effort) {
  Work work;
  work.pages = pages;
  work.packed = packed;
  work.effort = effort;
  const std::size_t useful =
      std::min(static_cast<std::size_t>(threads), std::max<std::size_t>(pages.size(), 1));
  runOnThreads(static_cast<int>(useful), packNextPages, &work);
  if (const char* const fault = work.fault) return Error{ErrorCode::kMisuse, fault};
  return work.failed ? Result<void>(kNoMemory) : Result<void>();
}

bool packBytes(std::span<const std::byte> bytes, Packed& packed) {
  FrameEncoder encoder;
  Buffer<std::byte> frame;
  if (!frame.reset(FrameEncoder::bound(bytes.size()))) return false;
  const std::size_t size = encoder.encode(bytes, frame.span());
  if (size == 0) return false;
  packed.compressed = size < bytes.size();
  const std::span<const std::byte> kept =
      packed.compressed ? std::span<const std::byte>(frame.span()).first(size) : bytes;
  if (!packed.stored.reset(kept.size())) return false;
  std::memcpy(packed.stored.data(), kept.data(), kept.size());
  packed.checksum = checksum(kept);
  packed.raw = bytes.size();
  return true;
}

}  // namespace kelp
