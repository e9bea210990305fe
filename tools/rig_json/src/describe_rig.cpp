// SPDX-License-Identifier: MIT
// Voxels of a part -> the artist's units, the inverse of realize_rig.cpp for axis +y.
#include "kelp/rig_json/rig_json.h"
#include "words.h"

namespace kelp {

RigDescription describeRig(std::span<const Knot> knots, std::span<const RawClip> clips, std::uint32_t part, const glm::ivec3& size) {
  const auto length = static_cast<float>(size.y);
  RigDescription rig;
  rig.axis = Axis::kPlusY;
  for (const Knot& knot : knots)
    rig.knots.push_back({knot.at, (knot.position - glm::vec3(0, knot.at * length, 0)) / length, knot.tangent / length});

  for (const RawClip& clip : clips) {
    RigDescription::Clip described{clip.name, clip.duration, {}, {}};
    for (const Wave& wave : clip.waves) {
      if (wave.part == part)
        described.waves.push_back({static_cast<int>(wave.knot), wave.target, wave.amplitude / length, wave.period, wave.phase});
    }
    for (const RawTrack& track : clip.tracks) {
      if (track.part != part) continue;
      const float unit = rig::movesKnot(track.target) ? length : 1.0f;
      RigDescription::Track& target = described.tracks.emplace_back();
      target.knot = rig::movesKnot(track.target) ? static_cast<int>(track.knot) : 0;
      target.target = track.target;
      target.interpolation = track.interpolation;
      for (const Key& key : track.keys) {
        RigDescription::Key& out = target.keys.emplace_back();
        out.time = key.time;
        out.value = key.value / unit;
        if (track.interpolation == Interpolation::kCubic) {
          out.in = key.in / unit;
          out.out = key.out / unit;
        }
      }
    }
    if (!described.waves.empty() || !described.tracks.empty()) rig.clips.push_back(std::move(described));
  }
  return rig;
}

}  // namespace kelp
