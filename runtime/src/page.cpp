// SPDX-License-Identifier: MIT
#include "kelp/runtime/page.h"

#include <bit>
#include <cstring>

#include "kelp/formats/fog.h"

namespace kelp::runtime {

static_assert(std::endian::native == std::endian::little, "codes are copied into words as they are");

std::uint32_t pageWords(const PageInfo& page) {
  if (page.channels > 0) return kFogChannelWords * page.channels * page.count;
  const std::uint32_t attributes = (page.raw - page.count * kBrickVoxels) / sizeof(std::uint32_t);
  return kBrickWords * page.count + attributes;
}

namespace {

bool arrangeFog(const PageData& page, std::span<std::uint32_t> words) {
  const std::size_t samples = std::size_t{page.count} * kFogSamples;
  const std::size_t channels = samples > 0 ? page.fog.size() / samples : 0;
  if (channels < 1 || channels > 2 || page.fog.size() != channels * samples ||
      words.size() != channels * page.count * kFogChannelWords)
    return false;
  std::uint32_t* word = words.data();
  for (std::size_t b = 0; b < page.count; ++b) {
    for (std::size_t channel = 0; channel < channels; ++channel) {
      const std::uint8_t* const brick = page.fog.data() + channel * samples + b * kFogSamples;
      for (int z = 0; z < kFogSide; ++z) {
        for (int y = 0; y < kBrickSide; ++y) {
          const std::uint8_t* const row = brick + kFogSide * (y + kFogSide * z);
          for (int x = 0; x < kBrickSide; ++x) {
            const std::uint8_t* const s = row + x;
            *word++ = std::uint32_t{s[0]} | std::uint32_t{s[1]} << 8 | std::uint32_t{s[kFogSide]} << 16 |
                      std::uint32_t{s[kFogSide + 1]} << 24;
          }
        }
      }
    }
  }
  return true;
}

}  // namespace

bool arrangePage(const PageData& page, std::span<std::uint32_t> words) {
  if (!page.fog.empty()) return arrangeFog(page, words);
  const std::uint32_t first_attribute = kBrickWords * page.count;
  if (words.size() != first_attribute + page.attributes.size()) return false;
  std::uint32_t next = 0;  // index of the next attribute
  for (std::uint32_t b = 0; b < page.count; ++b) {
    const std::uint8_t* codes = page.codes.data() + std::size_t{b} * kBrickVoxels;
    std::uint32_t slices[8];
    const std::int64_t end = computeSliceBase({codes, kBrickVoxels}, next, slices);
    if (end < 0) return false;
    std::uint32_t* brick = &words[std::size_t{b} * kBrickWords];
    // Plus the slices, at most 16896, because a page has at most 64 KiB.
    const std::uint32_t to_attributes = first_attribute - b * kBrickWords;
    for (std::uint32_t i = 0; i < kSliceWords; ++i)
      brick[i] = (to_attributes + slices[2 * i]) | (to_attributes + slices[2 * i + 1]) << 16;
    std::memcpy(brick + kSliceWords, codes, kBrickVoxels);
    next += static_cast<std::uint32_t>(end);
  }
  if (next != page.attributes.size()) return false;
  if (next > 0)
    std::memcpy(&words[first_attribute], page.attributes.data(), std::size_t{next} * sizeof(std::uint32_t));
  return true;
}

}  // namespace kelp::runtime
