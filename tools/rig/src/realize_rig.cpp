// SPDX-License-Identifier: MIT
// The artist's axes -> those of a part, whose axis is +y. Lengths are the same: 1 is the part's height.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <string>
#include <unordered_map>

#include "kelp/rig/rig.h"
#include "words.h"

namespace kelp {
namespace {

std::vector<RigDescription::Knot> knotsOf(const RigDescription& rig) {
  if (!rig.knots.empty()) return rig.knots;
  return {{0, glm::vec3(0), std::nullopt}, {1, glm::vec3(0), std::nullopt}};
}

// Catmull-Rom: the slope between the neighbors, one-sided at the ends.
template <class V, class At, class Value>
V automaticSlope(std::size_t i, std::size_t count, const At& at, const Value& value) {
  if (count < 2) return V(0);
  const std::size_t before = i > 0 ? i - 1 : 0, after = i + 1 < count ? i + 1 : i;
  return (value(after) - value(before)) / (at(after) - at(before));
}

// As it is, unless its length is wrong by more than a pack may hold (SPEC.md 4.5). Rounded rotations are not
// quite unit, and take fewer bytes.
glm::vec4 unitRotation(const glm::vec4& q) {
  return std::abs(glm::dot(q, q) - 1) > 1.9e-3f ? glm::normalize(q) : q;
}

std::vector<Key> realizeKeys(const RigDescription::Track& track, const glm::mat3& to_part) {
  const std::size_t count = track.keys.size();
  std::vector<Key> keys(count);
  const auto map = [&](const glm::vec4& v) {
    return rig::movesKnot(track.target) ? glm::vec4(to_part * glm::vec3(v), 0.0f) : v;
  };
  std::vector<float> signs(count, 1.0f);
  for (std::size_t i = 0; i < count; ++i) {
    glm::vec4 value = map(track.keys[i].value);
    if (track.target == Target::kPartRotation) {
      // q and -q are the same rotation: each key takes the one nearer to its neighbor, so that cubic keys do
      // not pass through zero.
      value = unitRotation(value);
      if (i > 0 && glm::dot(value, keys[i - 1].value) < 0) signs[i] = -1.0f;
      value *= signs[i];
    }
    keys[i].time = track.keys[i].time;
    keys[i].value = value;
  }
  if (track.interpolation != Interpolation::kCubic) return keys;
  for (std::size_t i = 0; i < count; ++i) {
    const auto& source = track.keys[i];
    const glm::vec4 automatic = automaticSlope<glm::vec4>(
        i, count, [&](std::size_t k) { return keys[k].time; }, [&](std::size_t k) { return keys[k].value; });
    keys[i].in = source.in ? map(*source.in) * signs[i] : automatic;
    keys[i].out = source.out ? map(*source.out) * signs[i] : automatic;
  }
  return keys;
}

float durationOf(const RigDescription::Clip& clip) {
  if (clip.duration) return *clip.duration;
  float last_key = 0, longest = 0;
  for (const auto& track : clip.tracks) {
    if (!track.keys.empty()) last_key = std::max(last_key, track.keys.back().time);
  }
  for (const auto& wave : clip.waves) longest = std::max(longest, wave.period);
  return last_key > 0 ? last_key : longest;
}

}  // namespace

void normalizeRotations(std::vector<RigDescription::Track>& tracks) {
  for (RigDescription::Track& track : tracks)
    if (track.target == Target::kPartRotation)
      for (RigDescription::Key& key : track.keys) key.value = glm::normalize(key.value);
}

std::vector<Knot> realizeKnots(const RigDescription& rig) {
  const glm::mat3 to_part = axisRotation(rig.axis.value_or(Axis::kPlusY));
  const auto described = knotsOf(rig);
  std::vector<Knot> knots;
  for (std::size_t i = 0; i < described.size(); ++i) {
    const auto& knot = described[i];
    // The automatic tangent is the slope of the offsets plus the straight tangent, so that a straight rig is
    // exactly straight.
    const glm::vec3 tangent =
        knot.tangent ? to_part * *knot.tangent
                     : glm::vec3(0, 1, 0) + to_part * automaticSlope<glm::vec3>(
                                                          i, described.size(),
                                                          [&](std::size_t k) { return described[k].at; },
                                                          [&](std::size_t k) { return described[k].offset; });
    knots.push_back({knot.at, glm::vec3(0, knot.at, 0) + to_part * knot.offset, tangent});
  }
  return knots;
}

std::uint64_t automaticTangents(const RigDescription& rig) {
  const auto described = knotsOf(rig);
  std::uint64_t automatic = 0;
  for (std::size_t i = 0; i < described.size(); ++i)
    if (!described[i].tangent) automatic |= std::uint64_t{1} << i;
  return automatic;
}

std::vector<RawClip> realizeClips(const RigDescription& rig, std::uint32_t part) {
  const glm::mat3 to_part = axisRotation(rig.axis.value_or(Axis::kPlusY));
  std::vector<RawClip> clips;
  for (const auto& described : rig.clips) {
    RawClip& clip = clips.emplace_back();
    clip.name = described.name;
    clip.duration = durationOf(described);
    for (const auto& wave : described.waves)
      if (!wave.of_section)
        clip.waves.push_back({part, static_cast<std::uint32_t>(wave.knot), wave.target,
                              to_part * wave.amplitude, wave.period, wave.phase});
    for (const auto& track : described.tracks)
      if (!track.of_section)
        clip.tracks.push_back({part, static_cast<std::uint32_t>(track.knot), track.target,
                               track.interpolation, realizeKeys(track, to_part)});
  }
  return clips;
}

void mergeClips(std::vector<RawClip>& into, std::vector<RawClip> clips) {
  std::unordered_map<std::string, std::size_t> index;
  for (std::size_t i = 0; i < into.size(); ++i) index.try_emplace(into[i].name, i);
  for (RawClip& clip : clips) {
    const auto [at, fresh] = index.try_emplace(clip.name, into.size());
    if (fresh) {
      into.push_back(std::move(clip));
      continue;
    }
    RawClip* const same = &into[at->second];
    // The duration says when tracks repeat; waves do not need it. So the clip with tracks decides, or the
    // longer one if both have tracks.
    if (same->tracks.empty() == clip.tracks.empty())
      same->duration = std::max(same->duration, clip.duration);
    else if (same->tracks.empty())
      same->duration = clip.duration;
    same->waves.insert(same->waves.end(), clip.waves.begin(), clip.waves.end());
    std::move(clip.tracks.begin(), clip.tracks.end(), std::back_inserter(same->tracks));
  }
}

std::vector<std::pair<std::uint32_t, RawClip>> splitByPart(const RawClip& clip) {
  std::map<std::uint32_t, RawClip> shares;
  const auto shareOf = [&](std::uint32_t part) -> RawClip& {
    return shares.try_emplace(part, RawClip{clip.name, clip.duration, {}, {}}).first->second;
  };
  for (const Wave& wave : clip.waves) shareOf(wave.part).waves.push_back(wave);
  for (const RawTrack& track : clip.tracks) shareOf(track.part).tracks.push_back(track);
  return {std::make_move_iterator(shares.begin()), std::make_move_iterator(shares.end())};
}

}  // namespace kelp
