// SPDX-License-Identifier: MIT
// Sides: the corners of a section, and the parts that the nodes of a cage follow.
#include <algorithm>
#include <cmath>

#include "clip_motion.h"
#include "kelp/formats/spline.h"
#include "words.h"

namespace kelp {
namespace {

constexpr int kMoments = 64, kHeights = 32;  // at which sections are looked at
constexpr double kFlat = 1e-6;               // of the section at rest: turned around by less is none

using Knots = std::vector<Knot>;

RigDescription sideRig(Axis axis, const std::vector<RigDescription::Knot>& knots,
                       const std::vector<RigDescription::Clip>& clips) {
  RigDescription rig;
  rig.axis = axis;
  rig.knots = knots;
  rig.clips = clips;
  rig.bend = Bend::kShear;
  return rig;
}

glm::dvec3 placeAt(const Knots& knots, float at, const glm::ivec3& size, int corner) {
  std::size_t next = 1;
  while (next + 1 < knots.size() && knots[next].at < at) ++next;
  const Knot &k0 = knots[next - 1], &k1 = knots[next];
  const glm::vec3 place =
      evaluate(makeSegment(k0, k1, static_cast<float>(size.y)), (at - k0.at) / (k1.at - k0.at));
  return glm::dvec3(place) + glm::dvec3(corner & 1 ? size.x : 0, 0, corner & 2 ? size.z : 0);
}

// True if the four places are not in the order of the corners any more, seen along the axis.
bool turnedAround(const std::array<glm::dvec3, 4>& places, const glm::ivec3& size) {
  constexpr std::array<std::size_t, 4> kRing{0, 1, 3, 2};
  for (std::size_t i = 0; i < 4; ++i) {
    const glm::dvec3 here = places[kRing[i]], on = places[kRing[(i + 1) % 4]] - here,
                     back = places[kRing[(i + 3) % 4]] - here;
    if (on.x * back.z - on.z * back.x < -kFlat * size.x * size.z) return true;
  }
  return false;
}

}  // namespace

std::string cornerName(int corner, Axis axis) {
  const glm::vec3 towards =
      glm::transpose(axisRotation(axis)) * glm::vec3(corner & 1 ? 1 : -1, 0, corner & 2 ? 1 : -1);
  std::string name;
  for (int i = 0; i < 3; ++i)
    if (towards[i] != 0) name += {towards[i] > 0 ? '+' : '-', static_cast<char>('x' + i)};
  return name;
}

RigDescription ownSide(const RigDescription& rig) {
  RigDescription own = sideRig(rig.axis.value_or(Axis::kPlusY), rig.knots, {});
  for (RigDescription::Clip clip : rig.clips) {
    std::erase_if(clip.tracks, [](const auto& track) { return !rig::movesKnot(track.target); });
    if (!clip.waves.empty() || !clip.tracks.empty()) own.clips.push_back(std::move(clip));
  }
  return own;
}

SideRigs sideRigs(const RigDescription& rig) {
  const Axis axis = rig.axis.value_or(Axis::kPlusY);
  SideRigs out;
  std::string names;
  for (int corner = 0; corner < 4; ++corner) {
    const std::string name = cornerName(corner, axis);
    names += (corner > 0 ? ", " : "") + name;
    const auto side = std::find_if(rig.sides.begin(), rig.sides.end(),
                                   [&](const RigDescription::Side& its) { return its.corner == name; });
    if (side == rig.sides.end()) continue;
    out.followed[corner] = static_cast<int>(out.parts.size());
    out.parts.emplace_back(name, sideRig(axis, side->knots, side->clips));
  }
  if (out.parts.size() != rig.sides.size())
    for (const RigDescription::Side& side : rig.sides)
      if (names.find(side.corner) == std::string::npos)
        throw RigError("/sides/" + rig::printable(side.corner) + ": is no corner across the axis " +
                       toString(axis) + "; these are " + names);
  if (out.parts.size() == 4) return out;
  std::replace(std::begin(out.followed), std::end(out.followed), -1, static_cast<int>(out.parts.size()));
  out.parts.emplace_back(kOwnSide, ownSide(rig));
  return out;
}

std::string sidesCross(const std::array<std::uint32_t, 4>& parts, const std::array<RawRig, 4>& rests,
                       const RawClip* clip, const glm::ivec3& size) {
  std::vector<rig::MovedKnots> moved;
  double period = 0;
  if (clip) {
    period = static_cast<double>(clip->duration);
    for (const Wave& wave : clip->waves) period = std::max(period, static_cast<double>(wave.period));
    for (std::size_t i = 0; i < 4; ++i) moved.emplace_back(*clip, parts[i], rests[i]);
  }
  for (int moment = 0; moment < (clip ? kMoments : 1); ++moment) {
    const double time = period * moment / kMoments;
    std::array<Knots, 4> knots;
    for (std::size_t i = 0; i < 4; ++i) knots[i] = clip ? moved[i].at(time) : rests[i].knots;
    for (int height = 0; height <= kHeights; ++height) {
      const float at = static_cast<float>(height) / kHeights;
      std::array<glm::dvec3, 4> places;
      for (std::size_t i = 0; i < 4; ++i) places[i] = placeAt(knots[i], at, size, static_cast<int>(i));
      if (!turnedAround(places, size)) continue;
      return (clip ? "in clip '" + rig::printable(clip->name) + "' at " + rig::printable(time) + " s"
                   : std::string("at rest")) +
             ", at " + rig::printable(static_cast<double>(at)) + " of its height";
    }
  }
  return {};
}

}  // namespace kelp
