// SPDX-License-Identifier: MIT
#include "raw_clips.h"

#include <algorithm>

namespace kelp::dump {
namespace {

// Of a clip that says nothing else: until its last key; without keys, its longest period.
float lengthOf(const RawClip& clip) {
  float last = 0, longest = 0;
  for (const RawTrack& track : clip.tracks) last = std::max(last, track.keys.back().time);
  for (const Wave& wave : clip.waves) longest = std::max(longest, wave.period);
  return last > 0 ? last : longest;
}

}  // namespace

std::vector<RawClip> rawClips(const Pack& pack) {
  std::vector<RawClip> clips;
  for (const Clip& clip : pack.clips()) {
    RawClip& raw = clips.emplace_back(RawClip{std::string(clip.name), clip.duration, {clip.waves.begin(), clip.waves.end()}, {}});
    for (const Track& track : clip.tracks)
      raw.tracks.push_back({track.part, track.knot, track.target, track.interpolation, {track.keys.begin(), track.keys.end()}});
  }
  return clips;
}

std::vector<RawClip> clipsOfPart(const std::vector<RawClip>& clips, std::uint32_t part) {
  std::vector<RawClip> shares;
  for (const RawClip& clip : clips) {
    RawClip share{clip.name, clip.duration, {}, {}};
    std::copy_if(clip.waves.begin(), clip.waves.end(), std::back_inserter(share.waves), [&](const Wave& wave) { return wave.part == part; });
    std::copy_if(clip.tracks.begin(), clip.tracks.end(), std::back_inserter(share.tracks), [&](const RawTrack& track) { return track.part == part; });
    if (share.waves.empty() && share.tracks.empty()) continue;
    if (clip.duration == lengthOf(clip) && lengthOf(share) > 0) share.duration = lengthOf(share);
    shares.push_back(std::move(share));
  }
  return shares;
}

}  // namespace kelp::dump
