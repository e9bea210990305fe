// SPDX-License-Identifier: MIT
#include "pack_rig.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "kelp/rig/raw_clips.h"
#include "pack_info.h"

namespace kelp::view {
namespace {

constexpr float kAlike = 1e-4f;   // of a part's height
constexpr float kTurned = 1e-3f;  // between directions that count as one

bool near(const glm::vec3& a, const glm::vec3& b, float tolerance) {
  return glm::all(glm::lessThanEqual(glm::abs(a - b), glm::vec3(tolerance)));
}
bool near(const glm::vec4& a, const glm::vec4& b, float tolerance) {
  return glm::all(glm::lessThanEqual(glm::abs(a - b), glm::vec4(tolerance)));
}
bool near(float a, float b) { return std::abs(a - b) <= 1e-4f * std::max(1.0f, std::abs(a)); }

bool moves(const RawClip& clip, std::uint32_t part) {
  return std::any_of(clip.waves.begin(), clip.waves.end(),
                     [&](const auto& wave) { return wave.part == part; }) ||
         std::any_of(clip.tracks.begin(), clip.tracks.end(),
                     [&](const auto& track) { return track.part == part; });
}

// Turns what moves knots of one part.
void turnClips(std::vector<RawClip>& clips, const glm::mat3& turn) {
  const auto turned = [&](const glm::vec4& v) { return glm::vec4(turn * glm::vec3(v), v.w); };
  for (RawClip& clip : clips) {
    for (Wave& wave : clip.waves) wave.amplitude = turn * wave.amplitude;
    for (RawTrack& track : clip.tracks) {
      if (track.target != Target::kKnotOffset && track.target != Target::kKnotTangent) continue;
      for (Key& key : track.keys) {
        key.value = turned(key.value);
        key.in = turned(key.in);
        key.out = turned(key.out);
      }
    }
  }
}

// Turns the sockets of one part. The frame of a socket is the part's, turned by its rotation.
void turnSockets(std::vector<RawSocket>& sockets, const glm::mat3& turn) {
  for (RawSocket& socket : sockets) {
    const glm::vec3 offset = turn * glm::vec3(socket.offset.x, 0, socket.offset.y);
    socket.offset = {offset.x, offset.z};
    socket.rotation = glm::normalize(glm::quat_cast(turn) * socket.rotation);
  }
}

bool sameSocket(const RawSocket& a, const RawSocket& b) {
  return a.part == b.part && a.name == b.name && near(a.at, b.at) && near(a.offset.x, b.offset.x) &&
         near(a.offset.y, b.offset.y) && std::abs(glm::dot(a.rotation, b.rotation)) > 1 - 1e-6f;
}

void turnKnots(std::vector<Knot>& knots, const glm::mat3& turn) {
  for (Knot& knot : knots) {
    knot.position = turn * knot.position;
    knot.tangent = turn * knot.tangent;
  }
}

}  // namespace

Sizes sizesOf(const Pack& pack) {
  Sizes sizes;
  for (const Part& part : pack.parts()) sizes.push_back(part.size);
  return sizes;
}

PackRig rigOf(const Pack& pack) {
  PackRig rig;
  for (const Part& part : pack.parts()) rig.parts.push_back(restRig(part));
  rig.clips = rawClips(pack);
  rig.sockets = rawSockets(pack);
  return rig;
}

bool alike(const PackRig& a, const PackRig& b) {
  if (a.parts.size() != b.parts.size() || a.clips.size() != b.clips.size() ||
      !std::is_permutation(a.sockets.begin(), a.sockets.end(), b.sockets.begin(), b.sockets.end(),
                           sameSocket))
    return false;
  for (std::size_t part = 0; part < a.parts.size(); ++part) {
    const RestRig &r = a.parts[part], &s = b.parts[part];
    const bool other_cells = r.cell != s.cell && r.cell != 0 && s.cell != 0;
    if (r.automatic_tangents != s.automatic_tangents || !near(r.parent_at, s.parent_at) || r.bend != s.bend ||
        r.caged != s.caged || other_cells || !near(r.roll, s.roll) ||
        !std::equal(r.knots.begin(), r.knots.end(), s.knots.begin(), s.knots.end(),
                    [&](const Knot& k, const Knot& l) {
                      return near(k.at, l.at) && near(k.position, l.position, kAlike) &&
                             near(k.tangent, l.tangent, 4 * kAlike);
                    }))
      return false;
  }
  return std::equal(a.clips.begin(), a.clips.end(), b.clips.begin(), [&](const RawClip& c, const RawClip& d) {
    return c.name == d.name && near(c.duration, d.duration) &&
           std::equal(c.waves.begin(), c.waves.end(), d.waves.begin(), d.waves.end(),
                      [&](const Wave& v, const Wave& w) {
                        return v.part == w.part && v.knot == w.knot && v.target == w.target &&
                               near(v.amplitude, w.amplitude, kAlike) && near(v.period, w.period) &&
                               near(v.phase, w.phase);
                      }) &&
           std::equal(c.tracks.begin(), c.tracks.end(), d.tracks.begin(), d.tracks.end(),
                      [&](const RawTrack& t, const RawTrack& u) {
                        return t.part == u.part && t.knot == u.knot && t.target == u.target &&
                               t.interpolation == u.interpolation &&
                               std::equal(t.keys.begin(), t.keys.end(), u.keys.begin(), u.keys.end(),
                                          [&](const Key& k, const Key& l) {
                                            return near(k.time, l.time) && near(k.value, l.value, kAlike);
                                          });
                      });
  });
}

RigAxes axesOf(const Pack& pack, const RiggedPack& rigged, int index) {
  const Part& part = pack.parts()[static_cast<std::size_t>(index)];
  RigAxes axes;
  if (rigged.by_part) {
    axes.axis = rigged.axes[static_cast<std::size_t>(index)];
    return axes;
  }
  // The part's directions in the file, each of unit length: units and scales do not turn anything.
  glm::mat3 in_file = glm::transpose(axisRotation(upAxisOf(pack.infoJson()))) * glm::mat3(part.to_object);
  for (int column = 0; column < 3; ++column) in_file[column] = glm::normalize(in_file[column]);
  std::optional<Axis> along;
  for (const Axis axis :
       {Axis::kPlusX, Axis::kMinusX, Axis::kPlusY, Axis::kMinusY, Axis::kPlusZ, Axis::kMinusZ}) {
    if (near(glm::transpose(axisRotation(axis)) * glm::vec3(0, 1, 0), in_file[1], kTurned)) along = axis;
  }
  const glm::mat3 turn = along ? glm::inverse(in_file) * glm::transpose(axisRotation(*along)) : glm::mat3(1);
  const bool rigid = along && near(turn * glm::vec3(0, 1, 0), glm::vec3(0, 1, 0), kTurned);
  if (rigid) {
    axes.axis = *along;
    bool straight = true;
    for (int column = 0; column < 3; ++column)
      straight = straight && near(turn[column], glm::mat3(1)[column], kTurned);
    if (!straight) axes.turn = turn;
  }
  if (!rigid)
    axes.trouble =
        "the spline does not run along an axis of the file: put the rig into extras.kelp of the node '" +
        std::string(part.name) + "'";
  return axes;
}

RigDescription describe(const PackRig& rig, int index, const RigAxes& axes) {
  const auto part = static_cast<std::uint32_t>(index);
  RestRig rest = rig.parts[part];
  std::vector<RawClip> clips;
  for (const RawClip& clip : rig.clips) {
    if (!moves(clip, part)) continue;
    RawClip& own = clips.emplace_back(RawClip{clip.name, clip.duration, {}, {}});
    std::copy_if(clip.waves.begin(), clip.waves.end(), std::back_inserter(own.waves),
                 [&](const auto& wave) { return wave.part == part; });
    std::copy_if(clip.tracks.begin(), clip.tracks.end(), std::back_inserter(own.tracks),
                 [&](const auto& track) { return track.part == part; });
  }
  std::vector<RawSocket> sockets;
  std::copy_if(rig.sockets.begin(), rig.sockets.end(), std::back_inserter(sockets),
               [&](const RawSocket& socket) { return socket.part == part; });
  if (axes.turn != glm::mat3(1)) {
    turnKnots(rest.knots, glm::inverse(axes.turn));
    turnClips(clips, glm::inverse(axes.turn));
    turnSockets(sockets, glm::inverse(axes.turn));
  }
  return describeRig(rest, clips, part, axes.axis, sockets);
}

PackRig realize(const std::vector<RigDescription>& rigs, const std::vector<RigAxes>& axes) {
  PackRig rig;
  for (std::size_t part = 0; part < rigs.size(); ++part) {
    RestRig rest = realizeRig(rigs[part]);
    std::vector<RawSocket> sockets = realizeSockets(rigs[part], static_cast<std::uint32_t>(part));
    std::vector<RawClip> clips = realizeClips(rigs[part], static_cast<std::uint32_t>(part));
    if (axes[part].turn != glm::mat3(1)) {
      turnKnots(rest.knots, axes[part].turn);
      turnClips(clips, axes[part].turn);
      turnSockets(sockets, axes[part].turn);
    }
    std::move(sockets.begin(), sockets.end(), std::back_inserter(rig.sockets));
    rig.parts.push_back(std::move(rest));
    mergeClips(rig.clips, std::move(clips));
  }
  return rig;
}

void prove(const PackRig& rig, const Sizes& sizes) {
  for (std::size_t part = 0; part < rig.parts.size(); ++part) {
    checkRest(rig.parts[part], sizes[part]);
    for (const RawClip& clip : rig.clips) {
      if (moves(clip, static_cast<std::uint32_t>(part)))
        (void)proveClip(clip, static_cast<std::uint32_t>(part), rig.parts[part], sizes[part]);
    }
  }
}

}  // namespace kelp::view
