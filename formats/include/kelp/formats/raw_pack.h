// SPDX-License-Identifier: MIT
// The writer's side: a pack as plain data that a tool fills in, and the function that writes it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kelp/formats/brick.h"
#include "kelp/formats/error.h"
#include "kelp/formats/model.h"
#include "kelp/formats/pack.h"

namespace kelp {

// One level of one part, as brick.h, or fog.h, describes it.
struct RawLevel {
  std::vector<std::uint32_t> cells;       // one a brick of the grid; slots number the stored bricks in Morton order
  // Of a solid part.
  std::vector<std::uint8_t> codes;        // 512 a slot
  std::vector<std::uint32_t> attributes;  // of all surface voxels, slot by slot, in code order
  // Of fog.
  std::vector<std::uint8_t> density;      // 729 a slot
  std::vector<std::uint8_t> heat;         // as many, if the part's ramp has colours
  float extinction = 0;                   // see Fog
};

// See Fog.
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
  std::vector<RawLevel> levels;  // finest first, at least one
  std::optional<RawFog> fog;     // set: the part is of the kind kFog
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

struct RawPack {
  std::string info_json;
  std::vector<Material> palette;
  std::vector<RawPart> parts;
  std::vector<RawClip> clips;
};

// Receives the file's bytes in order, from the first to the last. Answers false to stop (the writer then answers kIo).
struct Sink {
  bool (*write)(void* user, std::span<const std::byte> bytes) = nullptr;
  void* user = nullptr;
};

// Writes the pack. The same RawPack gives the same bytes on every machine. kMisuse with a word if the data break the rules of SPEC.md
// (all that the reader would refuse), kIo if the sink does, kOutOfMemory. Nothing is written before the data were checked.
// threads: how many compress pages at once, at least 1.
Result<void> writePack(const RawPack& pack, const Sink& sink, int threads = 1);

// What can be replaced in a pack that stays as it is otherwise.
struct RawRigs {
  std::string info_json;
  std::vector<std::vector<Knot>> knots;  // one list a part
  std::vector<RawClip> clips;
};

// Writes the pack in `source` once more with other information, rest knots and clips. Every other chunk, voxels and chunks of unknown kinds among them, is
// copied byte by byte and compared with its checksum on the way: where nothing else differs, the bytes are those that writePack would give. kMisuse with a
// word if the rigs break the rules of SPEC.md; what Pack::open answers for a source that is no sound pack; kChecksum, kIo. The source is not trusted; what
// the sink got before an error is of no use. Memory: the metadata and a block of 64 KiB.
Result<void> writeRigs(const Source& source, const RawRigs& rigs, const Sink& sink, const Limits& limits = {});

}  // namespace kelp
