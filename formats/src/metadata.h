// SPDX-License-Identifier: MIT
// The metadata chunks as tables in memory. Each function reads one decoded chunk and checks every rule of
// SPEC.md. Safe for hostile chunks. The writer calls them too, on what it is about to write. The offset of
// an error counts from the start of the chunk. Codes: kCorrupt, kNotMonotone and kFolds (rigs),
// kLimit, kUnsupportedFeature (parts, rigs), kOutOfMemory.
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
  // most: bytes of all tables together.
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
        tracks(allocator),
        keys(allocator),
        socket_names(allocator),
        sockets(allocator),
        joint_names(allocator),
        joint_parts(allocator),
        joints(allocator),
        cages(allocator),
        cage_words(allocator),
        influences(allocator),
        morphs(allocator),
        moved_nodes(allocator) {}

  // Subtracts the bytes of a table from the room that is left. False if the limits do not allow it. Counts
  // have 32 bits, so the product does not overflow.
  bool takeRoom(std::uint64_t count, std::size_t bytes) {
    if (count * bytes > room) return false;
    room -= count * bytes;
    return true;
  }

  Allocator allocator;
  std::uint64_t room;
  Buffer<char> info;
  Buffer<char> part_names;
  Buffer<Part> parts;  // names point into part_names, knots into `knots`
  Buffer<Material> palette;
  Buffer<Fog> fogs;  // parts point here; spans point into the next two tables
  Buffer<float> extinctions;
  Buffer<glm::vec3> ramps;
  Buffer<Knot> knots;
  Buffer<char> clip_names;
  Buffer<Clip> clips;  // names point into clip_names; waves and tracks into the next tables
  Buffer<Wave> waves;
  Buffer<Track> tracks;  // keys point into `keys`
  Buffer<Key> keys;
  Buffer<char> socket_names;
  Buffer<Socket> sockets;  // names point into socket_names
  Buffer<char> joint_names;
  Buffer<std::uint32_t> joint_parts;
  Buffer<Joint> joints;  // names point into joint_names, parts into joint_parts
  Buffer<Cage> cages;    // parts point here; spans point into the next tables
  Buffer<std::uint32_t> cage_words;
  Buffer<Influences> influences;
  Buffer<Morph> morphs;
  Buffer<MovedNode> moved_nodes;
};

Result<void> parseInfo(std::span<const std::byte> chunk, Metadata& out);
Result<void> parseParts(std::span<const std::byte> chunk, const PackLimits& limits, Metadata& out);
Result<void> parsePalette(std::span<const std::byte> chunk, Metadata& out);
// Call it after parseParts. `chunk` is empty if the file has no FOGS. There must be a table if a part is
// fog, and only then.
Result<void> parseFogs(std::span<const std::byte> chunk, Metadata& out);
Result<void> parseRigs(std::span<const std::byte> chunk, Metadata& out);     // call it after parseParts
Result<void> parseClips(std::span<const std::byte> chunk, Metadata& out);    // call it after parseRigs
Result<void> parseSockets(std::span<const std::byte> chunk, Metadata& out);  // call it after parseParts
Result<void> parseJoints(std::span<const std::byte> chunk, Metadata& out);   // likewise
Result<void> parseCages(std::span<const std::byte> chunk, Metadata& out);    // likewise

// True if the text is UTF-8 without overlong forms, surrogates and U+0000. A name must not have control
// characters either.
bool isUtf8(std::string_view text);
bool isName(std::string_view text);

}  // namespace kelp
