// SPDX-License-Identifier: MIT
// The clips of a pack, prepared for evaluation. sin(a + b) = sin a cos b + cos a sin b, so all waves of one
// period share one sine and one cosine, and all waves that move the same number become one sum.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "kelp/formats/buffer.h"
#include "kelp/formats/error.h"
#include "kelp/formats/model.h"

namespace kelp::simd {

// Four sums, for four consecutive floats in the array of the knots of all parts.
struct WaveSums {
  std::uint32_t first = 0;  // the first of the four floats
  struct {
    float sine[4] = {};    // for each sum: the factor of sin(2 pi t / period)
    float cosine[4] = {};  // the factor of cos(2 pi t / period)
  } of[4];                 // for each period of the block
};

// Waves of up to four periods.
struct WaveBlock {
  double frequencies[4] = {};  // 1 / period, descending
  std::size_t periods = 0;     // 1 to 4
  std::span<const WaveSums> sums;
};

// Tables that are prepared for every clip of a pack.
class ClipTables {
 public:
  explicit ClipTables(const Allocator& allocator);
  // Fills the tables from the pack's clips. kOutOfMemory. At most kWaveMemory bytes a wave, while it runs.
  Result<void> prepare(std::span<const Part> parts, std::span<const Clip> clips);
  // The waves of one clip, those by which automatic tangents follow included. The index must be valid.
  std::span<const WaveBlock> waves(std::size_t clip) const;
  // How automatic tangents follow the tracks of one clip: one a track, all 0 if it moves no knot. The index
  // must be valid.
  std::span<const Follow> follows(std::size_t clip) const;

 private:
  struct Filling;
  Buffer<std::uint32_t> first_block_;  // of each clip, and the end of the last one's
  Buffer<WaveBlock> blocks_;           // their sums are in sums_
  Buffer<WaveSums> sums_;
  Buffer<std::uint32_t> first_track_;  // of each clip, and the end of the last one's
  Buffer<Follow> follows_;
};

// Adds `weight` times the value of the waves at `seconds` to the knots, which are those of all parts, one
// part after the other. Each sine is within 1e-6 of the exact value as long as a double can represent the
// phase; for larger times every phase is 0. All numbers must be finite.
void addWaves(const WaveBlock& block, double seconds, float weight, std::span<Knot> knots);

}  // namespace kelp::simd
