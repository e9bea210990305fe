// SPDX-License-Identifier: MIT
#include "rig_knots.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <string>

#include "waves.h"

namespace kelp::view {
namespace {

// All knot numbers of waves and tracks.
template <class Each>
void forKnots(RigDescription& rig, const Each& each) {
  for (RigDescription::Clip& clip : rig.clips) {
    for (RigDescription::Wave& wave : clip.waves) each(wave.knot);
    for (RigDescription::Track& track : clip.tracks) {
      if (movesKnot(track.target)) each(track.knot);
    }
  }
}

// Says in the clip how the automatic tangent of a knot follows its neighbors, so that it goes on the same
// when the neighbors become others. Keys on the neighbors are left as they are: their tangents go on
// following.
void settleTangent(RigDescription::Clip& clip, const std::vector<Knot>& knots, std::uint64_t automatic,
                   int knot) {
  const auto near = [knot](int other) { return std::abs(other - knot) <= 1; };
  const auto sets = [knot](const auto& motion) {
    return motion.target == Target::kKnotTangent && motion.knot == knot;
  };
  if ((automatic >> knot & 1) == 0 || std::ranges::any_of(clip.waves, sets) ||
      std::ranges::any_of(clip.tracks, [&](const auto& track) {
        return sets(track) || (track.target == Target::kKnotOffset && near(track.knot));
      }))
    return;
  std::vector<RigDescription::Wave> waves, still;
  for (RigDescription::Wave wave : clip.waves) {
    if (!near(wave.knot)) continue;
    const Follow follow = followOf(knots, static_cast<std::size_t>(wave.knot), automatic);
    const float factor = wave.target == Target::kKnotTangent ? 0
                         : wave.knot < knot                  ? follow.after
                         : wave.knot > knot                  ? follow.before
                                                             : follow.self;
    wave.knot = knot;
    wave.target = Target::kKnotTangent;
    wave.amplitude *= factor;
    (factor != 0 ? waves : still).push_back(wave);
  }
  if (waves.empty() && !still.empty())
    waves = {still.front()};  // it stands still, whatever the new knot does
  clip.waves.insert(clip.waves.end(), waves.begin(), waves.end());
}

// The waves of knots `after` and `after` + 1 as they are half way between them, which is where `after` + 1 is
// now: a Hermite curve is linear in its ends.
void shareWaves(RigDescription::Clip& clip, int after, float share) {
  std::map<float, std::pair<Sinusoid, Sinusoid>> middle;  // by period: place, tangent
  for (const RigDescription::Wave& wave : clip.waves) {
    const bool lower = wave.knot == after, upper = wave.knot == after + 2;
    if (!lower && !upper) continue;
    auto& [place, tangent] = middle[wave.period];
    const float side = lower ? 1.0f : -1.0f;
    if (wave.target == Target::kKnotOffset) {
      place.add(0.5f * wave.amplitude, wave.phase);
      tangent.add(-1.5f * side / share * wave.amplitude, wave.phase);
    } else {
      place.add(0.125f * side * share * wave.amplitude, wave.phase);
      tangent.add(-0.25f * wave.amplitude, wave.phase);
    }
  }
  for (const auto& [period, motion] : middle) {
    motion.first.appendTo(clip.waves, after + 1, Target::kKnotOffset, period);
    motion.second.appendTo(clip.waves, after + 1, Target::kKnotTangent, period);
  }
}

}  // namespace

bool movesKnot(Target target) { return target == Target::kKnotOffset || target == Target::kKnotTangent; }

void bendAs(RigDescription& rig, Bend bend, bool caged) {
  rig.bend = bend;
  rig.caged = caged;
  if (!caged) rig.cell = 0;
  if (bend == Bend::kShear) rig.roll = 0;
}

void insertKnot(RigDescription& rig, int after) {
  const auto i = static_cast<std::size_t>(after);
  const std::vector<Knot> knots = realizeKnots(rig);
  const Segment segment = makeSegment(knots[i], knots[i + 1], 1);
  const float at = 0.5f * (knots[i].at + knots[i + 1].at), share = knots[i + 1].at - knots[i].at;
  const glm::mat3 to_artist = glm::inverse(axisRotation(rig.axis.value_or(Axis::kPlusY)));
  RigDescription::Knot knot;
  knot.at = at;
  knot.offset = to_artist * (evaluate(segment, 0.5f) - glm::vec3(0, at, 0));
  const glm::vec3 tangent = to_artist * (derivative(segment, 0.5f) / share);
  for (int axis = 0; axis < 3; ++axis) {  // what rounding leaves of a straight rig
    if (std::abs(knot.offset[axis]) < 1e-6f) knot.offset[axis] = 0;
  }
  // Tangents that were automatic would now look at the new knot; they are, and stay, what they were, unless
  // that is the same.
  RigDescription made = rig;
  for (RigDescription::Clip& clip : made.clips) {
    const std::uint64_t automatic_before = automaticTangents(rig);
    settleTangent(clip, knots, automatic_before, after);
    settleTangent(clip, knots, automatic_before, after + 1);
  }
  made.knots.insert(made.knots.begin() + after + 1, knot);
  const std::vector<Knot> automatic = realizeKnots(made);
  const auto keep = [&](std::size_t index, const glm::vec3& wanted) {
    if (made.knots[index].tangent) return;
    const glm::vec3 is = to_artist * automatic[index].tangent;
    if (glm::any(glm::greaterThan(glm::abs(is - wanted), glm::vec3(1e-5f))))
      made.knots[index].tangent = wanted;
  };
  keep(i, to_artist * knots[i].tangent);
  keep(i + 1, tangent);
  keep(i + 2, to_artist * knots[i + 1].tangent);
  forKnots(made, [&](int& index) { index += index > after ? 1 : 0; });
  for (RigDescription::Clip& clip : made.clips) shareWaves(clip, after, share);
  rig = std::move(made);
}

void removeKnot(RigDescription& rig, int knot) {
  rig.knots.erase(rig.knots.begin() + knot);
  for (RigDescription::Clip& clip : rig.clips) {
    std::erase_if(clip.waves, [&](const auto& wave) { return wave.knot == knot; });
    std::erase_if(clip.tracks,
                  [&](const auto& track) { return movesKnot(track.target) && track.knot == knot; });
  }
  std::erase_if(rig.clips, [](const auto& clip) { return clip.waves.empty() && clip.tracks.empty(); });
  forKnots(rig, [&](int& index) { index -= index > knot ? 1 : 0; });
}

RigDescription::Socket newSocket(const RigDescription& rig) {
  RigDescription::Socket socket;
  socket.at = 1;
  const auto taken = [&] {
    return std::any_of(rig.sockets.begin(), rig.sockets.end(),
                       [&](const RigDescription::Socket& other) { return other.name == socket.name; });
  };
  socket.name = "socket";
  for (int number = 2; taken(); ++number) socket.name = "socket." + std::to_string(number);
  return socket;
}

glm::vec3 acrossAxis(const RigDescription& rig, const glm::vec3& offset) {
  const glm::vec3 axis = glm::transpose(axisRotation(rig.axis.value_or(Axis::kPlusY))) * glm::vec3(0, 1, 0);
  return offset - glm::dot(offset, axis) * axis;
}

RigDescription::Clip swayOf(const RigDescription& rig, const std::string& name) {
  const RigDescription preset = presetRig("sway", rig.axis.value_or(Axis::kPlusY)).value();
  RigDescription::Clip clip{name, preset.clips[0].duration, {}, {}};
  const auto& waves = preset.clips[0].waves;
  const auto isOfFoot = [](const RigDescription::Wave& wave) { return wave.knot == 0; };
  for (std::size_t knot = 1; knot < rig.knots.size(); ++knot) {
    const float at = rig.knots[knot].at;
    // of a tip at 1: a at^2 has the slope 2 a at
    for (RigDescription::Wave wave : waves) {
      if (isOfFoot(wave)) continue;
      wave.knot = static_cast<int>(knot);
      wave.amplitude *= wave.target == Target::kKnotOffset ? at * at : at;
      clip.waves.push_back(wave);
    }
  }
  std::ranges::copy_if(waves, std::back_inserter(clip.waves), isOfFoot);
  return clip;
}

}  // namespace kelp::view
