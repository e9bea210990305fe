// SPDX-License-Identifier: MIT
// The rules of SPEC.md for the pages of distances, for reader and writer.
#pragma once

#include <cstdint>
#include <span>

#include "kelp/formats/distance.h"
#include "page_codec.h"

namespace kelp {

bool isPossibleBand(DistanceBand band);

// The bricks of one page of distances, and which of their voxels are solid.
struct DistanceBits {
  glm::ivec3 size{0};  // of the level
  DistanceBand band;
  std::span<const glm::ivec3> places;  // of the bricks in the grid
  std::span<const BrickBits> bits;
};

// The codes of a brick that follow from the bits of its page alone: no distance can be greater.
void predictDistances(const DistanceBits& page, const BrickPlaces& places, std::size_t brick,
                      std::span<std::uint8_t, kBrickVoxels> codes);

// The rule that the codes of a brick break, or null. predicted: by predictDistances.
const char* findDistanceFault(const DistanceBits& page, std::size_t brick,
                              std::span<const std::uint8_t> codes, std::span<const std::uint8_t> predicted);

}  // namespace kelp
