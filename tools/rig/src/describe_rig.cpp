// SPDX-License-Identifier: MIT
// Voxels of a part -> the artist's units, the inverse of realize_rig.cpp.
#include <map>
#include <set>
#include <string>

#include "kelp/rig/rig.h"
#include "words.h"

namespace kelp {
namespace {

// Clips of a pack may share a name or have none, but in a rig names are keys.
class UniqueNames {
 public:
  std::string make(const std::string& wanted) {
    const std::string base = wanted.empty() ? "clip" : wanted;
    int& n = next_[base];  // a pack may hold very many of one name: do not count up from the start each time
    std::string name = n == 0 ? base : base + " " + std::to_string(n + 1);
    while (!used_.insert(name).second) name = base + " " + std::to_string(++n + 1);
    ++n;
    return name;
  }

 private:
  std::map<std::string, int> next_;
  std::set<std::string> used_;
};

}  // namespace

RigDescription describeRig(std::span<const Knot> knots, std::span<const RawClip> clips, std::uint32_t part,
                           const glm::ivec3& size, Axis axis) {
  const auto length = static_cast<float>(size.y);
  const glm::mat3 to_artist = glm::transpose(axisRotation(axis));  // permutes and flips: loses nothing
  RigDescription rig;
  rig.axis = axis;
  for (const Knot& knot : knots)
    rig.knots.push_back({knot.at, to_artist * ((knot.position - glm::vec3(0, knot.at * length, 0)) / length),
                         to_artist * (knot.tangent / length)});

  UniqueNames names;
  for (const RawClip& clip : clips) {
    RigDescription::Clip described{"", clip.duration, {}, {}};
    for (const Wave& wave : clip.waves) {
      if (wave.part == part)
        described.waves.push_back({static_cast<int>(wave.knot), wave.target,
                                   to_artist * (wave.amplitude / length), wave.period, wave.phase});
    }
    for (const RawTrack& track : clip.tracks) {
      if (track.part != part) continue;
      const bool knot = rig::movesKnot(track.target);
      const auto described_value = [&](const glm::vec4& value) {
        return knot ? glm::vec4(to_artist * (glm::vec3(value) / length), value.w) : value;
      };
      RigDescription::Track& target = described.tracks.emplace_back();
      target.knot = knot ? static_cast<int>(track.knot) : 0;
      target.target = track.target;
      target.interpolation = track.interpolation;
      for (const Key& key : track.keys) {
        RigDescription::Key& out = target.keys.emplace_back();
        out.time = key.time;
        out.value = described_value(key.value);
        if (track.interpolation == Interpolation::kCubic) {
          out.in = described_value(key.in);
          out.out = described_value(key.out);
        }
      }
    }
    if (described.waves.empty() && described.tracks.empty()) continue;
    described.name = names.make(clip.name);
    rig.clips.push_back(std::move(described));
  }
  return rig;
}

}  // namespace kelp
