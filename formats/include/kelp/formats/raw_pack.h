// SPDX-License-Identifier: MIT
// Writing packs: plain structs that a tool fills in, and the functions that write them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kelp/formats/brick.h"
#include "kelp/formats/cage.h"
#include "kelp/formats/distance.h"
#include "kelp/formats/error.h"
#include "kelp/formats/model.h"
#include "kelp/formats/pack.h"

namespace kelp {

// One level of one part, as brick.h (solid) or fog.h (fog) describes it. The boxes of cells and codes are not
// written, and may be 0.
struct RawLevel {
  // One a brick of the grid, x fastest, then y, then z. A stored one holds its slot; slots number the stored
  // bricks in Morton order.
  std::vector<std::uint32_t> cells;
  // If the part is solid:
  std::vector<std::uint8_t> codes;  // 512 a slot. A voxel is solid if one that it covers is, surface too
  std::vector<std::uint32_t> attributes;  // one a surface voxel, slot by slot, in the order of codes
  // If the part is fog:
  std::vector<std::uint8_t> density;  // 729 a slot
  std::vector<std::uint8_t> heat;     // 729 a slot if the part's ramp has colors, else empty
  float extinction = 0;               // as in Fog
};

// One level of distances of one solid part, as kelp/formats/distance.h describes it.
struct RawDistances {
  DistanceBand band;
  // One a brick of the grid: kCellSolid | slot, or kFarOutside or kFarInside. Slots are in Morton order.
  std::vector<std::uint32_t> cells;
  std::vector<std::uint8_t> codes;  // 512 a slot
};

// As CageSource (kelp/formats/cage.h).
struct RawCage {
  std::vector<std::uint8_t> blocks;
  std::vector<std::uint8_t> masks;
  std::vector<std::uint32_t> split_points;
  std::vector<std::uint8_t> splits;
  std::vector<std::uint32_t> follows;

  CageSource source() const { return {blocks, masks, split_points, splits, follows}; }
};

// As Morph (kelp/formats/cage.h), of the finest cage.
struct RawMorph {
  std::uint32_t part = 0;
  float step = 0;                    // level-0 voxels, > 0: the unit of the offsets
  std::vector<std::uint32_t> nodes;  // ascending strictly
  std::vector<glm::ivec3> offsets;   // one for each, at most 2^20
};

// Like Fog.
struct RawFog {
  glm::vec3 color{1};
  float anisotropy = 0;
  float glow = 0;
  std::vector<glm::vec3> ramp;
};

struct RawPart {
  std::string name;
  int parent = -1;
  glm::ivec3 size{0};
  glm::mat4x3 to_object{1};
  glm::mat4x3 pivot{1};
  std::vector<Knot> knots;
  std::uint64_t automatic_tangents = 0;  // as in Part
  float parent_at = Part::kNotOnSpline;  // as in Part
  Bend bend = Bend::kShear;              // as in Part
  float roll = 0;                        // as in Part
  std::vector<RawLevel> levels;          // finest first; none: the part is empty
  // Finest first: distanceLevels() of them for every solid part of the pack, or none for any.
  std::vector<RawDistances> distances;
  std::optional<RawFog> fog;  // set: the part is fog
  // One for each of the levels, or none. cell: side of the finest one's cells: 2, 4, 8 or 16.
  int cell = 0;
  std::vector<RawCage> cages;
  // One for each node of the finest cage; none: the nodes go where the part's own spline takes them.
  std::vector<Influences> influences;
  std::vector<RawMorph> morphs;  // by part, ascending strictly; only with influences
  int sections = -1;             // as in Part; only without influences
};

struct RawTrack {
  std::uint32_t part = 0;
  std::uint32_t knot = 0;
  Target target = Target::kKnotOffset;
  Interpolation interpolation = Interpolation::kLinear;
  std::vector<Key> keys;
};

struct RawClip {
  std::string name;
  float duration = 0;
  std::vector<Wave> waves;
  std::vector<RawTrack> tracks;
};

struct RawSocket {  // as Socket
  std::string name;
  std::uint32_t part = 0;
  float at = 0;
  glm::vec2 offset{0};
  glm::quat rotation{1, 0, 0, 0};
};

struct RawJoint {  // as Joint
  std::string name;
  int parent = -1;
  glm::mat4x3 inverse_bind{1};
  std::vector<std::uint32_t> parts;
};

struct RawPack {
  std::string info_json;
  std::vector<Material> palette;
  std::vector<RawPart> parts;
  std::vector<RawClip> clips;
  std::vector<RawSocket> sockets;
  std::vector<RawJoint> joints;
};

// Receives the bytes of the file in order. An error of `write` stops the writer, which returns it.
struct Sink {
  Result<void> (*write)(void* user, std::span<const std::byte> bytes) = nullptr;
  void* user = nullptr;

  // Appends to `bytes`, which must live while the sink is used.
  static Sink into(std::vector<std::byte>& bytes) {
    return {[](void* user, std::span<const std::byte> more) {
              auto& all = *static_cast<std::vector<std::byte>*>(user);
              all.insert(all.end(), more.begin(), more.end());
              return Result<void>();
            },
            &bytes};
  }
};

// How hard writePack tries to make pages of voxels small.
enum class Effort : std::uint8_t {
  kFast,
  kBest,  // up to half a percent smaller, four times as long
};

// Writes the pack. The same RawPack gives the same bytes on every machine. Everything is checked before the
// first byte is written. kMisuse, with a text, for everything that the reader would refuse; the sink's error;
// kOutOfMemory. threads: how many threads compress pages, at least 1.
Result<void> writePack(const RawPack& pack, const Sink& sink, int threads = 1, Effort effort = Effort::kFast);

// The rest rig of a part, as in Part.
struct RawRig {
  std::vector<Knot> knots;
  std::uint64_t automatic_tangents = 0;
  float parent_at = Part::kNotOnSpline;
  Bend bend = Bend::kShear;
  float roll = 0;
};

// The cages of a part, as in RawPart.
struct RawCages {
  int cell = 0;
  std::vector<RawCage> cages;
  std::vector<Influences> influences;
  std::vector<RawMorph> morphs;
  int sections = -1;
};

// The content that writeRigs replaces in a pack.
struct RawRigs {
  std::string info_json;
  std::vector<RawRig> parts;
  std::vector<RawClip> clips;
  std::vector<RawSocket> sockets;
  std::optional<std::vector<RawCages>> cages =
      std::nullopt;  // one for each part; absent: the pack keeps its own
};

// Writes the pack in `source` again, with other information, rest rigs, clips, sockets and cages. Every other
// chunk is copied byte by byte, unknown kinds included, and compared with its checksum on the way. So the
// result has the same bytes as writePack would write. kMisuse, with a text, if the rigs break the rules of
// SPEC.md; the errors of Pack::open if the source is not a valid pack; kChecksum; the sink's error. Safe for
// hostile sources. After an error, discard what the sink received. Memory: the metadata, twice the new cages,
// and a block of 64 KiB.
Result<void> writeRigs(const Source& source, const RawRigs& rigs, const Sink& sink,
                       const PackLimits& limits = {});

}  // namespace kelp
