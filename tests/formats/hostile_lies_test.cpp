// SPDX-License-Identifier: MIT
// Packs that contradict themselves, with every checksum right.
#include <gtest/gtest.h>

#include <algorithm>

#include "cage_lies.h"
#include "joint_lies.h"
#include "lying_pack.h"
#include "morph_lies.h"
#include "socket_lies.h"

namespace kelp {
namespace {

using test::Bytes;
using test::kCorrupt;
using test::Lie;
using test::PackSurgeon;
using test::set;

constexpr ErrorCode kFeature = ErrorCode::kUnsupportedFeature;

// A number of one of the three keys, whose bytes stand in planes.
void setKey(Bytes& chunk, std::size_t key, std::size_t at, float number) {
  Bytes bytes(sizeof number);
  set(bytes, 0, number);
  for (std::size_t b = 0; b < bytes.size(); ++b) chunk[100 + 3 * (at + b) + key] = bytes[b];
}

const Lie kIndexLies[] = {
    {"no chunks", kCorrupt, [](PackSurgeon& s) { s.chunks.clear(); }},
    {"flag unknown", kFeature, [](PackSurgeon& s) { s.chunks[s.find("PART")].flags |= 4; }},
    {"PART not required", kCorrupt, [](PackSurgeon& s) { s.chunks[s.find("PART")].flags &= ~1u; }},
    {"CLIP required", kCorrupt, [](PackSurgeon& s) { s.chunks[s.find("CLIP")].flags |= 1u; }},
    {"metadata with level", kCorrupt, [](PackSurgeon& s) { s.chunks[s.find("MATL")].level = 1; }},
    {"metadata with part", kCorrupt, [](PackSurgeon& s) { s.chunks[s.find("MATL")].part = 1; }},
    {"raw is not stored", kCorrupt, [](PackSurgeon& s) { s.chunks[s.find("BRCK")].raw_lie = 5; }},
    {"raw is not that of the frame", kCorrupt,
     [](PackSurgeon& s) {
       s.chunks[s.find("PART")].flags |= 2;
       s.chunks[s.find("PART")].raw_lie = s.content("PART").size() + 1;
     }},
    {"expands beyond zstd", kCorrupt,
     [](PackSurgeon& s) {
       s.chunks[s.find("PART")].flags |= 2;
       s.chunks[s.find("PART")].raw_lie = std::uint64_t{1} << 31;
     }},
    {"BRCK compressed in one", kCorrupt, [](PackSurgeon& s) { s.chunks[s.find("BRCK")].flags |= 2; }},
    {"offset too large", kCorrupt, [](PackSurgeon& s) { s.chunks[2].offset_lie = 64; }},
    {"offset wraps around", kCorrupt,
     [](PackSurgeon& s) { s.chunks[2].offset_lie = ~std::uint64_t{0} - 63; }},
    {"64 zeros too many", kCorrupt, [](PackSurgeon& s) { s.chunks[2].gap = 64; }},
    {"not aligned", kCorrupt, [](PackSurgeon& s) { s.chunks.back().gap = 8; }},
    {"PART missing", kCorrupt,
     [](PackSurgeon& s) { s.chunks.erase(s.chunks.begin() + static_cast<std::ptrdiff_t>(s.find("PART"))); }},
    {"MATL missing", kCorrupt,
     [](PackSurgeon& s) { s.chunks.erase(s.chunks.begin() + static_cast<std::ptrdiff_t>(s.find("MATL"))); }},
    {"RIGS missing", kCorrupt,
     [](PackSurgeon& s) { s.chunks.erase(s.chunks.begin() + static_cast<std::ptrdiff_t>(s.find("RIGS"))); }},
    {"GRID missing", kCorrupt,
     [](PackSurgeon& s) { s.chunks.erase(s.chunks.begin() + static_cast<std::ptrdiff_t>(s.find("GRID"))); }},
    {"BRCK missing", kCorrupt, [](PackSurgeon& s) { s.chunks.pop_back(); }},
    {"PART twice", kCorrupt,
     [](PackSurgeon& s) { s.chunks.insert(s.chunks.begin(), s.chunks[s.find("PART")]); }},
    {"MATL before PART", kCorrupt,
     [](PackSurgeon& s) { std::swap(s.chunks[s.find("PART")], s.chunks[s.find("MATL")]); }},
    {"SOCK required", kCorrupt, [](PackSurgeon& s) { s.chunks[s.find("SOCK")].flags |= 1u; }},
    {"SOCK with part", kCorrupt, [](PackSurgeon& s) { s.chunks[s.find("SOCK")].part = 1; }},
    {"SOCK before CLIP", kCorrupt,
     [](PackSurgeon& s) { std::swap(s.chunks[s.find("CLIP")], s.chunks[s.find("SOCK")]); }},
    {"SOCK twice", kCorrupt,
     [](PackSurgeon& s) {
       const PackSurgeon::Chunk again = s.chunks[s.find("SOCK")];
       s.chunks.insert(s.chunks.begin() + static_cast<std::ptrdiff_t>(s.find("SOCK")), again);
     }},
    {"SOCK last", kCorrupt,
     [](PackSurgeon& s) {
       std::rotate(s.chunks.begin() + static_cast<std::ptrdiff_t>(s.find("SOCK")),
                   s.chunks.begin() + static_cast<std::ptrdiff_t>(s.find("SOCK")) + 1, s.chunks.end());
     }},
    {"CLIP last", kCorrupt,
     [](PackSurgeon& s) {
       std::rotate(s.chunks.begin() + static_cast<std::ptrdiff_t>(s.find("CLIP")),
                   s.chunks.begin() + static_cast<std::ptrdiff_t>(s.find("CLIP")) + 1, s.chunks.end());
     }},
    {"fine before coarse", kCorrupt,
     [](PackSurgeon& s) {
       const auto first = s.chunks.begin() + static_cast<std::ptrdiff_t>(s.find("GRID"));
       std::rotate(first, first + 2, first + 4);
     }},
    {"BRCK before GRID", kCorrupt,
     [](PackSurgeon& s) { std::swap(s.chunks[s.find("GRID")], s.chunks[s.find("BRCK")]); }},
    {"one level too many", kCorrupt, [](PackSurgeon& s) { s.chunks.push_back(s.chunks[s.find("GRID")]); }},
    {"level of another part", kCorrupt, [](PackSurgeon& s) { s.chunks.back().part = 0; }},
};

const Lie kPartLies[] = {
    {"too short", kCorrupt, [](PackSurgeon& s) { s.content("PART").resize(7); }},
    {"no parts", kCorrupt, [](PackSurgeon& s) { s.content("PART").assign(8, std::byte{0}); }},
    {"count of 2^32 - 1", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 0, 0xffffffffu); }},
    {"one byte more", kCorrupt, [](PackSurgeon& s) { s.content("PART").push_back(std::byte{'x'}); }},
    {"name beyond the text", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 128, 7u); }},
    {"name of 2^32 - 1 bytes", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 128, 0xffffffffu); }},
    {"text left over", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 128, 5u); }},
    {"name splits a character", kCorrupt,
     [](PackSurgeon& s) {
       set(s.content("PART"), 8, 7u);
       set(s.content("PART"), 128, 3u);
     }},
    {"name with newline", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 249, '\n'); }},
    {"name with escape", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 249, '\x1b'); }},
    {"name with C1 control", kCorrupt,
     [](PackSurgeon& s) { set(s.content("PART"), 249, std::uint16_t{0x9bc2}); }},
    {"name overlong", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 249, std::uint16_t{0xafc0}); }},
    {"name with surrogate", kCorrupt,
     [](PackSurgeon& s) {
       set(s.content("PART"), 249, std::uint16_t{0xa0ed});
       set(s.content("PART"), 251, std::uint8_t{0x80});
     }},
    {"parent is itself", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 132, std::int32_t{1}); }},
    {"parent of the first", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 12, std::int32_t{0}); }},
    {"parent -2", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 12, std::int32_t{-2}); }},
    {"fog without its table", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 16, std::uint8_t{1}); }},
    {"kind 200", kFeature, [](PackSurgeon& s) { set(s.content("PART"), 16, std::uint8_t{200}); }},
    {"0 levels", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 17, std::uint8_t{0}); }},
    {"17 levels", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 17, std::uint8_t{17}); }},
    {"16 levels", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 17, std::uint8_t{16}); }},
    {"reserved", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 18, std::uint16_t{1}); }},
    {"size 0", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 20, 0u); }},
    {"size -1", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 24, 0xffffffffu); }},
    {"size 32769", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 28, 32769u); }},
    {"size 9000", ErrorCode::kLimit, [](PackSurgeon& s) { set(s.content("PART"), 28, 9000u); }},
    {"size is another", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 28, 9u); }},
    {"transform not finite", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 32 + 44, test::kNan); }},
    {"transform flat", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 32, 0.0f); }},
    {"pivot not finite", kCorrupt, [](PackSurgeon& s) { set(s.content("PART"), 80 + 4, test::kInfinity); }},
    {"info not UTF-8", kCorrupt, [](PackSurgeon& s) { set(s.content("INFO"), 0, '\xff'); }},
    {"info with null", kCorrupt, [](PackSurgeon& s) { set(s.content("INFO"), 0, '\0'); }},
};

const Lie kPaletteAndRigLies[] = {
    {"palette too short", kCorrupt, [](PackSurgeon& s) { s.content("MATL").resize(3); }},
    {"no colors", kCorrupt, [](PackSurgeon& s) { s.content("MATL").assign(4, std::byte{0}); }},
    {"257 colors", kCorrupt,
     [](PackSurgeon& s) {
       s.content("MATL").assign(4 + 257 * 36, std::byte{0});
       set(s.content("MATL"), 0, 257u);
     }},
    {"2^32 - 1 colors", kCorrupt, [](PackSurgeon& s) { set(s.content("MATL"), 0, 0xffffffffu); }},
    {"palette one byte more", kCorrupt, [](PackSurgeon& s) { s.content("MATL").push_back(std::byte{0}); }},
    {"color above 1", kCorrupt, [](PackSurgeon& s) { set(s.content("MATL"), 4, 1.5f); }},
    {"color not a number", kCorrupt, [](PackSurgeon& s) { set(s.content("MATL"), 16, test::kNan); }},
    {"negative light", kCorrupt, [](PackSurgeon& s) { set(s.content("MATL"), 20, -1.0f); }},
    {"endless light", kCorrupt, [](PackSurgeon& s) { set(s.content("MATL"), 28, test::kInfinity); }},
    {"metallic 2", kCorrupt, [](PackSurgeon& s) { set(s.content("MATL"), 32, 2.0f); }},
    {"roughness -1", kCorrupt, [](PackSurgeon& s) { set(s.content("MATL"), 36, -1.0f); }},
    {"rigs too short", kCorrupt, [](PackSurgeon& s) { s.content("RIGS").resize(55); }},
    {"rigs of 3 parts", kCorrupt, [](PackSurgeon& s) { set(s.content("RIGS"), 0, 3u); }},
    {"2^32 - 1 knots", kCorrupt, [](PackSurgeon& s) { set(s.content("RIGS"), 4, 0xffffffffu); }},
    {"rig of 1 knot", kCorrupt,
     [](PackSurgeon& s) {
       set(s.content("RIGS"), 8, 4u);
       set(s.content("RIGS"), 32, 1u);
     }},
    {"rig beyond the table", kCorrupt, [](PackSurgeon& s) { set(s.content("RIGS"), 32, 3u); }},
    {"knots left over", kCorrupt, [](PackSurgeon& s) { set(s.content("RIGS"), 8, 2u); }},
    {"automatic tangent of a knot that is not there", kCorrupt,
     [](PackSurgeon& s) { set(s.content("RIGS"), 12, 1u << 3); }},
    {"first knot not at 0", kCorrupt, [](PackSurgeon& s) { set(s.content("RIGS"), 56, 0.1f); }},
    {"knot not ascending", kCorrupt, [](PackSurgeon& s) { set(s.content("RIGS"), 56 + 28, 0.0f); }},
    {"knot not finite", kCorrupt, [](PackSurgeon& s) { set(s.content("RIGS"), 56 + 4, test::kInfinity); }},
    // The first part is sheared, the second swept: how they bend at 24 and 48, their rolls at 28 and 52,
    // their knots at 56 and 140.
    {"another way to bend", ErrorCode::kUnsupportedFeature,
     [](PackSurgeon& s) { set(s.content("RIGS"), 48, 2u); }},
    {"way to bend 2^32 - 1", ErrorCode::kUnsupportedFeature,
     [](PackSurgeon& s) { set(s.content("RIGS"), 24, 0xffffffffu); }},
    {"roll of a sheared part", kCorrupt, [](PackSurgeon& s) { set(s.content("RIGS"), 28, 0.5f); }},
    {"roll above pi", kCorrupt, [](PackSurgeon& s) { set(s.content("RIGS"), 52, 3.1415930f); }},
    {"roll below -pi", kCorrupt, [](PackSurgeon& s) { set(s.content("RIGS"), 52, -3.1415930f); }},
    {"roll not a number", kCorrupt, [](PackSurgeon& s) { set(s.content("RIGS"), 52, test::kNan); }},
    {"swept part folds", kCorrupt, [](PackSurgeon& s) { set(s.content("RIGS"), 140 + 16, 9.0f); }},
    {"swept part far away", kCorrupt,  // where rounding leaves nothing of its arcs
     [](PackSurgeon& s) {
       constexpr float kFar[] = {1e8f, -1e8f, -1e8f, 1e-7f,  -1,   1e-7f, 1,
                                 1e8f, 1,     -1e8f, 1e-38f, 9e8f, 1e-7f};
       for (std::size_t i = 0; i < std::size(kFar); ++i) set(s.content("RIGS"), 144 + 4 * i, kFar[i]);
     }},
    {"swept part's knot not finite", kCorrupt,
     [](PackSurgeon& s) { set(s.content("RIGS"), 140 + 28 + 4, test::kNan); }},
    {"spline turns back", kCorrupt, [](PackSurgeon& s) { set(s.content("RIGS"), 56 + 20, -20.0f); }},
};

const Lie kClipLies[] = {
    {"too short", kCorrupt, [](PackSurgeon& s) { s.content("CLIP").resize(19); }},
    {"counts of 2^32 - 1", kCorrupt,
     [](PackSurgeon& s) {
       for (std::size_t at = 0; at < 20; at += 4) set(s.content("CLIP"), at, 0xffffffffu);
     }},
    {"one byte more", kCorrupt, [](PackSurgeon& s) { s.content("CLIP").push_back(std::byte{0}); }},
    {"name too long", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 20, 5u); }},
    {"name left over", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 20, 3u); }},
    {"name with control", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 256, '\x07'); }},
    {"duration 0", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 24, 0.0f); }},
    {"duration not a number", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 24, test::kNan); }},
    {"2 waves of 1", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 28, 2u); }},
    {"0 waves of 1", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 28, 0u); }},
    {"3 tracks of 2", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 32, 3u); }},
    {"wave of part 2", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 36, 2u); }},
    {"wave of knot 3", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 40, 3u); }},
    {"wave of a part", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 44, 2u); }},
    {"wave target 2^31", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 44, 0x80000000u); }},
    {"amplitude not finite", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 52, test::kInfinity); }},
    {"period 0", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 60, 0.0f); }},
    {"period -1", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 60, -1.0f); }},
    {"phase not a number", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 64, test::kNan); }},
    {"track of part 2", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 68, 2u); }},
    {"track of a part with a knot", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 72, 1u); }},
    {"track target 5", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 76, std::uint8_t{5}); }},
    {"interpolation 3", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 77, std::uint8_t{3}); }},
    {"reserved", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 78, std::uint16_t{1}); }},
    {"no keys", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 80, 0u); }},
    {"3 keys of 3, and 1", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 80, 3u); }},
    {"keys left over", kCorrupt, [](PackSurgeon& s) { set(s.content("CLIP"), 80, 1u); }},
    {"negative time", kCorrupt, [](PackSurgeon& s) { setKey(s.content("CLIP"), 0, 0, -1.0f); }},
    {"times descend", kCorrupt, [](PackSurgeon& s) { setKey(s.content("CLIP"), 0, 0, 2.0f); }},
    {"times equal", kCorrupt, [](PackSurgeon& s) { setKey(s.content("CLIP"), 0, 0, 1.5f); }},
    {"rotation not a unit", kCorrupt, [](PackSurgeon& s) { setKey(s.content("CLIP"), 0, 16, 1.1f); }},
    {"rotation not a number", kCorrupt, [](PackSurgeon& s) { setKey(s.content("CLIP"), 0, 4, test::kNan); }},
    {"slope of a linear track", kCorrupt, [](PackSurgeon& s) { setKey(s.content("CLIP"), 0, 20, 1.0f); }},
    {"fourth component of an offset", kCorrupt,
     [](PackSurgeon& s) { setKey(s.content("CLIP"), 2, 16, 1.0f); }},
    {"fourth component of a slope", kCorrupt, [](PackSurgeon& s) { setKey(s.content("CLIP"), 2, 48, 1.0f); }},
    {"slope not finite", kCorrupt, [](PackSurgeon& s) { setKey(s.content("CLIP"), 2, 36, test::kInfinity); }},
};

// The first grid is level 1 of part 0: two cells, the first solid; its page table begins at 8. The second has
// three cells and padding.
const Lie kGridLies[] = {
    {"too short", kCorrupt, [](PackSurgeon& s) { s.content("GRID").resize(4); }},
    {"no pages", kCorrupt, [](PackSurgeon& s) { s.content("GRID").resize(8); }},
    {"half a page entry", kCorrupt, [](PackSurgeon& s) { s.content("GRID").resize(24); }},
    {"one byte more", kCorrupt, [](PackSurgeon& s) { s.content("GRID").push_back(std::byte{0}); }},
    {"padding not zero", kCorrupt, [](PackSurgeon& s) { s.content("GRID")[2] = std::byte{1}; }},
    {"a cell's byte is 130", kCorrupt, [](PackSurgeon& s) { s.content("GRID")[0] = std::byte{130}; }},
    {"a cell's byte is 255", kCorrupt, [](PackSurgeon& s) { s.content("GRID")[1] = std::byte{255}; }},
    {"inside, but beyond the level", kCorrupt, [](PackSurgeon& s) { s.content("GRID")[1] = std::byte{129}; }},
    {"a brick too many", kCorrupt,
     [](PackSurgeon& s) { s.chunks[s.find("GRID") + 2].content[1] = std::byte{128}; }},
    {"no brick", kCorrupt, [](PackSurgeon& s) { std::fill_n(s.content("GRID").begin(), 2, std::byte{0}); }},
    {"page not at 0", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 8, std::uint64_t{1}); }},
    {"page at 2^64 - 1", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 8, ~std::uint64_t{0}); }},
    {"page shorter than its chunk", kCorrupt,
     [](PackSurgeon& s) {
       set(s.content("GRID"), 16, static_cast<std::uint32_t>(s.content("BRCK").size() - 1));
     }},
    {"page longer than its chunk", kCorrupt,
     [](PackSurgeon& s) {
       set(s.content("GRID"), 16, static_cast<std::uint32_t>(s.content("BRCK").size() + 1));
     }},
    {"page of 0 bytes", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 16, 0u); }},
    {"page expands to 2^32 - 4", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 20, 0xfffffffcu); }},
    {"page of another size", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 20, 1032u); }},
    {"page of odd size", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 20, 1057u); }},
    {"page too small for its bricks", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 20, 1020u); }},
    {"page checksum", ErrorCode::kChecksum,
     [](PackSurgeon& s) { set(s.content("GRID"), 24, std::uint64_t{1}); }},
    {"first slot 1", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 32, 1u); }},
    {"page of no bricks", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 36, 0u); }},
    {"page of 2^32 - 1 bricks", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 36, 0xffffffffu); }},
    {"page of a brick too few", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 36, 1u); }},
};

// Every byte of a page decodes to something within the rules; but there may be too few or too many.
const Lie kPageLies[] = {
    {"a byte less", kCorrupt, [](PackSurgeon& s) { s.editPage([](Bytes& p) { p.pop_back(); }); }},
    {"a byte more", kCorrupt,
     [](PackSurgeon& s) { s.editPage([](Bytes& p) { p.push_back(std::byte{0}); }); }},
    {"a page as it was once", kCorrupt,
     [](PackSurgeon& s) { s.editPage([](Bytes& p) { p = test::zstdFrame(Bytes(1060)); }); }},
    {"one attribute more", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 20, 1024u + 4 * 10); }},
    {"one attribute less", kCorrupt, [](PackSurgeon& s) { set(s.content("GRID"), 20, 1024u + 4 * 8); }},
    {"a stored brick below an empty one", kCorrupt,
     [](PackSurgeon& s) { s.chunks[s.find("GRID") + 2].content[1] = std::byte{128}; }},
};

void expectAllRefused(std::span<const Lie> lies, const RawPack& pack = test::tinyPack()) {
  const Bytes sound = test::writeToMemory(pack);
  for (const Lie& lie : lies) {
    SCOPED_TRACE(lie.name);
    PackSurgeon surgeon(sound);
    lie.tell(surgeon);
    const Bytes told = surgeon.build();
    test::expectRefused(test::readAll(pack, told), told, lie.code);
  }
}

TEST(Hostile, LiesInTheIndexAreRefused) { expectAllRefused(kIndexLies); }
TEST(Hostile, LiesInThePartsAreRefused) { expectAllRefused(kPartLies); }
TEST(Hostile, LiesInPaletteAndRigsAreRefused) { expectAllRefused(kPaletteAndRigLies); }
TEST(Hostile, LiesInTheClipsAreRefused) { expectAllRefused(kClipLies); }
TEST(Hostile, LiesInTheSocketsAreRefused) { expectAllRefused(test::kSocketLies); }
TEST(Hostile, LiesInTheJointsAreRefused) { expectAllRefused(test::kJointLies, test::makeTinyJointPack()); }
TEST(Hostile, LiesInTheCagesAreRefused) { expectAllRefused(test::kCageLies, test::makeTinyCagePack()); }
TEST(Hostile, LiesInMorphsAreRefused) { expectAllRefused(test::kMorphLies, test::makeTinyMorphPack()); }
TEST(Hostile, LiesInGridsAreRefused) { expectAllRefused(kGridLies); }
TEST(Hostile, LiesInPagesAreRefused) { expectAllRefused(kPageLies); }

}  // namespace
}  // namespace kelp
