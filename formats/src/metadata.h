// SPDX-License-Identifier: MIT
// The metadata chunks as tables in memory. Each function reads one decoded chunk, checks every rule of SPEC.md and trusts
// nothing; the writer runs them too, on what it is about to write. The offset of their errors counts from the chunk's first byte;
// codes are kCorrupt, kNotMonotone (rigs), kLimit, kUnsupportedFeature (parts) and kOutOfMemory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "kelp/formats/buffer.h"
#include "kelp/formats/error.h"
#include "kelp/formats/model.h"
#include "kelp/formats/pack.h"

namespace kelp {

struct Metadata {
  // `most`: bytes of all tables together.
  explicit Metadata(const Allocator& memory, std::uint64_t most)
      : allocator(memory),
        room(most),
        info(allocator),
        part_names(allocator),
        parts(allocator),
        palette(allocator),
        fogs(allocator),
        extinctions(allocator),
        ramps(allocator),
        knots(allocator),
        clip_names(allocator),
        clips(allocator),
        waves(allocator),
        wave_blocks(allocator),
        wave_sums(allocator),
        tracks(allocator),
        keys(allocator) {}

  // Takes room for what is about to be allocated; false if the limits leave none. Counts are of 32 bits, so that no product overflows.
  bool takeRoom(std::uint64_t count, std::size_t bytes) {
    if (count * bytes > room) return false;
    room -= count * bytes;
    return true;
  }

  Allocator allocator;
  std::uint64_t room;
  Buffer<char> info;
  Buffer<char> part_names;
  Buffer<Part> parts;  // names point into part_names, knots into knots
  Buffer<Material> palette;
  Buffer<Fog> fogs;  // which parts point to; spans point into the two tables that follow
  Buffer<float> extinctions;
  Buffer<glm::vec3> ramps;
  Buffer<Knot> knots;
  Buffer<char> clip_names;
  Buffer<Clip> clips;  // names point into clip_names, waves and tracks into the tables below
  Buffer<Wave> waves;
  Buffer<WaveBlock> wave_blocks;  // sums point into wave_sums
  Buffer<WaveSums> wave_sums;
  Buffer<Track> tracks;  // keys point into keys
  Buffer<Key> keys;
};

Result<void> parseInfo(std::span<const std::byte> chunk, Metadata& out);
Result<void> parseParts(std::span<const std::byte> chunk, const Limits& limits, Metadata& out);
Result<void> parsePalette(std::span<const std::byte> chunk, Metadata& out);
// After parts; `chunk` is empty if there is none. Of fog parts, without which there must be none.
Result<void> parseFogs(std::span<const std::byte> chunk, Metadata& out);
Result<void> parseRigs(std::span<const std::byte> chunk, Metadata& out);   // after parts
Result<void> parseClips(std::span<const std::byte> chunk, Metadata& out);  // after rigs
// What adding them up takes for each wave, at most.
inline constexpr std::size_t kWaveSumBytes = sizeof(WaveBlock) + sizeof(WaveSums) + sizeof(const Wave*);  // NOLINT(bugprone-sizeof-expression): of a pointer
// Adds up the waves of every clip (kelp/formats/model.h). kOutOfMemory.
Result<void> sumWaves(Metadata& out);

// Whether the text is UTF-8 without overlong forms, surrogates and null. Names must have no control characters either.
bool isUtf8(std::string_view text);
bool isName(std::string_view text);

}  // namespace kelp
