// SPDX-License-Identifier: MIT
// Lies about morph targets, for both readers, told of makeTinyMorphPack(): two of them, which move the three
// cages of one part.
#pragma once

#include <cstddef>
#include <numeric>

#include "lying_pack.h"
#include "tiny_cage_pack.h"

namespace kelp::test {

// The arrays of morph targets are the last of CAGE, but for one word with the part of the block's sections: a
// word for the part, two for each target, one for each list of moved nodes, all in planes; then four for each
// moved node.
inline std::size_t morphArrays(const Bytes& chunk) {
  const Bytes bytes = writeToMemory(makeTinyMorphPack());
  MemorySource memory(bytes);
  const Result<Pack> pack = Pack::open(memory.source());
  std::size_t moved = 0;
  for (const Cage& cage : pack->parts()[2].cages)
    for (const Morph& morph : cage.morphs) moved += morph.moved.size();
  return chunk.size() - 4 * (1 + 1 + 4 + 6) - 16 * moved;
}
inline std::size_t morphRecords(const Bytes& chunk) { return morphArrays(chunk) + 4; }
inline std::size_t movedNumbers(const Bytes& chunk) { return morphRecords(chunk) + 4 * 4; }
inline std::size_t movedNodes(const Bytes& chunk) { return movedNumbers(chunk) + 4 * 6; }

// Sets a byte of CAGE: at an array's beginning, plus `off`.
template <std::size_t (*kArray)(const Bytes&), std::size_t kOff, std::uint8_t kByte>
void setMorphByte(PackSurgeon& s) {
  Bytes& chunk = s.content("CAGE");
  set(chunk, kArray(chunk) + kOff, kByte);
}

inline constexpr Lie kMorphLies[] = {
    {"without influences", kCorrupt, [](PackSurgeon& s) { set(s.content("CAGE"), 6, std::uint8_t{2 + 32}); }},
    {"a part without", kCorrupt, [](PackSurgeon& s) { set(s.content("CAGE"), 6, std::uint8_t{2 + 16}); }},
    {"another flag", kCorrupt, [](PackSurgeon& s) { set(s.content("CAGE"), 6, std::uint8_t{2 + 48 + 64}); }},
    {"no targets", kCorrupt, setMorphByte<morphArrays, 0, 0>},
    {"three targets", kCorrupt, setMorphByte<morphArrays, 0, 3>},
    {"2^31 targets", kCorrupt, setMorphByte<morphArrays, 3, 128>},
    {"of a solid part", kCorrupt, setMorphByte<morphRecords, 0, 0>},
    {"of a part that is not there", kCorrupt, setMorphByte<morphRecords, 2, 6>},
    {"of part 2^24", kCorrupt, setMorphByte<morphRecords, 3 * 4, 1>},
    {"both of one part", kCorrupt, setMorphByte<morphRecords, 2, 3>},
    {"step below 0", kCorrupt, setMorphByte<morphRecords, 3 * 4 + 1, 0xbf>},
    {"step not a number", kCorrupt,
     [](PackSurgeon& s) {
       setMorphByte<morphRecords, 3 * 4 + 1, 0x7f>(s);
       setMorphByte<morphRecords, 2 * 4 + 1, 0xff>(s);
     }},
    {"2^24 moved nodes", kCorrupt, setMorphByte<movedNumbers, 3 * 6, 1>},
    {"no moved nodes", kCorrupt, setMorphByte<movedNumbers, 0, 0>},
    {"nodes that are not there", kCorrupt, setMorphByte<movedNodes, 0, 255>},
    {"sections of a solid part", kCorrupt,
     [](PackSurgeon& s) { set(s.content("CAGE"), s.content("CAGE").size() - 4, std::uint8_t{5}); }},
    {"sections of a part that is not there", kCorrupt,
     [](PackSurgeon& s) { set(s.content("CAGE"), s.content("CAGE").size() - 1, std::uint8_t{1}); }},
    {"sections and influences", kCorrupt,
     [](PackSurgeon& s) { set(s.content("CAGE"), 9, std::uint8_t{1 + 16 + 64}); }},
    {"one byte less", kCorrupt, [](PackSurgeon& s) { s.content("CAGE").pop_back(); }},
    {"half of it", kCorrupt,
     [](PackSurgeon& s) { s.content("CAGE").resize(movedNodes(s.content("CAGE")) + 3); }},
};

}  // namespace kelp::test
