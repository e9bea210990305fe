// SPDX-License-Identifier: MIT
// The axes of a part -> the artist's, the inverse of realize_rig.cpp.
#include "kelp/rig/raw_clips.h"
#include "kelp/rig/rig_file.h"
#include "sockets.h"
#include "words.h"

namespace kelp {
RigDescription describeRig(const RestRig& rest, std::span<const RawClip> clips, std::uint32_t part, Axis axis,
                           std::span<const RawSocket> sockets) {
  const glm::mat3 to_artist = glm::transpose(axisRotation(axis));  // permutes and flips: loses nothing
  RigDescription rig;
  rig.axis = axis;
  for (std::size_t i = 0; i < rest.knots.size(); ++i) {
    const Knot& knot = rest.knots[i];
    RigDescription::Knot& described = rig.knots.emplace_back();
    described.at = knot.at;
    described.offset = to_artist * (knot.position - glm::vec3(0, knot.at, 0));
    if (!(rest.automatic_tangents >> i & 1)) described.tangent = to_artist * knot.tangent;
  }

  // A tangent that was not made by realizeKnots stays as it is.
  const std::vector<Knot> realized = realizeKnots(rig);
  for (std::size_t i = 0; i < realized.size(); ++i)
    if (glm::distance(realized[i].tangent, rest.knots[i].tangent) > 1e-5f)
      rig.knots[i].tangent = to_artist * rest.knots[i].tangent;

  rig::UniqueNames names("clip");
  for (const RawClip& clip : clips) {
    RigDescription::Clip described{"", clip.duration, {}, {}};
    for (const Wave& wave : clip.waves) {
      if (wave.part == part)
        described.waves.push_back(
            {static_cast<int>(wave.knot), wave.target, to_artist * wave.amplitude, wave.period, wave.phase});
    }
    for (const RawTrack& track : clip.tracks) {
      if (track.part != part) continue;
      const bool knot = rig::movesKnot(track.target);
      const auto described_value = [&](const glm::vec4& value) {
        return knot ? glm::vec4(to_artist * glm::vec3(value), value.w) : value;
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
  describeSockets(sockets, part, rig);
  rig.parent_at = rest.parent_at;
  rig.bend = rest.bend;
  rig.caged = rest.caged;
  rig.cell = rest.cell;
  rig.roll = rest.roll;
  return rig;
}

RigFile describeParts(const Pack& pack, const RiggedPack& rigged) {
  // Of each part alone: a pack may have very many of both.
  std::vector<std::vector<RawClip>> clips(pack.parts().size());
  std::vector<std::vector<RawSocket>> sockets(pack.parts().size());
  for (const RawClip& clip : rawClips(pack))
    for (auto& [part, share] : splitByPart(clip)) clips[part].push_back(std::move(share));
  for (RawSocket& socket : rawSockets(pack)) sockets[socket.part].push_back(std::move(socket));
  RigFile file;
  std::vector<std::size_t> places(pack.parts().size());
  for (std::uint32_t i = 0; i < pack.parts().size(); ++i) {
    const Part& part = pack.parts()[i];
    if (!rigged.given[i]) continue;
    places[i] = file.parts.size();
    file.parts.push_back(
        {std::string(part.name), describeRig(restRig(part), clips[i], i, rigged.axes[i], sockets[i])});
  }
  for (std::uint32_t i = 0; i < pack.parts().size(); ++i) {
    const std::optional<RiggedPack::Side>& side = rigged.sides[i];
    if (!side || side->corner == -1 || !rigged.given[side->of]) continue;
    if (side->corner == RiggedPack::kSections) {
      addSections(describeRig(restRig(pack.parts()[i]), clips[i], i), file.parts[places[side->of]].rig);
      continue;
    }
    const Axis axis = rigged.axes[side->of];
    RigDescription rig = describeRig(restRig(pack.parts()[i]), clips[i], i, axis);
    file.parts[places[side->of]].rig.sides.push_back(
        {cornerName(side->corner, axis), std::move(rig.knots), std::move(rig.clips)});
  }
  return file;
}

}  // namespace kelp
