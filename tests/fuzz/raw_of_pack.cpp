// SPDX-License-Identifier: MIT
#include "raw_of_pack.h"

#include <algorithm>
#include <cstring>
#include <type_traits>

#include "kelp/formats/raw_level.h"
#include "support/without_boxes.h"

namespace {

using namespace kelp;

template <class To, class From>
std::vector<To> listOf(const From& from) {
  return std::vector<To>(from.begin(), from.end());
}

// Bit by bit: a number may be -0, and none may be lost.
template <class T>
bool same(const T& a, const T& b) {
  static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= 4);
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}
template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const T& x, const T& y) { return same(x, y); });
}
bool same(const std::string& a, const std::string& b) { return a == b; }

bool same(const Wave& a, const Wave& b) {  // has bytes between its members
  return a.part == b.part && a.knot == b.knot && a.target == b.target && same(a.amplitude, b.amplitude) &&
         same(a.period, b.period) && same(a.phase, b.phase);
}
bool same(const RawSocket& a, const RawSocket& b) {
  return a.name == b.name && a.part == b.part && same(a.at, b.at) && same(a.offset, b.offset) &&
         same(a.rotation, b.rotation);
}
bool same(const RawJoint& a, const RawJoint& b) {
  return a.name == b.name && a.parent == b.parent && same(a.inverse_bind, b.inverse_bind) &&
         a.parts == b.parts;
}
bool same(const RawTrack& a, const RawTrack& b) {
  return a.part == b.part && a.knot == b.knot && a.target == b.target && a.interpolation == b.interpolation &&
         same(a.keys, b.keys);
}

template <class T>
bool all(const std::vector<T>& a, const std::vector<T>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const T& x, const T& y) { return same(x, y); });
}

const char* differenceOfParts(const RawPart& a, const RawPart& b) {
  if (!same(a.name, b.name)) return "a part's name";
  if (a.parent != b.parent) return "a part's parent";
  if (a.size != b.size) return "a part's size";
  if (!same(a.to_object, b.to_object) || !same(a.pivot, b.pivot)) return "a part's place";
  if (!same(a.knots, b.knots)) return "a part's knots";
  if (a.automatic_tangents != b.automatic_tangents) return "a part's automatic tangents";
  if (!same(a.parent_at, b.parent_at)) return "a part's place on its parent's spline";
  if (a.bend != b.bend || !same(a.roll, b.roll)) return "a part's way to bend";
  if (a.fog.has_value() != b.fog.has_value()) return "a part's kind";
  if (a.fog && !(same(a.fog->color, b.fog->color) && same(a.fog->anisotropy, b.fog->anisotropy) &&
                 same(a.fog->glow, b.fog->glow) && same(a.fog->ramp, b.fog->ramp)))
    return "a part's fog";
  if (a.levels.size() != b.levels.size()) return "a part's number of levels";
  for (std::size_t i = 0; i < a.levels.size(); ++i) {
    const RawLevel &x = a.levels[i], &y = b.levels[i];
    const auto of_x = test::withoutBoxes(x), of_y = test::withoutBoxes(y);
    if (of_x.first != of_y.first) return "a level's cells";
    if (of_x.second != of_y.second || x.attributes != y.attributes) return "a level's voxels";
    if (x.density != y.density || x.heat != y.heat) return "a level's fog";
    if (a.fog && !same(x.extinction, y.extinction)) return "a level's extinction";
  }
  return nullptr;
}

}  // namespace

Result<RawPack> rawOf(const Pack& pack, const Allocator& allocator) {
  RawPack out;
  out.info_json = pack.infoJson();
  out.palette = listOf<Material>(pack.palette());
  for (std::size_t i = 0; i < pack.parts().size(); ++i) {
    const Part& part = pack.parts()[i];
    RawPart& raw = out.parts.emplace_back();
    raw.name = part.name;
    raw.parent = part.parent;
    raw.size = part.size;
    raw.to_object = part.to_object;
    raw.pivot = part.pivot;
    raw.knots = listOf<Knot>(part.knots);
    raw.automatic_tangents = part.automatic_tangents;
    raw.parent_at = part.parent_at;
    raw.bend = part.bend;
    raw.roll = part.roll;
    if (part.fog)
      raw.fog =
          RawFog{part.fog->color, part.fog->anisotropy, part.fog->glow, listOf<glm::vec3>(part.fog->ramp)};
    for (int level = 0; level < part.levels; ++level) {
      Result<RawLevel> read = readRawLevel(pack, static_cast<int>(i), level, allocator);
      if (!read) return read.error();
      raw.levels.push_back(*std::move(read));
    }
  }
  for (const Clip& clip : pack.clips()) {
    RawClip& raw = out.clips.emplace_back();
    raw.name = clip.name;
    raw.duration = clip.duration;
    raw.waves = listOf<Wave>(clip.waves);
    for (const Track& track : clip.tracks)
      raw.tracks.push_back(
          {track.part, track.knot, track.target, track.interpolation, listOf<Key>(track.keys)});
  }
  for (const Socket& socket : pack.sockets())
    out.sockets.push_back({std::string(socket.name), socket.part, socket.at, socket.offset, socket.rotation});
  for (const Joint& joint : pack.joints())
    out.joints.push_back(
        {std::string(joint.name), joint.parent, joint.inverse_bind, listOf<std::uint32_t>(joint.parts)});
  return out;
}

const char* differenceOf(const RawPack& a, const RawPack& b) {
  if (!same(a.info_json, b.info_json)) return "the information";
  if (!same(a.palette, b.palette)) return "the palette";
  if (a.parts.size() != b.parts.size()) return "the number of parts";
  for (std::size_t i = 0; i < a.parts.size(); ++i)
    if (const char* difference = differenceOfParts(a.parts[i], b.parts[i])) return difference;
  if (a.clips.size() != b.clips.size()) return "the number of clips";
  for (std::size_t i = 0; i < a.clips.size(); ++i) {
    const RawClip &x = a.clips[i], &y = b.clips[i];
    if (!same(x.name, y.name) || !same(x.duration, y.duration)) return "a clip's name or duration";
    if (!all(x.waves, y.waves)) return "a clip's waves";
    if (!all(x.tracks, y.tracks)) return "a clip's tracks";
  }
  if (!all(a.sockets, b.sockets)) return "the sockets";
  if (!all(a.joints, b.joints)) return "the joints";
  return nullptr;
}
