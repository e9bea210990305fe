// SPDX-License-Identifier: MIT
// Lies about cages, for both readers, told of makeTinyCagePack(): four parts, of which the comb has three
// cages and the block one.
#pragma once

#include <cstddef>

#include "lying_pack.h"
#include "tiny_cage_pack.h"

namespace kelp::test {

// Where things are in CAGE.
inline constexpr std::size_t kCageRecords = 8, kCageBlocks = kCageRecords + std::size_t{4} * 20,
                             kBlockBlocks = kCageBlocks + 24 + 6 + 2, kCageMasks = kBlockBlocks + 125;
inline std::size_t cageSplitPoints(const Bytes& chunk) {
  std::size_t at = kCageMasks;
  for (std::size_t i = kCageBlocks; i < kBlockBlocks; ++i)
    if (const auto block = get<std::uint8_t>(chunk, i); block > 1 && block < 255)
      at += std::size_t{8} * block;
  return at;
}
// The five numbers of the four cages, in planes.
inline std::uint32_t countOfCage(const Bytes& chunk, std::size_t cage, std::size_t which) {
  std::uint32_t count = 0;
  for (std::size_t plane = 0; plane < 4; ++plane)
    count |= std::uint32_t{get<std::uint8_t>(chunk, kCageRecords + 20 * plane + 5 * cage + which)}
             << (8 * plane);
  return count;
}
inline void setCountOfCage(Bytes& chunk, std::size_t cage, std::size_t which, std::uint32_t count) {
  for (std::size_t plane = 0; plane < 4; ++plane)
    set(chunk, kCageRecords + 20 * plane + 5 * cage + which, static_cast<std::uint8_t>(count >> (8 * plane)));
}
inline std::size_t cagePoints(const Bytes& chunk) {
  std::size_t points = 0;
  for (std::size_t i = 0; i < 4; ++i) points += countOfCage(chunk, i, 2);
  return points;
}
inline std::size_t cageSplits(const Bytes& chunk) { return cageSplitPoints(chunk) + 4 * cagePoints(chunk); }
// Followed cells; all are of the comb.
inline std::size_t cageFollowed(const Bytes& chunk) {
  return countOfCage(chunk, 1, 4) + countOfCage(chunk, 2, 4);
}
inline std::size_t cageSplitNumbers(const Bytes& chunk) {
  std::size_t numbers = 0;
  for (std::size_t i = 0; i < 4; ++i) numbers += countOfCage(chunk, i, 3);
  return numbers;
}
// The influences of the block: a number for each node, and then their parts and weights.
inline std::size_t cageInfluences(const Bytes& chunk) {
  return cageSplits(chunk) + cageSplitNumbers(chunk) + 4 * cageFollowed(chunk);
}
inline std::size_t influencers(const Bytes& chunk) {
  std::size_t count = 0;
  for (std::size_t node = 0; node < countOfCage(chunk, 3, 0); ++node)
    count += get<std::uint8_t>(chunk, cageInfluences(chunk) + node);
  return count;
}
inline std::size_t influencingParts(const Bytes& chunk) {
  return cageInfluences(chunk) + countOfCage(chunk, 3, 0);
}
inline void spoilWeights(Bytes& chunk, std::uint8_t weight) {
  for (std::size_t at = influencingParts(chunk) + 4 * influencers(chunk); at < chunk.size(); ++at)
    set(chunk, at, weight);
}
// One more, or one less.
inline void changeFollowed(Bytes& chunk, bool more) {
  const std::size_t count = cageFollowed(chunk), first = cageInfluences(chunk) - 4 * count;
  for (std::size_t plane = 4; plane-- > 0;) {
    const auto end = chunk.begin() + static_cast<std::ptrdiff_t>(first + (plane + 1) * count);
    if (more)
      chunk.insert(end, std::byte{0});
    else
      chunk.erase(end - 1);
  }
  setCountOfCage(chunk, 1, 4, countOfCage(chunk, 1, 4) + (more ? 1u : ~0u));
}

inline constexpr Lie kCageLies[] = {
    {"required", kCorrupt, [](PackSurgeon& s) { s.chunks[s.find("CAGE")].flags |= 1u; }},
    {"with part", kCorrupt, [](PackSurgeon& s) { s.chunks[s.find("CAGE")].part = 1; }},
    {"before SOCK", kCorrupt,
     [](PackSurgeon& s) { std::swap(s.chunks[s.find("CAGE")], s.chunks[s.find("SOCK")]); }},
    {"twice", kCorrupt,
     [](PackSurgeon& s) {
       const PackSurgeon::Chunk again = s.chunks[s.find("CAGE")];
       s.chunks.insert(s.chunks.begin() + static_cast<std::ptrdiff_t>(s.find("CAGE")), again);
     }},
    {"follows no part", kCorrupt,
     [](PackSurgeon& s) { set(s.content("CAGE"), cageInfluences(s.content("CAGE")), std::uint8_t{0}); }},
    {"follows five parts", kCorrupt,
     [](PackSurgeon& s) { set(s.content("CAGE"), cageInfluences(s.content("CAGE")), std::uint8_t{5}); }},
    {"a part too many", kCorrupt,
     [](PackSurgeon& s) {
       Bytes& chunk = s.content("CAGE");
       const std::size_t at = cageInfluences(chunk);
       set(chunk, at, static_cast<std::uint8_t>(get<std::uint8_t>(chunk, at) % 4 + 1));
     }},
    {"follows itself", kCorrupt,
     [](PackSurgeon& s) { set(s.content("CAGE"), influencingParts(s.content("CAGE")), std::uint8_t{3}); }},
    {"follows part 2^24", kCorrupt,
     [](PackSurgeon& s) {
       Bytes& chunk = s.content("CAGE");
       set(chunk, influencingParts(chunk) + 3 * influencers(chunk), std::uint8_t{1});
     }},
    {"all weights 0", kCorrupt, [](PackSurgeon& s) { spoilWeights(s.content("CAGE"), 0); }},
    {"all weights 255", kCorrupt, [](PackSurgeon& s) { spoilWeights(s.content("CAGE"), 255); }},
    {"no influences", kCorrupt,
     [](PackSurgeon& s) { s.content("CAGE").resize(cageInfluences(s.content("CAGE"))); }},
    {"influences without a word", kCorrupt,
     [](PackSurgeon& s) { set(s.content("CAGE"), 7, std::uint8_t{1}); }},
    {"influences of another part", kCorrupt,
     [](PackSurgeon& s) { set(s.content("CAGE"), 6, std::uint16_t{0x0112}); }},
    {"too short", kCorrupt, [](PackSurgeon& s) { s.content("CAGE").resize(7); }},
    {"records alone", kCorrupt, [](PackSurgeon& s) { s.content("CAGE").resize(kCageBlocks); }},
    {"half a record", kCorrupt, [](PackSurgeon& s) { s.content("CAGE").resize(kCageBlocks - 8); }},
    {"one byte more", kCorrupt, [](PackSurgeon& s) { s.content("CAGE").push_back(std::byte{0}); }},
    {"one byte less", kCorrupt, [](PackSurgeon& s) { s.content("CAGE").pop_back(); }},
    {"3 parts of 4", kCorrupt, [](PackSurgeon& s) { set(s.content("CAGE"), 0, 3u); }},
    {"2^32 - 1 parts", kCorrupt, [](PackSurgeon& s) { set(s.content("CAGE"), 0, 0xffffffffu); }},
    {"side of 32", kCorrupt, [](PackSurgeon& s) { set(s.content("CAGE"), 6, std::uint8_t{5}); }},
    {"side of 2^255", kCorrupt, [](PackSurgeon& s) { set(s.content("CAGE"), 7, std::uint8_t{255}); }},
    {"another side", kCorrupt, [](PackSurgeon& s) { set(s.content("CAGE"), 6, std::uint8_t{3}); }},
    {"one cage more", kCorrupt, [](PackSurgeon& s) { set(s.content("CAGE"), 5, std::uint8_t{1}); }},
    {"no cage", kCorrupt, [](PackSurgeon& s) { set(s.content("CAGE"), 6, std::uint16_t{0}); }},
    {"a node more", kCorrupt,
     [](PackSurgeon& s) {
       setCountOfCage(s.content("CAGE"), 0, 0, countOfCage(s.content("CAGE"), 0, 0) + 1);
     }},
    {"a face less", kCorrupt,
     [](PackSurgeon& s) {
       setCountOfCage(s.content("CAGE"), 0, 1, countOfCage(s.content("CAGE"), 0, 1) - 1);
     }},
    {"all counts 2^32 - 1", kCorrupt,
     [](PackSurgeon& s) {
       for (std::size_t at = kCageRecords; at < kCageBlocks; at += 4) set(s.content("CAGE"), at, 0xffffffffu);
     }},
    {"a split point less", kCorrupt,
     [](PackSurgeon& s) {
       setCountOfCage(s.content("CAGE"), 0, 2, countOfCage(s.content("CAGE"), 0, 2) - 1);
     }},
    {"a split number less", kCorrupt,
     [](PackSurgeon& s) {
       setCountOfCage(s.content("CAGE"), 0, 3, countOfCage(s.content("CAGE"), 0, 3) - 1);
     }},
    {"a followed cell less", kCorrupt, [](PackSurgeon& s) { changeFollowed(s.content("CAGE"), false); }},
    {"a followed cell more", kCorrupt, [](PackSurgeon& s) { changeFollowed(s.content("CAGE"), true); }},
    {"the finest follows a cell", kCorrupt,
     [](PackSurgeon& s) {
       setCountOfCage(s.content("CAGE"), 0, 4, 1);
       setCountOfCage(s.content("CAGE"), 1, 4, countOfCage(s.content("CAGE"), 1, 4) - 1);
     }},
    {"inside at the edge", kCorrupt,
     [](PackSurgeon& s) { set(s.content("CAGE"), kBlockBlocks, std::uint8_t{255}); }},
    {"inside beside nothing", kCorrupt,
     [](PackSurgeon& s) { set(s.content("CAGE"), kBlockBlocks + 62, std::uint8_t{0}); }},
    {"inside beside nothing, at a corner", kCorrupt,
     [](PackSurgeon& s) { set(s.content("CAGE"), kBlockBlocks, std::uint8_t{0}); }},
    {"no cell", kCorrupt,
     [](PackSurgeon& s) {
       for (std::size_t i = 0; i < 125; ++i) set(s.content("CAGE"), kBlockBlocks + i, std::uint8_t{0});
     }},
    {"254 pieces everywhere", kCorrupt,
     [](PackSurgeon& s) {
       for (std::size_t i = 0; i < 125; ++i) set(s.content("CAGE"), kBlockBlocks + i, std::uint8_t{254});
     }},
    {"a piece without voxels", kCorrupt,
     [](PackSurgeon& s) { set(s.content("CAGE"), kCageMasks, std::uint64_t{0}); }},
    {"split points that descend", kCorrupt,  // the second is 2^32 - 1 after the first, and 1
     [](PackSurgeon& s) {
       Bytes& chunk = s.content("CAGE");
       for (std::size_t plane = 0; plane < 4; ++plane)
         set(chunk, cageSplitPoints(chunk) + plane * cagePoints(chunk) + 1,
             static_cast<std::uint8_t>(plane == 0 ? 254 : 255));
     }},
    {"a split point beyond the lattice", kCorrupt,
     [](PackSurgeon& s) {
       Bytes& chunk = s.content("CAGE");
       set(chunk, cageSplitPoints(chunk) + 3 * cagePoints(chunk), std::uint8_t{255});
     }},
    {"split numbers from 1", kCorrupt,
     [](PackSurgeon& s) { set(s.content("CAGE"), cageSplits(s.content("CAGE")), std::uint8_t{1}); }},
    {"a split number is left out", kCorrupt,
     [](PackSurgeon& s) { set(s.content("CAGE"), cageSplits(s.content("CAGE")) + 1, std::uint8_t{2}); }},
    {"split points of one node", kCorrupt,
     [](PackSurgeon& s) {
       Bytes& chunk = s.content("CAGE");
       for (std::size_t i = 0; i < countOfCage(chunk, 0, 3); ++i)
         set(chunk, cageSplits(chunk) + i, std::uint8_t{0});
     }},
    {"follows no cell", kCorrupt,
     [](PackSurgeon& s) {
       set(s.content("CAGE"), cageInfluences(s.content("CAGE")) - 1, std::uint8_t{127});
     }},
    {"follows a cell before the first", kCorrupt,
     [](PackSurgeon& s) {
       Bytes& chunk = s.content("CAGE");
       set(chunk, cageInfluences(chunk) - 4 * cageFollowed(chunk), std::uint8_t{1});
     }},
};

}  // namespace kelp::test
