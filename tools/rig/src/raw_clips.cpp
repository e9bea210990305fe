// SPDX-License-Identifier: MIT
#include "kelp/rig/raw_clips.h"

#include <algorithm>

#include "kelp/rig/rig.h"

namespace kelp {
namespace {

// The length that a clip's content needs: until its last key; without keys, its longest period.
float lengthOf(const RawClip& clip) {
  float last = 0, longest = 0;
  for (const RawTrack& track : clip.tracks) last = std::max(last, track.keys.back().time);
  for (const Wave& wave : clip.waves) longest = std::max(longest, wave.period);
  return last > 0 ? last : longest;
}

}  // namespace

RawRig rawRig(const Part& part) {
  return {
      {part.knots.begin(), part.knots.end()}, part.automatic_tangents, part.parent_at, part.bend, part.roll};
}

std::vector<RawSocket> rawSockets(const Pack& pack) {
  std::vector<RawSocket> sockets;
  for (const Socket& socket : pack.sockets())
    sockets.push_back({std::string(socket.name), socket.part, socket.at, socket.offset, socket.rotation});
  return sockets;
}

std::vector<RawClip> rawClips(const Pack& pack) {
  std::vector<RawClip> clips;
  for (const Clip& clip : pack.clips()) {
    RawClip& raw = clips.emplace_back(
        RawClip{std::string(clip.name), clip.duration, {clip.waves.begin(), clip.waves.end()}, {}});
    for (const Track& track : clip.tracks)
      raw.tracks.push_back({track.part,
                            track.knot,
                            track.target,
                            track.interpolation,
                            {track.keys.begin(), track.keys.end()}});
  }
  return clips;
}

std::vector<std::vector<RawClip>> clipsOfParts(const std::vector<RawClip>& clips, std::size_t parts) {
  std::vector<std::vector<RawClip>> all(parts);
  for (const RawClip& clip : clips) {
    const bool as_long_as_it_asks = clip.duration == lengthOf(clip);
    for (auto& [part, share] : splitByPart(clip)) {
      if (as_long_as_it_asks && lengthOf(share) > 0) share.duration = lengthOf(share);
      all[part].push_back(std::move(share));
    }
  }
  return all;
}

}  // namespace kelp
