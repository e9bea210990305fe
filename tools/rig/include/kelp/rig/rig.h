// SPDX-License-Identifier: MIT
// Rigs and clips as an artist writes them (*.rig.json, a glTF node's extras.kelp), and their translation
// into the knots and clips of a part. The language is described, with examples, in tools/rig/LANGUAGE.md.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "kelp/formats/raw_pack.h"

namespace kelp {

enum class Axis : std::uint8_t { kPlusX, kMinusX, kPlusY, kMinusY, kPlusZ, kMinusZ };
std::optional<Axis> parseAxis(std::string_view text);  // "+x", "x", "-y", ...
const char* toString(Axis axis);

// Proper rotation (determinant +1) that takes the artist's axes to the part's, where +y runs along the
// spline: part = rotation * artist. The identity for +y.
glm::mat3 axisRotation(Axis axis);

// A rig in the artist's own units: vectors in the artist's axes, 1 = the source's extent along the axis.
struct RigDescription {
  // How a section across the axis differs from a straight part's; linear between knots.
  struct Section {
    glm::vec2 width{1};     // factors along the two axes across, in the order x, y, z
    float twist = 0;        // radians, about the axis by the right hand
    float keep_volume = 0;  // 0 to 1
    bool operator==(const Section&) const = default;
  };
  struct Knot {
    float at = 0;
    glm::vec3 offset{0};
    // dS/d(at); automatic (Catmull-Rom over the knots' rest positions) if absent
    std::optional<glm::vec3> tangent;
    Section section{};
    bool operator==(const Knot&) const = default;
  };
  struct Wave {
    int knot = 0;
    Target target = Target::kKnotOffset;
    glm::vec3 amplitude{0};
    float period = 1;
    float phase = 0;
    // Moves the section: kKnotOffset its width (x, y), kKnotTangent its twist (x).
    bool of_section = false;
    bool operator==(const Wave&) const = default;
  };
  struct Key {
    float time = 0;
    // artist's axes; for part targets: as formats/model.h has them (scale: factor minus 1)
    glm::vec4 value{0};
    // slopes per second; automatic (Catmull-Rom over the keys) if absent, for kCubic
    std::optional<glm::vec4> in, out;
    bool operator==(const Key&) const = default;
  };
  struct Track {
    int knot = 0;
    Target target = Target::kKnotOffset;
    Interpolation interpolation = Interpolation::kLinear;
    std::vector<Key> keys;
    bool of_section = false;  // as in Wave; widths are less 1
    bool operator==(const Track&) const = default;
  };
  struct Clip {
    std::string name;
    std::optional<float> duration;  // seconds; else the last key's time, or the longest period
    std::vector<Wave> waves;
    std::vector<Track> tracks;
    bool operator==(const Clip&) const = default;
  };

  // A named place on the part.
  struct Socket {
    std::string name;
    float at = 0;                    // along the axis, 0 to 1
    glm::vec3 offset{0};             // from the middle line, across the axis
    glm::quat rotation{1, 0, 0, 0};  // unit; without one the frame's y runs along the spline
    bool operator==(const Socket&) const = default;
  };

  // One of the four edges along the axis, with a spline of its own. Its clips move knots alone.
  struct Side {
    std::string corner;  // of the section: cornerName()
    std::vector<Knot> knots;
    std::vector<Clip> clips;
    bool operator==(const Side&) const = default;
  };

  std::optional<Axis> axis;  // in the node's (or file's) own axes; +y if absent
  std::vector<Knot> knots;   // empty: two, at 0 and 1
  std::vector<Clip> clips;
  std::vector<Socket> sockets;           // at most kMaxSockets, each with a name of its own
  float parent_at = Part::kNotOnSpline;  // place on the parent part's spline, as Part::parent_at
  std::optional<Bend> bend;              // kDefaultBend if absent
  bool caged = false;                    // "cage": drawn through a cage, which moves as `bend` says: kSweep,
                                         // with sides kShear
  int cell = 0;                          // side of its cells, as RawPart::cell; 0: the baker's choice
  float roll = 0;                        // as Part::roll; 0 unless `bend` is kSweep
  // Not empty: the part is caged, and its nodes follow these, bilinear between the four corners. A corner
  // that is absent moves as knots and clips above do.
  std::vector<Side> sides;
  bool operator==(const RigDescription&) const = default;
};

// The rest rig of a part, and the cage that its rig asks for.
struct RestRig : RawRig {
  bool caged = false;  // as in RigDescription
  int cell = 0;
};

inline constexpr std::size_t kMaxSockets = 1024;
// The bend of a part whose rig does not name one.
inline constexpr Bend kDefaultBend = Bend::kShear;
std::optional<Bend> parseBend(std::string_view text);  // "shear", "sweep"
const char* toString(Bend bend, bool caged = false);   // caged: "cage"
// The roll of a part in degrees, as the rig language has it, and back.
double rollInDegrees(float roll);
float rollOfDegrees(double degrees);

// The exception of parseRig, printRig and proveClip. what() is one line: the place (a JSON pointer, or clip
// and knot), the fault, the remedy.
struct RigError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Reads a rig. RigError for unknown keys, wrong types, numbers that are not finite, and knots that do not
// ascend from 0 to 1. Safe for hostile input: size and depth are bounded.
RigDescription parseRig(std::string_view text);
// Writes a rig as JSON. parseRig of the result gives an equal description. RigError if two tracks move the
// same thing.
std::string printRig(const RigDescription& rig);

// The presets: "none" (straight, no clips), "sway" (a plant: the upper end moves), "swim" (a fish: a wave
// runs down three knots), "breathe" (the middle widens), "twist" (the end turns). nullopt: no such preset.
// Presets move at right angles to `axis`, so give the axis here and do not change it afterwards. Absent:
// `up`, and for swim -z, from the head to the tail of a fish that faces +z as in glTF. `up` is the file's
// axis that points up, +y if absent.
std::optional<RigDescription> presetRig(std::string_view name, std::optional<Axis> axis = std::nullopt,
                                        std::optional<Axis> up = std::nullopt);
std::vector<std::string> presetNames();

// The rest knots, in the axes of the part.
std::vector<Knot> realizeKnots(const RigDescription& rig);
// Which of them have an automatic tangent, as Part::automatic_tangents.
std::uint64_t automaticTangents(const RigDescription& rig);
// The rest rig: both of them, and how the part bends. A rig that does not say bends as `by_default`.
RestRig realizeRig(const RigDescription& rig, Bend by_default = kDefaultBend);
// Refuses the rest rig of a part of `size` voxels that cannot be drawn. RigError names the knot and says what
// to do.
void checkRest(const RawRig& rest, const glm::ivec3& size);
// The clips, in the axes of the part; their waves and tracks name part `part`. mergeClips joins clips of
// several parts that have the same name.
std::vector<RawClip> realizeClips(const RigDescription& rig, std::uint32_t part);
void mergeClips(std::vector<RawClip>& into, std::vector<RawClip> clips);
// Makes computed rotations as nearly unit as floats can be. realizeClips leaves such as they are, so that a
// rig that is printed and read again stays the same.
void normalizeRotations(std::vector<RigDescription::Track>& tracks);
// The sockets, in the axes of the part `part`. RigError for an offset that is not across the axis.
std::vector<RawSocket> realizeSockets(const RigDescription& rig, std::uint32_t part);
// The pairs (part, what the clip does to it) for all parts that the clip moves, ascending; each has the
// clip's name and duration.
std::vector<std::pair<std::uint32_t, RawClip>> splitByPart(const RawClip& clip);
// The inverse of realizeRig, realizeClips and realizeSockets, for `kelp-dump rig`;
// `axis` is the part's axis in the artist's axes.
RigDescription describeRig(const RestRig& rest, std::span<const RawClip> clips, std::uint32_t part,
                           Axis axis = Axis::kPlusY, std::span<const RawSocket> sockets = {});

// True if knots or clips widen or turn sections.
bool hasSections(const RigDescription& rig);
// The rig of the empty part that says a part's sections (Part::sections), and back.
RigDescription sectionRig(const RigDescription& rig);
void addSections(const RigDescription& of_sections, RigDescription& rig);

// The corner of a section in the artist's axes: "-x-z". corner: bit 0: towards the part's +x, bit 1: its +z.
std::string cornerName(int corner, Axis axis);
// The side for the corners that a rig leaves out: its name and its rig.
inline constexpr const char* kOwnSide = "own";
RigDescription ownSide(const RigDescription& rig);
// The rigs of the empty parts that the nodes of a part with sides follow, by the names of the sides; and
// which of them each corner follows. RigError for a corner that is not across the axis.
struct SideRigs {
  std::vector<std::pair<std::string, RigDescription>> parts;
  int followed[4] = {-1, -1, -1, -1};
};
SideRigs sideRigs(const RigDescription& rig);
// Says where the splines of the four corners pass through each other, so that a section is turned around: at
// rest (clip: null) or at one of some moments of a clip. Empty: nowhere. parts, rests: of the corners.
std::string sidesCross(const std::array<std::uint32_t, 4>& parts, const std::array<RawRig, 4>& rests,
                       const RawClip* clip, const glm::ivec3& size);

// The motion of one part over the whole clip.
struct ClipReport {
  // Voxels; contains the deformed box at every time (conservative). Of a swept part: at the moments looked
  // at.
  Box bounds;
  float leaves_box = 0;  // how far the deformed box goes beyond the box at rest, in units of size.y
};

// A sheared part: proves that its spline stays monotone at every time of the clip, and bounds the motion
// (interval arithmetic over subdivided time; waves with unrelated periods are assumed to meet in the worst
// way). RigError names the clip, the segment and a time at which it turns back.
// A swept part: looks at many moments of the clip, which is no proof (README.md, "Swept parts"). RigError
// names the clip, the knot and the first of these moments at which it folds.
ClipReport proveClip(const RawClip& clip, std::uint32_t part, const RawRig& rest, const glm::ivec3& size);

}  // namespace kelp
