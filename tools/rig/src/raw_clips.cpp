// SPDX-License-Identifier: MIT
#include "kelp/rig/raw_clips.h"

namespace kelp {

RestRig restRig(const Part& part) {
  return {
      {{part.knots.begin(), part.knots.end()}, part.automatic_tangents, part.parent_at, part.bend, part.roll},
      !part.cages.empty(),
      part.cages.empty() ? 0 : part.cages[0].side};
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

}  // namespace kelp
