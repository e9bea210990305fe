// SPDX-License-Identifier: MIT
#include "distance_pages.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "coding_libraries.h"
#include "kelp/formats/level.h"
#include "layout.h"
#include "voxels.h"

namespace kelp {
namespace {

// Which numbers are sums of three squares.
constexpr std::array<bool, 256> kSumOfSquares = [] {
  std::array<bool, 256> sums{};
  for (std::size_t x = 0; x < 16; ++x)
    for (std::size_t y = x; y < 16; ++y)
      for (std::size_t z = y; z < 16; ++z)
        if (const std::size_t sum = x * x + y * y + z * z; sum < sums.size()) sums[sum] = true;
  return sums;
}();

}  // namespace

bool isPossibleBand(DistanceBand band) {
  return band.outside >= kNarrowestBand.outside && band.outside <= kWidestBand.outside &&
         band.inside >= kNarrowestBand.inside && band.inside <= kWidestBand.inside;
}

void predictDistances(const DistanceBits& page, const BrickPlaces& places, std::size_t brick,
                      std::span<std::uint8_t, kBrickVoxels> codes) {
  constexpr int kOneBrick = 81;  // nearer than this, everything is in the bricks that touch
  const int reach = std::max(page.band.outside, page.band.inside) < kOneBrick ? 1 : 2;
  std::array<const BrickBits*, 125> around{};
  for (int z = -reach; z <= reach; ++z)
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x)
        if (const int found = places.find(page.places[brick] + glm::ivec3(x, y, z)); found >= 0)
          around[static_cast<std::size_t>(x + 2 + 5 * (y + 2 + 5 * (z + 2)))] =
              &page.bits[static_cast<std::size_t>(found)];
  computeDistanceCodes(around, page.band, codes);
}

const char* findDistanceFault(const DistanceBits& page, std::size_t brick,
                              std::span<const std::uint8_t> codes, std::span<const std::uint8_t> predicted) {
  const glm::ivec3 room = page.size - page.places[brick] * kBrickSide;
  bool outside = true, inside = true;
  for (int i = 0; i < kBrickVoxels; ++i) {
    const std::uint8_t code = codes[static_cast<std::size_t>(i)],
                       most = predicted[static_cast<std::size_t>(i)];
    outside = outside && code == kFarOutside;
    inside = inside && code == kFarInside;
    if (isInside(code) && ((i & 7) >= room.x || (i >> 3 & 7) >= room.y || i >> 6 >= room.z))
      return "a solid voxel of distances lies outside the level";
    if (code == most) continue;
    const int squared = squaredOf(code), allowed = squaredOf(most);
    if (squared == 0 || isInside(code) != isInside(most) || (allowed != 0 && squared > allowed) ||
        squared > (isInside(code) ? page.band.inside : page.band.outside) ||
        !kSumOfSquares[static_cast<std::size_t>(squared)])
      return "a distance is impossible";
  }
  return outside || inside ? "a stored brick of distances is wholly beyond the band" : nullptr;
}

Result<void> decodeDistancePage(const Source& source, const LevelGrid& grid, std::size_t index,
                                std::span<std::uint32_t> words, PageData& out) {
  const PageInfo& page = grid.pages[index];
  // Workspace of zstd, decoded page, stored page.
  const std::size_t workspace_bytes = static_cast<std::size_t>(layout::align(decodeWorkspaceBytes(), 16));
  const std::size_t raw_bytes = static_cast<std::size_t>(layout::align(page.raw, 16));
  if (!out.scratch.reuse(workspace_bytes + raw_bytes + page.stored) || !out.shapes.reuse(0) ||
      !out.fog.reuse(0))
    return Error{ErrorCode::kOutOfMemory, "no memory for a page", page.offset};
  const std::span<std::byte> raw = out.scratch.span().subspan(workspace_bytes, page.raw);
  const std::span<std::byte> stored = out.scratch.span().subspan(workspace_bytes + raw_bytes, page.stored);
  if (const Result<void> read = readStored(source, page, stored); !read) return read;
  if (!decodeFrame(stored, raw, out.scratch.span().first(workspace_bytes)))
    return Error{ErrorCode::kCorrupt, "a page does not decompress to its raw size", page.offset};
  out.info = page;

  std::array<glm::ivec3, kMaxPageBricks> places;
  std::array<BrickBits, kMaxPageBricks> bits;
  for (std::uint32_t i = 0; i < page.count; ++i) places[i] = grid.place(page.first_slot + i);
  std::memcpy(bits.data(), raw.data(), page.count * sizeof(BrickBits));
  const std::byte* correction = raw.data() + page.count * sizeof(BrickBits);
  const DistanceBits known{grid.size, grid.band, std::span(places).first(page.count),
                           std::span(bits).first(page.count)};
  const BrickPlaces finder(known.places);
  for (std::size_t brick = 0; brick < page.count; ++brick) {
    std::array<std::uint8_t, kBrickVoxels> predicted;
    predictDistances(known, finder, brick, predicted);
    const std::span<std::uint8_t> codes(reinterpret_cast<std::uint8_t*>(&words[brick * kCodeWords]),
                                        kBrickVoxels);
    for (std::size_t i = 0; i < kBrickVoxels; ++i) {
      const auto squared = static_cast<std::uint8_t>(*correction++);
      codes[i] = predicted[i];
      if (squared == 0) continue;
      if (squared == squaredOf(predicted[i]) || squared > kWidestBand.outside ||
          (isInside(predicted[i]) && squared > kWidestBand.inside))
        return Error{ErrorCode::kCorrupt, "a distance is impossible", page.offset};
      codes[i] = isInside(predicted[i]) ? static_cast<std::uint8_t>(255 - squared) : squared;
    }
    if (const char* fault = findDistanceFault(known, brick, codes, predicted))
      return Error{ErrorCode::kCorrupt, fault, page.offset};
  }
  return {};
}

}  // namespace kelp
