// SPDX-License-Identifier: MIT
// Rigs and clips as an artist writes them (*.rig.json, a glTF node's extras.kelp), and their translation into a part's voxels.
// The language is described, with examples, in tools/rig_json/README.md.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "kelp/formats/raw_pack.h"

namespace kelp {

enum class Axis : std::uint8_t { kPlusX, kMinusX, kPlusY, kMinusY, kPlusZ, kMinusZ };
std::optional<Axis> parseAxis(std::string_view text);  // "+x", "x", "-y", ...
const char* toString(Axis axis);

// Proper rotation (determinant +1) that takes the artist's axes to the part's, where +y runs along the spline: part = rotation * artist.
// The identity for +y.
glm::mat3 axisRotation(Axis axis);

// A rig in the artist's own units: vectors in the artist's axes, 1 = the source's extent along the axis.
struct RigDescription {
  struct Knot {
    float at = 0;
    glm::vec3 offset{0};
    std::optional<glm::vec3> tangent;  // dS/d(at); automatic (Catmull-Rom over the knots' rest positions) if absent
    bool operator==(const Knot&) const = default;
  };
  struct Wave {
    int knot = 0;
    Target target = Target::kKnotOffset;
    glm::vec3 amplitude{0};
    float period = 1;
    float phase = 0;
    bool operator==(const Wave&) const = default;
  };
  struct Key {
    float time = 0;
    glm::vec4 value{0};            // artist's axes; for part targets: as formats/model.h has them (scale: factor minus 1)
    std::optional<glm::vec4> in, out;  // slopes per second; automatic (Catmull-Rom over the keys) if absent, for kCubic
    bool operator==(const Key&) const = default;
  };
  struct Track {
    int knot = 0;
    Target target = Target::kKnotOffset;
    Interpolation interpolation = Interpolation::kLinear;
    std::vector<Key> keys;
    bool operator==(const Track&) const = default;
  };
  struct Clip {
    std::string name;
    std::optional<float> duration;  // seconds; else the last key's time, or the longest period
    std::vector<Wave> waves;
    std::vector<Track> tracks;
    bool operator==(const Clip&) const = default;
  };

  std::optional<Axis> axis;  // in the node's (or file's) own axes; +y if absent
  std::vector<Knot> knots;   // empty: two, at 0 and 1
  std::vector<Clip> clips;
  bool operator==(const RigDescription&) const = default;
};

// Rigs are refused with this: what() is one line that names the place (JSON pointer or clip and knot), what is wrong and what to do.
struct RigError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Reads a rig. Unknown keys, wrong types, non-finite numbers, knots that do not ascend from 0 to 1: RigError.
// `text` is hostile-safe: depth and size are bounded.
RigDescription parseRig(std::string_view text);
// Writes it; parseRig of the result gives an equal description.
std::string printRig(const RigDescription& rig);

// The presets: "none" (straight, no clips), "sway" (a plant: the upper end moves), "swim" (a fish: a wave runs down three knots). nullopt: no such preset.
// Presets move at right angles to the axis they are made for: pass the axis here rather than changing it afterwards. Absent: the preset's own
// (+y; swim: -z, from the head to the tail of a fish that faces +z, as glTF's models do).
// `up`: the file's axis that points up, +y if none is given: without `axis`, what sways bends along it.
std::optional<RigDescription> presetRig(std::string_view name, std::optional<Axis> axis = std::nullopt, std::optional<Axis> up = std::nullopt);
std::vector<std::string> presetNames();

// Rest knots in voxels of a part whose axis is size.y voxels long.
std::vector<Knot> realizeKnots(const RigDescription& rig, const glm::ivec3& size);
// Clips in voxels; their waves and tracks name part `part`. Clips of several parts that share a name are merged with mergeClips.
std::vector<RawClip> realizeClips(const RigDescription& rig, const glm::ivec3& size, std::uint32_t part);
void mergeClips(std::vector<RawClip>& into, std::vector<RawClip> clips);
// What a clip does to each part that it moves, in the parts' order: of the clip's name and duration.
std::vector<std::pair<std::uint32_t, RawClip>> splitByPart(const RawClip& clip);
// The way back, for `kelp-dump rig`: explicit tangents, in the axes of an artist for whom the part's axis is `axis`.
RigDescription describeRig(std::span<const Knot> knots, std::span<const RawClip> clips, std::uint32_t part, const glm::ivec3& size, Axis axis = Axis::kPlusY);

// What a clip does to one part over its whole length.
struct ClipReport {
  Box bounds;          // voxels: contains the deformed box at every time (conservative)
  float leaves_box = 0;  // how far the deformed box leaves the box at rest, in units of size.y
};

// Proves that the part's spline stays monotone at every time of the clip (interval arithmetic over subdivided time; waves with unrelated
// periods are taken at their worst) and bounds the motion. RigError that names the clip, the segment and a time at which it turns back.
ClipReport proveClip(const RawClip& clip, std::uint32_t part, std::span<const Knot> knots, const glm::ivec3& size);

}  // namespace kelp
