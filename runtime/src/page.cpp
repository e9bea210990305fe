// SPDX-License-Identifier: MIT
#include "kelp/runtime/page.h"

#include <bit>
#include <cstring>

namespace kelp::runtime {

static_assert(std::endian::native == std::endian::little, "codes are copied into words as they are");

std::uint32_t pageWords(const PageInfo& page) {
  const std::uint32_t attributes = (page.raw - page.count * kBrickVoxels) / sizeof(std::uint32_t);
  return kBrickWords * page.count + attributes;
}

bool arrangePage(const PageData& page, std::span<std::uint32_t> words) {
  const std::uint32_t first_attribute = kBrickWords * page.count;
  if (words.size() != first_attribute + page.attributes.size()) return false;
  std::uint32_t next = 0;  // attribute
  for (std::uint32_t b = 0; b < page.count; ++b) {
    const std::uint8_t* codes = page.codes.data() + std::size_t{b} * kBrickVoxels;
    std::uint32_t slices[8];
    const std::int64_t end = computeSliceBase({codes, kBrickVoxels}, next, slices);
    if (end < 0) return false;
    std::uint32_t* brick = &words[std::size_t{b} * kBrickWords];
    const std::uint32_t to_attributes = first_attribute - b * kBrickWords;  // with what follows at most 16896: a page has 64 KiB at most
    for (std::uint32_t i = 0; i < kSliceWords; ++i) brick[i] = (to_attributes + slices[2 * i]) | (to_attributes + slices[2 * i + 1]) << 16;
    std::memcpy(brick + kSliceWords, codes, kBrickVoxels);
    next += static_cast<std::uint32_t>(end);
  }
  if (next != page.attributes.size()) return false;
  if (next > 0) std::memcpy(&words[first_attribute], page.attributes.data(), std::size_t{next} * sizeof(std::uint32_t));
  return true;
}

}  // namespace kelp::runtime
