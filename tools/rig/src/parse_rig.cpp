// SPDX-License-Identifier: MIT
// JSON -> RigDescription: knots and clips; sockets in sockets.cpp.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "json_place.h"
#include "kelp/rig/rig.h"
#include "words.h"

namespace kelp {
namespace {

using namespace rig;

// "parts" is read in parse_rig_file.cpp.
constexpr std::array<std::string_view, 11> kRigKeys{"kelp", "axis", "knots", "clips", "sockets", "parent_at",
                                                    "bend", "cell", "roll",  "sides", "parts"};
constexpr int kLanguageVersion = 1;
constexpr double kShortestPeriod = 1e-3;  // seconds

int readKnotIndex(const Place& place, std::size_t knots) {
  const double value = readNumber(place);
  if (value != std::floor(value) || value < 0 || value >= static_cast<double>(knots))
    fail(place, "there is no knot " + printable(value) + "; this rig has knots 0 to " +
                    std::to_string(knots - 1) + ": correct the number or add knots under \"knots\"");
  return static_cast<int>(value);
}

// The one of `targets` that `place` names.
MovedThing readTarget(const Place& place, std::span<const MovedThing> targets) {
  std::string words;
  std::vector<MovedThing> named;
  for (const MovedThing& target : targets) {
    words += (words.empty()                ? "'"
              : &target == &targets.back() ? " or '"
                                           : ", '") +
             std::string(rig::wordOf(target)) + "'";
    if (place.has(rig::wordOf(target))) named.push_back(target);
  }
  if (named.size() == 1) return named[0];
  if (named.empty()) fail(place, "does not say what moves; give exactly one of " + words);
  fail(place, std::string("has both '") + rig::wordOf(named[0]) + "' and '" + rig::wordOf(named[1]) +
                  "'; exactly one of " + words + " is allowed: write two entries");
}

// One factor for both axes across, or one for each; less `rest`.
glm::vec2 readWidth(const Place& place, double rest = 0, double least = -kLargest) {
  const auto read = [&](const Place& one) { return static_cast<float>(readNumber(one, least) - rest); };
  if (!place.json.is_array()) return glm::vec2(read(place));
  if (place.json.size() != 2) fail(place, "must be a number, or two: one for each axis across the rig's");
  return {read(place.at(0)), read(place.at(1))};
}
float readTwist(const Place& place) { return static_cast<float>(glm::radians(readNumber(place))); }

RigDescription::Section readSection(const Place& knot) {
  constexpr double kNarrowest = 1e-3;
  RigDescription::Section section;
  if (knot.has("width")) section.width = readWidth(knot.at("width"), 0, kNarrowest);
  if (knot.has("twist")) section.twist = readTwist(knot.at("twist"));
  if (knot.has("keep_volume")) {
    const Place keep = knot.at("keep_volume");
    section.keep_volume =
        keep.json.is_boolean() ? (keep.json.get<bool>() ? 1.0f : 0.0f) : readFloat(keep, 0, 1);
  }
  return section;
}

std::vector<RigDescription::Knot> readKnots(const Place& place) {
  static constexpr std::array<std::string_view, 6> kKeys{"at",    "offset", "tangent",
                                                         "width", "twist",  "keep_volume"};
  requireArray(place);
  const std::size_t count = place.json.size();
  if (count < 2 || count > static_cast<std::size_t>(kMaxKnots))
    fail(place, "has " + std::to_string(count) + (count == 1 ? " knot" : " knots") + "; a rig has 2 to " +
                    std::to_string(kMaxKnots) + " (leave the key out for two, at 0 and 1)");
  std::vector<RigDescription::Knot> knots;
  for (std::size_t i = 0; i < count; ++i) {
    const Place entry = place.at(i);
    requireObject(entry, kKeys);
    const Place at = required(entry, "at", "say where along the axis the knot belongs, 0 to 1");
    RigDescription::Knot& knot = knots.emplace_back();
    knot.at = readFloat(at, 0, 1);
    if (i == 0 && knot.at != 0) fail(at, "the first knot must be at 0, not at " + printable(knot.at));
    if (i > 0 && !(knot.at > knots[i - 1].at))
      fail(at, "knots must ascend: " + printable(knot.at) + " follows " + printable(knots[i - 1].at) +
                   "; sort them, and let no two coincide");
    if (i + 1 == count && knot.at != 1) fail(at, "the last knot must be at 1, not at " + printable(knot.at));
    if (entry.has("offset")) knot.offset = readVec3(entry.at("offset"));
    if (entry.has("tangent")) knot.tangent = readVec3(entry.at("tangent"));
    knot.section = readSection(entry);
  }
  return knots;
}

RigDescription::Wave readWave(const Place& place, std::size_t knots) {
  static constexpr std::array<std::string_view, 7> kKeys{"knot",  "offset", "tangent", "width",
                                                         "twist", "period", "phase"};
  requireObject(place, kKeys);
  RigDescription::Wave wave;
  wave.knot = readKnotIndex(required(place, "knot", "say which knot the wave moves"), knots);
  const MovedThing moved = readTarget(place, std::span(kMovedThings).first(4));
  const Place amplitude = place.at(std::string(rig::wordOf(moved)));
  wave.target = moved.target;
  wave.of_section = moved.of_section;
  wave.amplitude = moved == kTwist   ? glm::vec3(readTwist(amplitude), 0, 0)
                   : moved == kWidth ? glm::vec3(readWidth(amplitude), 0)
                                     : readVec3(amplitude);
  wave.period =
      readFloat(required(place, "period", "say how many seconds one swing takes"), kShortestPeriod, kLargest);
  if (place.has("phase")) wave.phase = readFloat(place.at("phase"));
  return wave;
}

// A key's value, or a slope of the same kind. `slope`: no unit length, no rest value.
glm::vec4 readKeyValue(const Place& place, const MovedThing& moved, bool slope) {
  if (moved == kTwist) return {readTwist(place), 0, 0, 0};
  if (moved == kWidth) return glm::vec4(readWidth(place, slope ? 0 : 1), 0, 0);
  const Target target = moved.target;
  if (target == Target::kPartRotation) {
    if (!slope) return readRotation(place);
    const auto q = readVector<4>(place);
    return {q[0], q[1], q[2], q[3]};
  }
  const auto v = readVector<3>(place);
  const double rest = target == Target::kPartScale && !slope ? 1 : 0;
  return {v[0] - rest, v[1] - rest, v[2] - rest, 0};
}

Interpolation readInterpolation(const Place& place) {
  static constexpr std::array<std::string_view, 3> kWords{"step", "linear", "cubic"};
  if (!place.json.is_string())
    fail(place, std::string("must be \"step\", \"linear\" or \"cubic\", not ") + kindOf(place.json));
  const auto& word = place.json.get_ref<const std::string&>();
  if (const auto found = rig::interpolationOf(word)) return *found;
  fail(place, "unknown interpolation '" + printable(word) + "'; " + suggestion(word, kWords));
}

// All keys are in one list. Keys that move the same thing form a track; tracks are ordered by their first
// key.
std::vector<RigDescription::Track> readKeys(const Place& place, std::size_t knots, Interpolation by_default) {
  static constexpr std::array<std::string_view, 12> kKeys{"time",  "knot",          "offset",      "tangent",
                                                          "width", "twist",         "translation", "rotation",
                                                          "scale", "interpolation", "in",          "out"};
  struct Origin {
    bool stated = false;                       // a key of the track states the interpolation
    std::optional<std::string> slope_pointer;  // first explicit slope
  };
  std::vector<RigDescription::Track> tracks;
  std::vector<Origin> origins;
  std::array<std::array<int, kMaxKnots>, kMovedThings.size()> track_of{};  // index + 1, by thing and knot

  requireArray(place);
  for (std::size_t i = 0; i < place.json.size(); ++i) {
    const Place entry = place.at(i);
    requireObject(entry, kKeys);
    const MovedThing moved = readTarget(entry, kMovedThings);
    int knot = 0;
    if (rig::movesKnot(moved.target)) {
      knot = readKnotIndex(required(entry, "knot", "say which knot the key moves"), knots);
    } else if (entry.has("knot")) {
      fail(entry.at("knot"),
           std::string("'") + rig::wordOf(moved) + "' moves the whole part, not a knot; remove this key");
    }
    const auto thing = std::find(kMovedThings.begin(), kMovedThings.end(), moved) - kMovedThings.begin();
    int& slot = track_of[static_cast<std::size_t>(thing)][static_cast<std::size_t>(knot)];
    if (slot == 0) {
      tracks.push_back({knot, moved.target, by_default, {}, moved.of_section});
      origins.emplace_back();
      slot = static_cast<int>(tracks.size());
    }
    RigDescription::Track& track = tracks[static_cast<std::size_t>(slot) - 1];
    Origin& origin = origins[static_cast<std::size_t>(slot) - 1];

    RigDescription::Key key;
    const Place time = required(entry, "time", "say at how many seconds the value holds");
    key.time = readFloat(time, 0, kLargest);
    if (!track.keys.empty() && !(key.time > track.keys.back().time))
      fail(time, "keys of one thing must ascend in time: " + printable(key.time) + " follows " +
                     printable(track.keys.back().time) + "; sort them, and let no two coincide");
    key.value = readKeyValue(entry.at(std::string(rig::wordOf(moved))), moved, false);
    if (entry.has("interpolation")) {
      const Interpolation stated = readInterpolation(entry.at("interpolation"));
      if (origin.stated && stated != track.interpolation)
        fail(entry.at("interpolation"), std::string("an earlier key of the same thing says '") +
                                            rig::wordOf(track.interpolation) +
                                            "'; all keys of one thing share one interpolation");
      track.interpolation = stated;
      origin.stated = true;
    }
    if (entry.has("in")) key.in = readKeyValue(entry.at("in"), moved, true);
    if (entry.has("out")) key.out = readKeyValue(entry.at("out"), moved, true);
    if ((key.in || key.out) && !origin.slope_pointer)
      origin.slope_pointer = entry.pointer + (key.in ? "/in" : "/out");
    track.keys.push_back(key);
  }
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (origins[i].slope_pointer && tracks[i].interpolation != Interpolation::kCubic)
      throw RigError(*origins[i].slope_pointer + ": slopes belong to cubic keys, these are " +
                     rig::wordOf(tracks[i].interpolation) +
                     "; add \"interpolation\": \"cubic\" or remove the slope");
  }
  return tracks;
}

RigDescription::Clip readClip(const Place& place, const std::string& name, std::size_t knots) {
  static constexpr std::array<std::string_view, 4> kKeys{"duration", "interpolation", "waves", "keys"};
  requireObject(place, kKeys);
  checkName(place, "clip", name);
  RigDescription::Clip clip;
  clip.name = name;
  if (place.has("duration")) clip.duration = readFloat(place.at("duration"), kShortestPeriod, kLargest);
  Interpolation interpolation = Interpolation::kLinear;
  if (place.has("interpolation")) {
    interpolation = readInterpolation(place.at("interpolation"));
    if (!place.has("keys"))
      fail(place.at("interpolation"), "only keys are interpolated and this clip has none; remove it");
  }
  if (place.has("waves")) {
    const Place waves = place.at("waves");
    requireArray(waves);
    for (std::size_t i = 0; i < waves.json.size(); ++i) clip.waves.push_back(readWave(waves.at(i), knots));
  }
  if (place.has("keys")) clip.tracks = readKeys(place.at("keys"), knots, interpolation);
  if (clip.waves.empty() && clip.tracks.empty())
    fail(place, "the clip moves nothing; give it \"waves\" or \"keys\", or remove it");

  float last = 0;
  for (const auto& track : clip.tracks) last = std::max(last, track.keys.back().time);
  if (clip.duration && last > *clip.duration)
    fail(place.at("duration"), "the clip ends at " + printable(*clip.duration) +
                                   " s, before its last key at " + printable(last) + " s; make it longer");
  if (!clip.duration && last < kShortestPeriod && clip.waves.empty())
    fail(place, "all keys are at time 0, so the clip has no length; add \"duration\"");
  return clip;
}

std::vector<RigDescription::Clip> readClips(const Place& place, std::size_t knots) {
  if (!place.json.is_object())
    fail(place, std::string("must be an object that maps names to clips, not ") + kindOf(place.json));
  std::vector<RigDescription::Clip> clips;
  for (const auto& member : place.json.items())
    clips.push_back(readClip(place.at(member.key()), member.key(), knots));
  return clips;
}

void readKnotsAndClips(const Place& place, std::vector<RigDescription::Knot>& knots,
                       std::vector<RigDescription::Clip>& clips) {
  if (place.has("knots")) knots = readKnots(place.at("knots"));
  if (place.has("clips")) clips = readClips(place.at("clips"), knots.empty() ? 2 : knots.size());
}

// Which of the corners are across the rig's axis is known where that is: sideRigs().
std::vector<RigDescription::Side> readSides(const Place& place) {
  static constexpr std::array<std::string_view, 12> kCorners{"-x-y", "+x-y", "-x+y", "+x+y", "-x-z", "+x-z",
                                                             "-x+z", "+x+z", "-y-z", "+y-z", "-y+z", "+y+z"};
  requireObject(place, kCorners);
  if (place.json.empty()) fail(place, "names no corner; give one a rig, or take \"sides\" out");
  std::vector<RigDescription::Side> sides;
  for (const auto& member : place.json.items()) {
    const Place entry = place.at(member.key());
    RigDescription::Side& side = sides.emplace_back();
    side.corner = member.key();
    requireObject(entry, kRigKeys);
    for (const auto& its : entry.json.items())
      if (its.key() != "knots" && its.key() != "clips")
        fail(entry.at(its.key()),
             "a side has \"knots\" and \"clips\" alone; write it into the part's own rig");
    readKnotsAndClips(entry, side.knots, side.clips);
    RigDescription its;
    its.knots = side.knots;
    its.clips = side.clips;
    if (hasSections(its))
      fail(entry, "a side is a line, and has no sections; take \"width\", \"twist\" and \"keep_volume\" out");
    for (const RigDescription::Clip& clip : side.clips)
      for (const RigDescription::Track& track : clip.tracks)
        if (!rig::movesKnot(track.target))
          fail(entry.at("clips").at(clip.name).at("keys"),
               std::string("a clip of a side moves knots alone, and '") + rig::wordOf(track.target) +
                   "' the whole part; write the key into a clip of the part's own rig");
  }
  return sides;
}

void readBend(const Place& place, RigDescription& rig) {
  if (place.has("bend")) {
    const Place bend = place.at("bend");
    rig.caged = bend.json == toString(Bend::kSweep, true);
    if (rig.caged)
      rig.bend = Bend::kSweep;
    else if (bend.json.is_string())
      rig.bend = parseBend(bend.json.get_ref<const std::string&>());
    if (!rig.bend)
      fail(bend, "must be \"sweep\", \"shear\" or \"cage\", not " +
                     printable(bend.json.dump(-1, ' ', false, Json::error_handler_t::replace)));
    if (!rig.sides.empty() && !rig.caged)
      fail(bend, "a part with sides bends by its cage; write \"cage\", or take \"bend\" out");
  }
  if (!rig.sides.empty()) {
    rig.caged = true;
    rig.bend = Bend::kShear;
  }
  if (place.has("cell")) {
    const Place cell = place.at("cell");
    const double side = readNumber(cell);
    if (side != 2 && side != 4 && side != 8 && side != 16)
      fail(cell, "must be 2, 4, 8 or 16, not " + printable(side));
    if (!rig.caged) fail(cell, "only a cage has cells; write \"bend\": \"cage\", or take \"cell\" out");
    rig.cell = static_cast<int>(side);
  }
  if (!place.has("roll")) return;
  const Place roll = place.at("roll");
  const double degrees = readNumber(roll, -180, 180);
  if (!rig.sides.empty()) fail(roll, "a part with sides does not turn about its spline; take \"roll\" out");
  if (rig.bend != Bend::kSweep)
    fail(roll, "only a swept part turns about its spline; write \"bend\": \"sweep\", or take \"roll\" out");
  rig.roll = rollOfDegrees(degrees);
}

}  // namespace

namespace rig {

void requireVersion(const Place& place) {
  const Place version =
      required(place, "kelp", "a rig begins with \"kelp\": 1, the version of the rig language");
  if (!version.json.is_number() || version.json.get<double>() != kLanguageVersion)
    fail(version, "this tool reads version " + std::to_string(kLanguageVersion) +
                      " of the rig language; write \"kelp\": 1, or update kelp if the rig is newer");
}

void refuseSkin(const Place& place) {
  if (place.has("skin"))
    fail(
        place.at("skin"),
        "a skin is not divided any more: its joints are parts, and one cage follows them. Take \"skin\" out; "
        "to move a joint otherwise, give it a rig by its name under \"parts\"");
}

RigDescription readRig(const Place& place, RigPlace stands) {
  refuseSkin(place);
  requireObject(place, std::span(kRigKeys).first(kRigKeys.size() - (stands == RigPlace::kFile ? 0 : 1)));
  if (stands != RigPlace::kPart || place.has("kelp")) requireVersion(place);
  RigDescription rig;
  if (place.has("axis")) {
    const Place axis = place.at("axis");
    if (axis.json.is_string()) rig.axis = parseAxis(axis.json.get_ref<const std::string&>());
    if (!rig.axis)
      fail(axis, "must be one of \"+x\", \"-x\", \"+y\", \"-y\", \"+z\", \"-z\", not " +
                     printable(axis.json.dump(-1, ' ', false, Json::error_handler_t::replace)));
  }
  readKnotsAndClips(place, rig.knots, rig.clips);
  if (place.has("sockets")) readSockets(place.at("sockets"), rig);
  if (place.has("parent_at")) {
    const Place parent_at = place.at("parent_at");
    rig.parent_at = readFloat(parent_at);
    if (!(rig.parent_at >= 0 && rig.parent_at <= 1) && rig.parent_at != Part::kNotOnSpline)
      fail(parent_at, printable(rig.parent_at) +
                          " is no place on the parent's spline; it must lie between 0 and 1 (-1 is the same "
                          "as leaving it out)");
  }
  if (place.has("sides")) rig.sides = readSides(place.at("sides"));
  if (!rig.sides.empty() && hasSections(rig))
    fail(place.at("sides"),
         "sides and sections exclude each other; take \"sides\" out, or \"width\", \"twist\" and "
         "\"keep_volume\"");
  readBend(place, rig);
  return rig;
}

}  // namespace rig

RigDescription parseRig(std::string_view text) {
  const Json json = parseJson(text);
  return readRig({json, ""}, RigPlace::kNode);
}

}  // namespace kelp
