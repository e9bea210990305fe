// SPDX-License-Identifier: MIT
#include "page_writer.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>

#include "checksum.h"
#include "kelp/formats/fog.h"
#include "layout.h"
#include "metadata_writer.h"
#include "worker_threads.h"
#include "zstd_encode.h"

namespace kelp {
namespace {

std::uint32_t surfaceVoxels(std::span<const std::uint8_t> codes) {
  return static_cast<std::uint32_t>(std::count_if(codes.begin(), codes.end(), isSurfaceCode));
}

// The bytes of a page before compression.
bool fillFogPage(const PagePlan& page, Buffer<std::byte>& raw) {
  const std::size_t bytes = std::size_t{page.count} * kFogSamples,
                    from = std::size_t{page.first_slot} * kFogSamples;
  const RawLevel& level = *page.level;
  if (!raw.reuse(level.heat.empty() ? bytes : 2 * bytes)) return false;
  std::memcpy(raw.data(), level.density.data() + from, bytes);
  if (!level.heat.empty()) std::memcpy(raw.data() + bytes, level.heat.data() + from, bytes);
  return true;
}

bool fillSolidPage(const PagePlan& page, Buffer<std::byte>& raw) {
  const std::size_t code_bytes = std::size_t{page.count} * kBrickVoxels;
  const std::size_t attribute_bytes = std::size_t{page.attributes} * sizeof(std::uint32_t);
  if (!raw.reuse(code_bytes + attribute_bytes)) return false;
  // Ranks are not stored; the reader counts them.
  const std::uint8_t* const codes = page.level->codes.data() + std::size_t{page.first_slot} * kBrickVoxels;
  for (std::size_t i = 0; i < code_bytes; ++i)
    raw[i] = std::byte{isSurfaceCode(codes[i]) ? kSurfaceCode : codes[i]};
  if (attribute_bytes > 0)
    std::memcpy(raw.data() + code_bytes, page.level->attributes.data() + page.first_attribute,
                attribute_bytes);
  return true;
}

// Bits, and what they do not tell. False with `fault` set: a code is impossible.
bool fillDistancePage(const PagePlan& page, Buffer<std::byte>& raw, Buffer<BrickBits>& bits,
                      const char*& fault) {
  if (!bits.reset(page.count) || !raw.reuse(std::size_t{page.count} * layout::kDistanceBrick)) return false;
  for (std::size_t i = 0; i < std::size_t{page.count} * kBrickVoxels; ++i)
    if (isInside(page.codes[i])) bits[i / kBrickVoxels].slices[i / 64 % 8] |= std::uint64_t{1} << (i % 64);
  std::memcpy(raw.data(), bits.data(), bits.size() * sizeof(BrickBits));
  std::byte* const corrections = raw.data() + bits.size() * sizeof(BrickBits);
  for (std::size_t brick = 0; brick < page.count; ++brick) {
    std::array<std::uint8_t, kBrickVoxels> predicted;
    predictDistances(*page.distances, page.first_slot, bits.span(), brick, predicted);
    fault = findDistanceFault(*page.distances, brickAt(*page.distances, page.first_slot + brick),
                              {page.codes + brick * kBrickVoxels, kBrickVoxels}, predicted);
    if (fault) return false;
    for (std::size_t i = 0; i < kBrickVoxels; ++i) {
      const std::uint8_t code = page.codes[brick * kBrickVoxels + i];
      corrections[brick * kBrickVoxels + i] =
          static_cast<std::byte>(code == predicted[i] ? 0 : squaredOf(code));
    }
  }
  return true;
}

bool fillPage(const PagePlan& page, Buffer<std::byte>& raw, Buffer<BrickBits>& bits, const char*& fault) {
  if (page.distances) return fillDistancePage(page, raw, bits, fault);
  return page.level->density.empty() ? fillSolidPage(page, raw) : fillFogPage(page, raw);
}

bool packPage(const PagePlan& page, FrameEncoder& encoder, Buffer<std::byte>& raw, Buffer<BrickBits>& bits,
              Buffer<std::byte>& frame, Packed& packed, const char*& fault) {
  if (!fillPage(page, raw, bits, fault) || !frame.reuse(FrameEncoder::bound(layout::kMaxPageRaw)))
    return false;
  const std::size_t size = encoder.encode(raw.span(), frame.span());
  if (size == 0 || !packed.stored.reset(size)) return false;
  std::memcpy(packed.stored.data(), frame.data(), size);
  packed.checksum = checksum(packed.stored.span());
  packed.raw = raw.size();
  packed.compressed = true;
  return true;
}

struct Work {
  std::span<const PagePlan> pages;
  std::span<Packed> packed;
  std::atomic<std::size_t> next{0};
  std::atomic<bool> failed{false};
  std::atomic<const char*> fault{nullptr};  // if it was not memory
};

void packNextPages(void* user) {
  Work& work = *static_cast<Work*>(user);
  FrameEncoder encoder;
  Buffer<std::byte> raw, frame;
  Buffer<BrickBits> bits;
  for (std::size_t i = work.next++; i < work.pages.size() && !work.failed; i = work.next++) {
    const char* fault = nullptr;
    if (packPage(work.pages[i], encoder, raw, bits, frame, work.packed[i], fault)) continue;
    if (fault) work.fault = fault;
    work.failed = true;
  }
}

}  // namespace

std::size_t planPages(const RawLevel& level, std::span<PagePlan> pages) {
  const bool fog = !level.density.empty();
  const std::size_t bricks = fog ? level.density.size() / kFogSamples : level.codes.size() / kBrickVoxels;
  const std::size_t brick_bytes = fog ? (level.heat.empty() ? 1 : 2) * kFogSamples : kBrickVoxels;
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
  for (std::size_t slot = 0; slot < bricks; ++slot) {
    const std::uint32_t surface =
        fog ? 0 : surfaceVoxels(std::span(level.codes).subspan(slot * kBrickVoxels, kBrickVoxels));
    const std::size_t raw = std::size_t{page.count + 1} * brick_bytes +
                            std::size_t{page.attributes + surface} * sizeof(std::uint32_t);
    if (raw > layout::kMaxPageRaw) close();
    ++page.count;
    page.attributes += surface;
  }
  close();
  return count;
}

std::size_t planPages(const DistanceLevel& level, std::span<const std::uint8_t> codes,
                      std::span<PagePlan> pages) {
  constexpr std::size_t kMost = layout::kMaxPageRaw / layout::kDistanceBrick;
  const std::size_t bricks = codes.size() / kBrickVoxels, count = (bricks + kMost - 1) / kMost;
  for (std::size_t i = 0; i < count && !pages.empty(); ++i) {
    PagePlan& page = pages[i];
    page.distances = &level;
    page.codes = codes.data() + i * kMost * kBrickVoxels;
    page.first_slot = static_cast<std::uint32_t>(i * kMost);
    page.count = static_cast<std::uint32_t>(std::min(kMost, bricks - i * kMost));
  }
  return count;
}

Result<void> packPages(std::span<const PagePlan> pages, std::span<Packed> packed, int threads) {
  Work work;
  work.pages = pages;
  work.packed = packed;
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
