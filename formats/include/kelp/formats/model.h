// SPDX-License-Identifier: MIT
// What a pack holds besides voxels: parts, palette, rigs, clips. The reader hands these out as views into memory that the Pack owns.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "kelp/formats/geometry.h"
#include "kelp/formats/spline.h"

namespace kelp {

// One entry of the palette. Colours are linear, Rec. 709 primaries.
struct Material {
  glm::vec4 base_color{1};   // alpha is coverage, 1 = opaque
  glm::vec3 emissive{0};
  float metallic = 0;
  float roughness = 1;
};

enum class PartKind : std::uint8_t { kSolid = 0, kFog = 1 };

// What a fog part's samples mean: how much light is stopped and given off along a ray (kelp/formats/fog.h has the samples). Lengths in level-0 voxels.
struct Fog {
  glm::vec3 color{1};             // 0 to 1: of the light that is stopped, the share that goes on in another direction; the rest is lost
  float anisotropy = 0;           // -1 to 1, both excluded: the mean cosine of that turn. 0: any direction; near 1: hardly a turn
  float glow = 0;                 // at least 0: at heat 1, radiance given off along a length of 1 is this times the ramp's colour there
  std::span<const glm::vec3> ramp;        // linear, at least 0, cold to hot: 2 to 256 colours, or none: the part has no heat
  std::span<const float> extinction;      // > 0, one a level: optical depth of a length of 1 at density 1

  int channels() const { return ramp.empty() ? 1 : 2; }
};

// A voxel volume with one rig. Its own space is level-0 voxels: the box [0,size.x] x [0,size.y] x [0,size.z], +y along the spline.
struct Part {
  std::string_view name;
  int parent = -1;               // index of an earlier part whose motion this part follows; -1: none
  PartKind kind = PartKind::kSolid;
  int levels = 1;                // level l has ceil(size / 2^l) voxels
  glm::ivec3 size{0};            // level-0 voxels
  glm::mat4x3 to_object{1};      // voxels -> object (metres, +Y up, right-handed, as glTF), at rest
  glm::mat4x3 pivot{1};          // pivot space -> object: where kPartTranslation, kPartRotation and kPartScale act
  std::span<const Knot> knots;   // the rest rig
  const Fog* fog = nullptr;      // of parts of the kind kFog
};

// What a channel of a clip moves. Values of a clip are added to the rest rig (weighted), so that clips can be blended.
enum class Target : std::uint8_t {
  kKnotOffset = 0,        // knot position, voxels
  kKnotTangent = 1,       // knot tangent, dS/d(at), voxels
  kPartTranslation = 2,   // pivot units
  kPartRotation = 3,      // unit quaternion x, y, z, w in pivot space; identity at rest
  kPartScale = 4,         // factor per pivot axis, minus 1
};

// value(t) = amplitude * sin(2 pi (t / period + phase)). For knots only.
struct Wave {
  std::uint32_t part = 0;
  std::uint32_t knot = 0;
  Target target = Target::kKnotOffset;
  glm::vec3 amplitude{0};
  float period = 1;  // seconds, > 0
  float phase = 0;   // turns
};

enum class Interpolation : std::uint8_t { kStep = 0, kLinear = 1, kCubic = 2 };

// Key of a track. in and out are the slopes per second before and after the key, used by kCubic only (as glTF's CUBICSPLINE).
struct Key {
  float time = 0;  // seconds
  glm::vec4 value{0};
  glm::vec4 in{0};
  glm::vec4 out{0};
};

// Keyframes; times ascend strictly, the first and last values hold outside. Rotations are normalised after (spherical) interpolation.
struct Track {
  std::uint32_t part = 0;
  std::uint32_t knot = 0;  // 0 for the targets of parts
  Target target = Target::kKnotOffset;
  Interpolation interpolation = Interpolation::kLinear;
  std::span<const Key> keys;
};

// The waves of a clip once more, added up so that they are cheap to evaluate: sin(a + b) = sin a cos b + cos a sin b, so all waves of one period share a
// sine and a cosine, and all waves that move one number are one sum. The reader makes this of `waves`.
struct WaveSums {
  std::uint32_t first = 0;  // four sums, for as many numbers in a row, from this one of an array of the knots of all parts
  struct {
    float sine[4] = {};     // for each sum: times sin(2 pi t / period)
    float cosine[4] = {};   // times cos(2 pi t / period)
  } of[4];                  // each of the block's periods
};
struct WaveBlock {
  double frequencies[4] = {};  // 1 / period, falling
  std::size_t periods = 0;     // as many of them
  std::span<const WaveSums> sums;
};
// Adds `weight` times what the waves do at `seconds` to the knots, which are those of all parts, one part after the other. Sines are within 1e-6 of
// the truth, whatever the time, as long as a double can tell its phase; beyond, all phases are 0. Finite numbers only.
void addWaves(const WaveBlock& block, double seconds, float weight, std::span<Knot> knots);

// An animation. Tracks repeat after `duration` seconds; waves never end. A clip of waves alone has the duration of its longest period.
struct Clip {
  std::string_view name;
  float duration = 0;  // seconds, > 0
  std::span<const Wave> waves;
  std::span<const Track> tracks;
  std::span<const WaveBlock> wave_blocks;
};

}  // namespace kelp
