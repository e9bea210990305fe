// SPDX-License-Identifier: MIT
// Lies about joints, for both readers.
#pragma once

#include <algorithm>

#include "lying_pack.h"

namespace kelp::test {

// Three joints of makeTinyJointPack(): records at 12, 72 and 132, lists of parts (0, 1; 1) at 192, names at
// 204: "root", "H\xc3\xbcfte" twice.
inline const Lie kJointLies[] = {
    {"required", kCorrupt, [](PackSurgeon& s) { s.chunks[s.find("JNTS")].flags |= 1u; }},
    {"with part", kCorrupt, [](PackSurgeon& s) { s.chunks[s.find("JNTS")].part = 1; }},
    {"before SOCK", kCorrupt,
     [](PackSurgeon& s) { std::swap(s.chunks[s.find("JNTS")], s.chunks[s.find("SOCK")]); }},
    {"twice", kCorrupt,
     [](PackSurgeon& s) {
       const PackSurgeon::Chunk again = s.chunks[s.find("JNTS")];
       s.chunks.insert(s.chunks.begin() + static_cast<std::ptrdiff_t>(s.find("JNTS")), again);
     }},
    {"last", kCorrupt,
     [](PackSurgeon& s) {
       const auto at = s.chunks.begin() + static_cast<std::ptrdiff_t>(s.find("JNTS"));
       std::rotate(at, at + 1, s.chunks.end());
     }},
    {"too short", kCorrupt, [](PackSurgeon& s) { s.content("JNTS").resize(11); }},
    {"counts of 2^32 - 1", kCorrupt,
     [](PackSurgeon& s) {
       for (std::size_t at = 0; at < 12; at += 4) set(s.content("JNTS"), at, 0xffffffffu);
     }},
    {"4 joints of 3", kCorrupt, [](PackSurgeon& s) { set(s.content("JNTS"), 0, 4u); }},
    {"2 joints of 3", kCorrupt, [](PackSurgeon& s) { set(s.content("JNTS"), 0, 2u); }},
    {"one byte more", kCorrupt, [](PackSurgeon& s) { s.content("JNTS").push_back(std::byte{'x'}); }},
    {"no name", kCorrupt,
     [](PackSurgeon& s) {
       set(s.content("JNTS"), 12, 0u);
       set(s.content("JNTS"), 72, 10u);
     }},
    {"name beyond the text", kCorrupt, [](PackSurgeon& s) { set(s.content("JNTS"), 132, 7u); }},
    {"name of 2^32 - 1 bytes", kCorrupt, [](PackSurgeon& s) { set(s.content("JNTS"), 132, 0xffffffffu); }},
    {"name of 256 bytes", kCorrupt,
     [](PackSurgeon& s) {
       s.content("JNTS").resize(204 + 4 + 6 + 256, std::byte{'a'});
       set(s.content("JNTS"), 8, 266u);
       set(s.content("JNTS"), 132, 256u);
     }},
    {"text left over", kCorrupt, [](PackSurgeon& s) { set(s.content("JNTS"), 132, 5u); }},
    {"name splits a character", kCorrupt,
     [](PackSurgeon& s) {
       set(s.content("JNTS"), 12, 6u);
       set(s.content("JNTS"), 72, 4u);
     }},
    {"name with newline", kCorrupt, [](PackSurgeon& s) { set(s.content("JNTS"), 205, '\n'); }},
    {"name with null", kCorrupt, [](PackSurgeon& s) { set(s.content("JNTS"), 204, '\0'); }},
    {"parent is itself", kCorrupt, [](PackSurgeon& s) { set(s.content("JNTS"), 76, std::int32_t{1}); }},
    {"parents in a circle", kCorrupt, [](PackSurgeon& s) { set(s.content("JNTS"), 16, std::int32_t{2}); }},
    {"parent -2", kCorrupt, [](PackSurgeon& s) { set(s.content("JNTS"), 136, std::int32_t{-2}); }},
    {"parent 3", kCorrupt, [](PackSurgeon& s) { set(s.content("JNTS"), 136, std::int32_t{3}); }},
    {"matrix not a number", kCorrupt, [](PackSurgeon& s) { set(s.content("JNTS"), 20, kNan); }},
    {"place not finite", kCorrupt, [](PackSurgeon& s) { set(s.content("JNTS"), 64, kInfinity); }},
    {"matrix of zeros", kCorrupt,
     [](PackSurgeon& s) {
       for (std::size_t at = 80; at < 116; at += 4) set(s.content("JNTS"), at, 0.0f);
     }},
    {"matrix that flattens", kCorrupt, [](PackSurgeon& s) { set(s.content("JNTS"), 36, 0.0f); }},
    {"3 parts of 2", kCorrupt, [](PackSurgeon& s) { set(s.content("JNTS"), 128, 3u); }},
    {"2^32 - 1 parts", kCorrupt, [](PackSurgeon& s) { set(s.content("JNTS"), 188, 0xffffffffu); }},
    {"1 part of 2", kCorrupt, [](PackSurgeon& s) { set(s.content("JNTS"), 128, 1u); }},
    {"a part twice", kCorrupt, [](PackSurgeon& s) { set(s.content("JNTS"), 192, 1u); }},
    {"parts that descend", kCorrupt,
     [](PackSurgeon& s) {
       set(s.content("JNTS"), 192, 1u);
       set(s.content("JNTS"), 196, 0u);
     }},
    {"part 2", kCorrupt, [](PackSurgeon& s) { set(s.content("JNTS"), 200, 2u); }},
    {"part 2^32 - 1", kCorrupt, [](PackSurgeon& s) { set(s.content("JNTS"), 196, 0xffffffffu); }},
};

}  // namespace kelp::test
