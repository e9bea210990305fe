// SPDX-License-Identifier: MIT
// The content of a pack besides voxels: parts, palette, rigs, clips, sockets, joints. The reader returns
// these as views into memory that the Pack owns.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include <glm/gtc/quaternion.hpp>

#include "kelp/formats/cage.h"
#include "kelp/formats/geometry.h"
#include "kelp/formats/spline.h"

namespace kelp {

// One entry of the palette. Colors are linear, Rec. 709 primaries.
struct Material {
  glm::vec4 base_color{1};  // alpha is coverage, 1 = opaque
  glm::vec3 emissive{0};
  float metallic = 0;
  float roughness = 1;
};

enum class PartKind : std::uint8_t {
  kSolid = 0,
  kFog = 1,
  kEmpty = 2,  // no voxels: a place in the hierarchy that clips move, and that parts and sockets follow
};

// "solid", "fog" or "empty".
constexpr const char* toString(PartKind kind) {
  return kind == PartKind::kSolid ? "solid" : kind == PartKind::kFog ? "fog" : "empty";
}

// The meaning of a fog part's samples: how much light fog absorbs, scatters and emits along a ray.
// kelp/formats/fog.h describes the samples. Lengths are in level-0 voxels.
struct Fog {
  // Albedo, 0 to 1: the share of the stopped light that is scattered. The rest is absorbed.
  glm::vec3 color{1};
  // Mean cosine of the scattering angle, between -1 and 1, both excluded. 0: every direction is equally
  // likely; near 1: light nearly keeps its direction.
  float anisotropy = 0;
  // Emission, at least 0: at heat 1, radiance emitted along a length of 1 is this times the ramp's last
  // color.
  float glow = 0;
  // Colors from cold to hot, linear, each at least 0: 2 to 256 of them. Empty: the part has no heat.
  std::span<const glm::vec3> ramp;
  std::span<const float> extinction;  // one a level, > 0: optical depth of a length of 1 at density 1

  int channels() const { return ramp.empty() ? 1 : 2; }
};

// A voxel volume with one rig, or a rig alone. Part space is in level-0 voxels: the box [0,size.x] x
// [0,size.y] x [0,size.z], with +y along the spline.
struct Part {
  std::string_view name;
  int parent = -1;  // index of an earlier part, whose motion this part follows; -1: none
  PartKind kind = PartKind::kSolid;
  int levels = 1;            // level l has ceil(size / 2^l) voxels; 0: the part is empty
  glm::ivec3 size{0};        // level-0 voxels
  glm::mat4x3 to_object{1};  // voxels -> object (meters, +Y up, right-handed, as glTF), at rest
  // Pivot space -> object. kPartTranslation, kPartRotation and kPartScale act in pivot space.
  glm::mat4x3 pivot{1};
  std::span<const Knot> knots;  // the rest rig
  // Bit i: the tangent of knot i follows when that knot or a neighbor moves (followOf). A clip that moves
  // the tangent itself overrides this in that clip.
  std::uint64_t automatic_tangents = 0;
  // Where the part hangs on its parent's spline: the `at` of that place, 0 to 1. It moves with the spline
  // there, as a socket does. kNotOnSpline: it follows the parent's motion alone.
  static constexpr float kNotOnSpline = -1;
  float parent_at = kNotOnSpline;
  Bend bend = Bend::kShear;  // kSweep: for solid parts only
  float roll = 0;            // of a swept part: radians, its turn about the spline at the first knot
  const Fog* fog = nullptr;  // set if kind is kFog, else null
  // One cage a level, finest first; empty: the part has none. A part with cages is drawn through them: their
  // nodes go where the spline takes them, as `bend` says, or where the host puts them. For solid parts only.
  std::span<const Cage> cages;
  // Of a part with cages that its own spline moves: the empty part whose knots say how wide and how far
  // turned its sections are (SPEC.md 4.9, Sections); -1: they are as at rest.
  int sections = -1;
};

// A named place on a part to which a game attaches things. It moves with the spline. At rest, in part space,
// its origin is (X / 2 + offset.x Y, at Y, Z / 2 + offset.y Y), where the part has X x Y x Z voxels; its axes
// are the part's, turned by `rotation`.
struct Socket {
  std::string_view name;
  std::uint32_t part = 0;
  float at = 0;                    // place along the axis, 0 to 1
  glm::vec2 offset{0};             // across the axis, from the middle line: part x and z, heights of the part
  glm::quat rotation{1, 0, 0, 0};  // unit
};

// A joint of the skin that the parts were made of, for hosts that move its skeleton themselves. Parents come
// first. Names are the source's and need not be unique. Joint space has the source's axes and units. With a
// matrix M from joint space to the object, what follows the joint alone goes from x in the object at rest to
// M * inverse_bind * x; what follows several, to the weighted sum of these.
struct Joint {
  std::string_view name;
  int parent = -1;              // an earlier joint; -1: none
  glm::mat4x3 inverse_bind{1};  // object at rest -> joint space
  // The parts made to move as it does, alone or with other joints (as a swept part with those of its chain);
  // ascending.
  std::span<const std::uint32_t> parts;
};

// The target of a wave or track of a clip. Values are multiplied by a weight and added to the rest rig, so
// clips can be blended.
enum class Target : std::uint8_t {
  kKnotOffset = 0,       // knot position, in heights of the part
  kKnotTangent = 1,      // knot tangent, dS/d(at), in heights of the part
  kPartTranslation = 2,  // pivot units
  kPartRotation = 3,     // unit quaternion x, y, z, w in pivot space; identity at rest
  kPartScale = 4,        // factor per pivot axis, minus 1
};

// value(t) = amplitude * sin(2 pi (t / period + phase)). Moves knots only.
struct Wave {
  std::uint32_t part = 0;
  std::uint32_t knot = 0;
  Target target = Target::kKnotOffset;
  glm::vec3 amplitude{0};
  float period = 1;  // seconds, > 0
  float phase = 0;   // turns
};

enum class Interpolation : std::uint8_t { kStep = 0, kLinear = 1, kCubic = 2 };

// A key of a track. `in` and `out` are the slopes per second before and after the key. Only kCubic uses them,
// as glTF's CUBICSPLINE does.
struct Key {
  float time = 0;  // seconds
  glm::vec4 value{0};
  glm::vec4 in{0};
  glm::vec4 out{0};
};

// Keyframes. Times ascend strictly. Before the first key and after the last, their values hold. Rotations are
// interpolated spherically, then normalized.
struct Track {
  std::uint32_t part = 0;
  std::uint32_t knot = 0;  // 0 if the target is a part
  Target target = Target::kKnotOffset;
  Interpolation interpolation = Interpolation::kLinear;
  std::span<const Key> keys;
};

// An animation. Tracks repeat after `duration` seconds; waves never end. A clip without tracks has the
// duration of its longest period.
struct Clip {
  std::string_view name;
  float duration = 0;  // seconds, > 0
  std::span<const Wave> waves;
  std::span<const Track> tracks;
};

}  // namespace kelp
