// SPDX-License-Identifier: MIT
#include "page_writer.h"

#include <algorithm>
#include <atomic>
#include <cstring>

#include "checksum.h"
#include "kelp/formats/fog.h"
#include "layout.h"
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

bool packPage(const PagePlan& page, FrameEncoder& encoder, Buffer<std::byte>& raw, Buffer<std::byte>& frame,
              Packed& packed) {
  if (!(page.level->density.empty() ? fillSolidPage(page, raw) : fillFogPage(page, raw)) ||
      !frame.reuse(FrameEncoder::bound(layout::kMaxPageRaw)))
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
};

void packNextPages(void* user) {
  Work& work = *static_cast<Work*>(user);
  FrameEncoder encoder;
  Buffer<std::byte> raw, frame;
  for (std::size_t i = work.next++; i < work.pages.size() && !work.failed; i = work.next++) {
    if (!packPage(work.pages[i], encoder, raw, frame, work.packed[i])) work.failed = true;
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

bool packPages(std::span<const PagePlan> pages, std::span<Packed> packed, int threads) {
  Work work;
  work.pages = pages;
  work.packed = packed;
  const std::size_t useful =
      std::min(static_cast<std::size_t>(threads), std::max<std::size_t>(pages.size(), 1));
  runOnThreads(static_cast<int>(useful), packNextPages, &work);
  return !work.failed;
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
