// SPDX-License-Identifier: MIT
// Lies about sockets and about places on the parent's spline, for both readers.
#pragma once

#include "lying_pack.h"

namespace kelp::test {

// Places on the parent's spline: of the first part, which has no parent, at 20, of its child at 44. Two
// sockets, "tip" of part 0 and "Blüte" of part 1: records at 8 and 44, names at 80.
inline const Lie kSocketLies[] = {
    {"place on the spline of no parent", kCorrupt, [](PackSurgeon& s) { set(s.content("RIGS"), 20, 0.5f); }},
    {"place beyond the parent's spline", kCorrupt,
     [](PackSurgeon& s) { set(s.content("RIGS"), 44, 1.001f); }},
    {"place before the parent's spline", kCorrupt, [](PackSurgeon& s) { set(s.content("RIGS"), 44, -0.5f); }},
    {"place not a number", kCorrupt, [](PackSurgeon& s) { set(s.content("RIGS"), 44, kNan); }},
    {"too short", kCorrupt, [](PackSurgeon& s) { s.content("SOCK").resize(7); }},
    {"counts of 2^32 - 1", kCorrupt,
     [](PackSurgeon& s) {
       for (std::size_t at = 0; at < 8; at += 4) set(s.content("SOCK"), at, 0xffffffffu);
     }},
    {"3 sockets of 2", kCorrupt, [](PackSurgeon& s) { set(s.content("SOCK"), 0, 3u); }},
    {"1 socket of 2", kCorrupt, [](PackSurgeon& s) { set(s.content("SOCK"), 0, 1u); }},
    {"one byte more", kCorrupt, [](PackSurgeon& s) { s.content("SOCK").push_back(std::byte{'x'}); }},
    {"no name", kCorrupt,
     [](PackSurgeon& s) {
       set(s.content("SOCK"), 8, 0u);
       set(s.content("SOCK"), 44, 9u);
     }},
    {"name beyond the text", kCorrupt, [](PackSurgeon& s) { set(s.content("SOCK"), 44, 7u); }},
    {"name of 2^32 - 1 bytes", kCorrupt, [](PackSurgeon& s) { set(s.content("SOCK"), 44, 0xffffffffu); }},
    {"name of 256 bytes", kCorrupt,
     [](PackSurgeon& s) {
       s.content("SOCK").resize(80 + 3 + 256, std::byte{'a'});
       set(s.content("SOCK"), 4, 259u);
       set(s.content("SOCK"), 44, 256u);
     }},
    {"text left over", kCorrupt, [](PackSurgeon& s) { set(s.content("SOCK"), 44, 5u); }},
    {"name splits a character", kCorrupt,
     [](PackSurgeon& s) {
       set(s.content("SOCK"), 8, 6u);
       set(s.content("SOCK"), 44, 3u);
     }},
    {"name with newline", kCorrupt, [](PackSurgeon& s) { set(s.content("SOCK"), 81, '\n'); }},
    {"name with null", kCorrupt, [](PackSurgeon& s) { set(s.content("SOCK"), 80, '\0'); }},
    {"part 2", kCorrupt, [](PackSurgeon& s) { set(s.content("SOCK"), 12, 2u); }},
    {"part 2^32 - 1", kCorrupt, [](PackSurgeon& s) { set(s.content("SOCK"), 12, 0xffffffffu); }},
    {"place above 1", kCorrupt, [](PackSurgeon& s) { set(s.content("SOCK"), 16, 1.001f); }},
    {"place below 0", kCorrupt, [](PackSurgeon& s) { set(s.content("SOCK"), 16, -0.001f); }},
    {"place not a number", kCorrupt, [](PackSurgeon& s) { set(s.content("SOCK"), 16, kNan); }},
    {"offset along x not finite", kCorrupt, [](PackSurgeon& s) { set(s.content("SOCK"), 20, kInfinity); }},
    {"offset along z not a number", kCorrupt, [](PackSurgeon& s) { set(s.content("SOCK"), 24, kNan); }},
    {"rotation too long", kCorrupt, [](PackSurgeon& s) { set(s.content("SOCK"), 40, 0.802f); }},
    {"rotation too short", kCorrupt, [](PackSurgeon& s) { set(s.content("SOCK"), 40, 0.798f); }},
    {"rotation of zeros", kCorrupt, [](PackSurgeon& s) { set(s.content("SOCK"), 76, 0.0f); }},
    {"rotation not a number", kCorrupt, [](PackSurgeon& s) { set(s.content("SOCK"), 28, kNan); }},
    {"rotation not finite", kCorrupt, [](PackSurgeon& s) { set(s.content("SOCK"), 28, kInfinity); }},
};

}  // namespace kelp::test
