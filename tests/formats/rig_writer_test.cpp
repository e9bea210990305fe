// SPDX-License-Identifier: MIT
// writeRigs: the same bytes as a pack written with those rigs in the first place, whatever else is in the
// file, and nothing that a reader would refuse.
#include <gtest/gtest.h>

#include "kelp/formats/pack.h"
#include "kelp/formats/raw_pack.h"
#include "kelp/formats/sweep.h"
#include "pack_compare.h"
#include "pack_surgeon.h"
#include "support/random_pack.h"
#include "tiny_fog_pack.h"
#include "tiny_pack.h"

namespace kelp {
namespace {

using test::Bytes;

RawRigs rigsOf(const RawPack& pack) {
  RawRigs rigs;
  rigs.info_json = pack.info_json;
  rigs.clips = pack.clips;
  rigs.sockets = pack.sockets;
  for (const RawPart& part : pack.parts)
    rigs.parts.push_back({part.knots, part.automatic_tangents, part.parent_at, part.bend, part.roll});
  return rigs;
}

Result<void> rewrite(const Bytes& pack, const RawRigs& rigs, Bytes& out) {
  MemorySource source(pack);
  out.clear();
  return writeRigs(source.source(), rigs, Sink::into(out));
}

// Another rig for each part, and clips and sockets of its own.
RawPack otherRigs(const RawPack& pack, std::uint32_t seed) {
  RawPack other = pack;
  other.info_json = seed % 3 == 0 ? "" : R"({"other": true})";
  for (RawPart& part : other.parts) {
    part.knots = {{0, {0.1f, 0, 0.2f}, {0.3f, 1, 0}},
                  {0.5f, {0, 0.4f, 0}, {0, 1, 0.1f}},
                  {1, {0.2f, 1, 0}, {0, 1, 0.1f}}};
    part.automatic_tangents = 4;
    part.parent_at = part.parent < 0 || part.parent_at == 0.5f ? Part::kNotOnSpline : 0.5f;
    const bool sweeps = part.bend == Bend::kShear && checkSweep(part.knots, part.size, 0.25f);
    part.bend = sweeps ? Bend::kSweep : Bend::kShear;
    part.roll = sweeps ? 0.25f : 0.0f;
  }
  other.clips.clear();
  if (seed % 2 == 0) other.clips = {{"nod", 2, {{0, 2, Target::kKnotOffset, {1, 0, 0}, 2, 0}}, {}}};
  other.sockets.clear();
  if (seed / 2 % 2 == 0) other.sockets = {{"hand", 0, 0.25f, {0.5f, -1}, {0, 1, 0, 0}}};
  return other;
}

TEST(RigWriter, GivesTheBytesOfAPackWrittenThatWay) {
  Bytes out;
  for (std::uint32_t seed = 1; seed <= 24; ++seed) {
    RawPack pack = test::makeRandomPack(seed);
    if (seed % 4 == 0) pack.clips.clear();
    if (seed % 5 == 0) pack.info_json.clear();
    if (seed % 3 == 0) pack.sockets.clear();
    const RawPack other = otherRigs(pack, seed);
    ASSERT_TRUE(rewrite(test::writeToMemory(pack), rigsOf(other), out)) << seed;
    EXPECT_EQ(out, test::writeToMemory(other)) << seed;
    ASSERT_TRUE(rewrite(Bytes(out), rigsOf(pack), out)) << seed;
    EXPECT_EQ(out, test::writeToMemory(pack)) << seed;
  }
  const RawPack fog = test::makeTinyFogPack();
  ASSERT_TRUE(rewrite(test::writeToMemory(fog), rigsOf(otherRigs(fog, 2)), out));
  EXPECT_EQ(out, test::writeToMemory(otherRigs(fog, 2)));
}

TEST(RigWriter, KeepsChunksThatItDoesNotKnow) {
  const RawPack pack = test::makeTinyPack();
  const auto withNotes = [](const RawPack& of) {
    test::PackSurgeon surgeon(test::writeToMemory(of));
    test::PackSurgeon::Chunk note;
    note.fourcc = test::PackSurgeon::fourcc("NOTE");
    note.content = Bytes(70000, std::byte{7});
    surgeon.chunks.insert(surgeon.chunks.begin() + static_cast<std::ptrdiff_t>(surgeon.find("GRID")), note);
    surgeon.chunks.push_back(note);
    surgeon.minor = 5;  // of a later kelp
    return surgeon.build();
  };
  Bytes out;
  ASSERT_TRUE(rewrite(withNotes(pack), rigsOf(otherRigs(pack, 4)), out));
  const test::PackSurgeon was(withNotes(pack)), is(out);
  EXPECT_EQ(is.minor, 5);
  ASSERT_EQ(is.chunks.size(), was.chunks.size());
  for (std::size_t i = 0; i < is.chunks.size(); ++i) {
    EXPECT_EQ(is.chunks[i].fourcc, was.chunks[i].fourcc);
    const auto name = is.chunks[i].fourcc;
    const bool replaced =
        name == test::PackSurgeon::fourcc("INFO") || name == test::PackSurgeon::fourcc("RIGS") ||
        name == test::PackSurgeon::fourcc("CLIP") || name == test::PackSurgeon::fourcc("SOCK");
    EXPECT_EQ(is.chunks[i].content == was.chunks[i].content, !replaced) << i;
  }
}

TEST(RigWriter, RefusesWhatNoReaderWouldTake) {
  const RawPack pack = test::makeTinyPack();
  const Bytes bytes = test::writeToMemory(pack);
  Bytes out;
  const auto code = [&](auto change) {
    RawRigs rigs = rigsOf(pack);
    change(rigs);
    const Result<void> written = rewrite(bytes, rigs, out);
    EXPECT_FALSE(written);
    EXPECT_TRUE(out.empty()) << "written before the rigs were judged";
    return written ? ErrorCode::kIo : written.error().code;
  };
  EXPECT_EQ(code([](RawRigs& r) { r.parts.pop_back(); }), ErrorCode::kMisuse);
  EXPECT_EQ(code([](RawRigs& r) { r.parts[0].knots.resize(1); }), ErrorCode::kMisuse);
  EXPECT_EQ(code([](RawRigs& r) { r.parts[0].knots.back().position.y = -5; }), ErrorCode::kMisuse);
  EXPECT_EQ(code([](RawRigs& r) { r.parts[0].knots.resize(65); }), ErrorCode::kMisuse);
  EXPECT_EQ(code([](RawRigs& r) { r.clips[0].waves[0].knot = 9; }), ErrorCode::kMisuse);
  EXPECT_EQ(code([](RawRigs& r) { r.clips[0].name = std::string(256, 'a'); }), ErrorCode::kMisuse);
  EXPECT_EQ(code([](RawRigs& r) { r.info_json = "\xff"; }), ErrorCode::kMisuse);
  EXPECT_EQ(code([](RawRigs& r) { r.parts[0].parent_at = 0.5f; }), ErrorCode::kMisuse);  // has no parent
  EXPECT_EQ(code([](RawRigs& r) { r.parts[1].parent_at = 2; }), ErrorCode::kMisuse);
  EXPECT_EQ(code([](RawRigs& r) { r.parts[0].roll = 0.5f; }), ErrorCode::kMisuse);  // is sheared
  EXPECT_EQ(code([](RawRigs& r) { r.parts[1].roll = 3.2f; }), ErrorCode::kMisuse);
  EXPECT_EQ(code([](RawRigs& r) { r.parts[1].bend = static_cast<Bend>(2); }), ErrorCode::kMisuse);
  EXPECT_EQ(code([](RawRigs& r) { r.parts[1].knots[1].tangent = {0, -1, 0}; }), ErrorCode::kMisuse);
  EXPECT_EQ(code([](RawRigs& r) { r.sockets[0].part = 2; }), ErrorCode::kMisuse);
  EXPECT_EQ(code([](RawRigs& r) { r.sockets[1].name.clear(); }), ErrorCode::kMisuse);
  EXPECT_EQ(code([](RawRigs& r) { r.sockets[1].name = std::string(256, 'a'); }), ErrorCode::kMisuse);
  EXPECT_EQ(code([](RawRigs& r) { r.sockets[1].at = 1.5f; }), ErrorCode::kMisuse);
  EXPECT_EQ(code([](RawRigs& r) { r.sockets[1].offset.y = test::kNan; }), ErrorCode::kMisuse);
  EXPECT_EQ(code([](RawRigs& r) { r.sockets[1].rotation.w = 0; }), ErrorCode::kMisuse);
  MemorySource source(bytes);
  EXPECT_EQ(writeRigs(source.source(), rigsOf(pack), {}).error().code, ErrorCode::kMisuse);
}

// A pack that opened goes on to open: what the new tables and all others take together is asked before the
// first byte is written.
TEST(RigWriter, WhatIsWrittenOpensWithinTheSameLimits) {
  RawPack pack = test::makeTinyPack();
  pack.palette.resize(256);
  RawRigs larger = rigsOf(pack);
  larger.info_json = "{\"text\": \"" + std::string(5000, 'x') + "\"}";
  const Bytes bytes = test::writeToMemory(pack);
  int written = 0, refused = 0;
  for (std::uint64_t most = 1000; most < 60000; most += 50) {
    PackLimits limits;
    limits.max_metadata_bytes = most;
    MemorySource source(bytes);
    if (!Pack::open(source.source(), limits)) continue;
    Bytes out;
    if (!writeRigs(source.source(), larger, Sink::into(out), limits)) {
      EXPECT_TRUE(out.empty()) << most;
      ++refused;
      continue;
    }
    ++written;
    MemorySource again(out);
    EXPECT_TRUE(Pack::open(again.source(), limits)) << most;
  }
  EXPECT_GT(written, 10);
  EXPECT_GT(refused, 10);
}

TEST(RigWriter, TrustsNoSource) {
  const RawPack pack = test::makeTinyPack();
  const Bytes bytes = test::writeToMemory(pack);
  const test::PackSurgeon surgeon(bytes);
  Bytes out;
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(
        rewrite(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)), rigsOf(pack), out))
        << size;
  // Only gaps and what is replaced may be damaged without an error.
  int taken = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    Bytes flipped = bytes;
    flipped[i] ^= std::byte{1};
    if (!rewrite(flipped, rigsOf(pack), out)) continue;
    EXPECT_EQ(out, bytes) << i;
    ++taken;
  }
  EXPECT_LT(taken, static_cast<int>(bytes.size()) / 2);
  MemorySource source(bytes);
  int calls = 0;
  const auto refuse = [](void* user, std::span<const std::byte>) -> Result<void> {
    if (++*static_cast<int*>(user) < 4) return {};
    return Error{ErrorCode::kIo, "full"};
  };
  EXPECT_EQ(writeRigs(source.source(), rigsOf(pack), {refuse, &calls}).error().code, ErrorCode::kIo);
  EXPECT_EQ(calls, 4);
}

}  // namespace
}  // namespace kelp
