// SPDX-License-Identifier: MIT
#include "metadata_writer.h"

#include <cstdint>
#include <string_view>
#include <vector>

#include "layout.h"
#include "record_writer.h"

namespace kelp {

bool buildParts(const RawPack& pack, Buffer<std::byte>& out) {
  std::size_t text = 0;
  for (const RawPart& part : pack.parts) text += part.name.size();
  if (!out.reset(layout::kPartHeader + pack.parts.size() * layout::kPartRecord + text)) return false;
  RecordWriter to(out);
  to.count(pack.parts.size());
  to.count(text);
  for (const RawPart& part : pack.parts) {
    to.count(part.name.size());
    to.put(static_cast<std::int32_t>(part.parent));
    to.put(part.fog ? PartKind::kFog : part.levels.empty() ? PartKind::kEmpty : PartKind::kSolid);
    // Too many levels must not wrap around to a valid number.
    to.put(static_cast<std::uint8_t>(part.levels.size() < 255 ? part.levels.size() : 255));
    to.put(std::uint16_t{0});
    to.put(part.size);
    to.put(part.to_object);
    to.put(part.pivot);
  }
  for (const RawPart& part : pack.parts) to.text(part.name);
  return true;
}

bool buildPalette(const RawPack& pack, Buffer<std::byte>& out) {
  if (!out.reset(layout::kMatlHeader + pack.palette.size() * layout::kMatlRecord)) return false;
  RecordWriter to(out);
  to.count(pack.palette.size());
  for (const Material& material : pack.palette) {
    to.put(material.base_color);
    to.put(material.emissive);
    to.put(material.metallic);
    to.put(material.roughness);
  }
  return true;
}

bool buildFogs(const RawPack& pack, Buffer<std::byte>& out) {
  std::size_t fogs = 0, levels = 0, colors = 0;
  for (const RawPart& part : pack.parts) {
    if (!part.fog) continue;
    ++fogs;
    levels += part.levels.size();
    colors += part.fog->ramp.size();
  }
  if (fogs == 0) return bool{out.reset(0)};
  if (!out.reset(layout::kFogsHeader + fogs * layout::kFogRecord + levels * sizeof(float) +
                 colors * layout::kRampRecord))
    return false;
  RecordWriter to(out);
  to.count(fogs);
  for (const RawPart& part : pack.parts) {
    if (!part.fog) continue;
    to.put(part.fog->color);
    to.put(part.fog->anisotropy);
    to.put(part.fog->glow);
    to.count(part.fog->ramp.size());
    to.put(std::uint32_t{0});
  }
  for (const RawPart& part : pack.parts) {
    if (!part.fog) continue;
    for (const RawLevel& level : part.levels) to.put(level.extinction);
  }
  for (const RawPart& part : pack.parts) {
    if (!part.fog) continue;
    for (const glm::vec3& color : part.fog->ramp) to.put(color);
  }
  return true;
}

bool buildRigs(const RawPack& pack, Buffer<std::byte>& out) {
  std::size_t knots = 0;
  for (const RawPart& part : pack.parts) knots += part.knots.size();
  if (!out.reset(layout::kRigsHeader + pack.parts.size() * layout::kRigsPerPart +
                 knots * layout::kKnotRecord))
    return false;
  RecordWriter to(out);
  to.count(pack.parts.size());
  to.count(knots);
  for (const RawPart& part : pack.parts) {
    to.count(part.knots.size());
    to.put(part.automatic_tangents);
    to.put(part.parent_at);
    to.put(static_cast<std::uint32_t>(part.bend));
    to.put(part.roll);
  }
  for (const RawPart& part : pack.parts) {
    for (const Knot& knot : part.knots) {
      to.put(knot.at);
      to.put(knot.position);
      to.put(knot.tangent);
    }
  }
  return true;
}

bool buildClips(const RawPack& pack, Buffer<std::byte>& out) {
  std::size_t waves = 0, tracks = 0, keys = 0, text = 0;
  for (const RawClip& clip : pack.clips) {
    waves += clip.waves.size();
    tracks += clip.tracks.size();
    for (const RawTrack& track : clip.tracks) keys += track.keys.size();
    text += clip.name.size();
  }
  if (!out.reset(layout::kClipHeader + pack.clips.size() * layout::kClipRecord + waves * layout::kWaveRecord +
                 tracks * layout::kTrackRecord + keys * layout::kKeyRecord + text)) {
    return false;
  }
  RecordWriter to(out);
  for (const std::size_t n : {pack.clips.size(), waves, tracks, keys, text}) to.count(n);
  for (const RawClip& clip : pack.clips) {
    to.count(clip.name.size());
    to.put(clip.duration);
    to.count(clip.waves.size());
    to.count(clip.tracks.size());
  }
  for (const RawClip& clip : pack.clips) {
    for (const Wave& wave : clip.waves) {
      to.put(wave.part);
      to.put(wave.knot);
      to.put(static_cast<std::uint32_t>(wave.target));
      to.put(wave.amplitude);
      to.put(wave.period);
      to.put(wave.phase);
    }
  }
  for (const RawClip& clip : pack.clips) {
    for (const RawTrack& track : clip.tracks) {
      to.put(track.part);
      to.put(track.knot);
      to.put(track.target);
      to.put(track.interpolation);
      to.put(std::uint16_t{0});
      to.count(track.keys.size());
    }
  }
  std::byte* const planes = out.data() + out.size() - text - keys * layout::kKeyRecord;
  std::size_t next = 0;
  for (const RawClip& clip : pack.clips) {
    for (const RawTrack& track : clip.tracks) {
      for (const Key& key : track.keys) {
        static_assert(sizeof(Key) == layout::kKeyRecord);
        std::byte record[layout::kKeyRecord];
        layout::store(std::span(record), 0, key);
        for (std::size_t b = 0; b < layout::kKeyRecord; ++b) planes[b * keys + next] = record[b];
        ++next;
      }
    }
  }
  to.skip(keys * layout::kKeyRecord);
  for (const RawClip& clip : pack.clips) to.text(clip.name);
  return true;
}

bool buildSockets(const RawPack& pack, Buffer<std::byte>& out) {
  std::size_t text = 0;
  for (const RawSocket& socket : pack.sockets) text += socket.name.size();
  if (!out.reset(layout::kSockHeader + pack.sockets.size() * layout::kSockRecord + text)) return false;
  RecordWriter to(out);
  to.count(pack.sockets.size());
  to.count(text);
  for (const RawSocket& socket : pack.sockets) {
    to.count(socket.name.size());
    to.put(socket.part);
    to.put(socket.at);
    to.put(socket.offset);
    const glm::quat& q = socket.rotation;
    to.put(glm::vec4(q.x, q.y, q.z, q.w));
  }
  for (const RawSocket& socket : pack.sockets) to.text(socket.name);
  return true;
}

bool buildJoints(const RawPack& pack, Buffer<std::byte>& out) {
  std::size_t text = 0, listed = 0;
  for (const RawJoint& joint : pack.joints) {
    text += joint.name.size();
    listed += joint.parts.size();
  }
  if (!out.reset(layout::kJntsHeader + pack.joints.size() * layout::kJntsRecord +
                 listed * sizeof(std::uint32_t) + text))
    return false;
  RecordWriter to(out);
  for (const std::size_t n : {pack.joints.size(), listed, text}) to.count(n);
  for (const RawJoint& joint : pack.joints) {
    to.count(joint.name.size());
    to.put(joint.parent);
    to.put(joint.inverse_bind);
    to.count(joint.parts.size());
  }
  for (const RawJoint& joint : pack.joints)
    for (const std::uint32_t part : joint.parts) to.put(part);
  for (const RawJoint& joint : pack.joints) to.text(joint.name);
  return true;
}

}  // namespace kelp
