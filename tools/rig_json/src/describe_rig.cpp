// SPDX-License-Identifier: MIT
// Voxels of a part -> the artist's units, the inverse of realize_rig.cpp for axis +y.
#include <map>
#include <set>
#include <string>

#include "kelp/rig_json/rig_json.h"
#include "words.h"

namespace kelp {
namespace {

// Clips of a pack may share a name or have none; in a rig the names are keys.
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

RigDescription describeRig(std::span<const Knot> knots, std::span<const RawClip> clips, std::uint32_t part, const glm::ivec3& size) {
  const auto length = static_cast<float>(size.y);
  RigDescription rig;
  rig.axis = Axis::kPlusY;
  for (const Knot& knot : knots)
    rig.knots.push_back({knot.at, (knot.position - glm::vec3(0, knot.at * length, 0)) / length, knot.tangent / length});

  UniqueNames names;
  for (const RawClip& clip : clips) {
    RigDescription::Clip described{"", clip.duration, {}, {}};
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
    if (described.waves.empty() && described.tracks.empty()) continue;
    described.name = names.make(clip.name);
    rig.clips.push_back(std::move(described));
  }
  return rig;
}

}  // namespace kelp
