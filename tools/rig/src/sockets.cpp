// SPDX-License-Identifier: MIT
// Sockets: from JSON; from the artist's axes to those of a part, and back.
#include <cmath>

#include "json_place.h"
#include "kelp/rig/rig.h"
#include "sockets.h"
#include "words.h"

namespace kelp {
namespace {

// As it is, unless a reader of packs could refuse its length.
glm::quat unit(const glm::quat& q) { return std::abs(glm::dot(q, q) - 1) > 1e-5f ? glm::normalize(q) : q; }

// A rotation seen from other axes: axes * rotation * inverse(axes).
glm::quat seenFrom(const glm::mat3& axes, const glm::quat& rotation) {
  const glm::vec3 v = axes * glm::vec3(rotation.x, rotation.y, rotation.z);
  return {rotation.w, v.x, v.y, v.z};
}

}  // namespace

namespace rig {
namespace {

// The fault of a socket's offset for a spline along this axis; empty if there is none.
std::string faultOfOffset(const glm::vec3& offset, Axis axis) {
  const float along = (axisRotation(axis) * offset).y;
  if (std::abs(along) <= 1e-6f) return "";
  return "it goes " + printable(along) + " along the axis " + toString(axis) +
         ", but a socket's offset lies across the axis; move the socket along it with \"at\"";
}

}  // namespace

void readSockets(const Place& place, RigDescription& rig) {
  static constexpr std::array<std::string_view, 3> kKeys{"at", "offset", "rotation"};
  if (!place.json.is_object())
    fail(place, std::string("must be an object that maps names to sockets, not ") + kindOf(place.json));
  if (place.json.size() > kMaxSockets)
    fail(place, "has " + std::to_string(place.json.size()) + " sockets; a rig has at most " +
                    std::to_string(kMaxSockets));
  for (const auto& member : place.json.items()) {
    const Place entry = place.at(member.key());
    checkName(entry, "socket", member.key());
    requireObject(entry, kKeys);
    RigDescription::Socket& socket = rig.sockets.emplace_back();
    socket.name = member.key();
    socket.at = readFloat(required(entry, "at", "say where along the axis the socket is, 0 to 1"), 0, 1);
    if (entry.has("offset")) {
      const Place offset = entry.at("offset");
      socket.offset = readVec3(offset);
      // Without an axis of its own the rig may be used with another: then realizeSockets checks it.
      if (const std::string fault = rig.axis ? faultOfOffset(socket.offset, *rig.axis) : ""; !fault.empty())
        fail(offset, fault);
    }
    if (entry.has("rotation")) {
      const glm::vec4 q = readRotation(entry.at("rotation"));
      socket.rotation = glm::quat(q.w, q.x, q.y, q.z);
    }
  }
}

}  // namespace rig

std::vector<RawSocket> realizeSockets(const RigDescription& rig, std::uint32_t part) {
  const Axis axis = rig.axis.value_or(Axis::kPlusY);
  const glm::mat3 to_part = axisRotation(axis);
  std::vector<RawSocket> sockets;
  for (const RigDescription::Socket& socket : rig.sockets) {
    if (const std::string fault = rig::faultOfOffset(socket.offset, axis); !fault.empty())
      throw RigError("/sockets/" + rig::printable(socket.name) + "/offset: " + fault);
    const glm::vec3 offset = to_part * socket.offset;
    sockets.push_back(
        {socket.name, part, socket.at, {offset.x, offset.z}, unit(seenFrom(to_part, socket.rotation))});
  }
  return sockets;
}

void describeSockets(std::span<const RawSocket> sockets, std::uint32_t part, RigDescription& rig) {
  const glm::mat3 to_artist = glm::transpose(axisRotation(rig.axis.value_or(Axis::kPlusY)));
  rig::UniqueNames names("socket");
  for (const RawSocket& socket : sockets)
    if (socket.part == part)
      rig.sockets.push_back({names.make(socket.name), socket.at,
                             to_artist * glm::vec3(socket.offset.x, 0, socket.offset.y),
                             seenFrom(to_artist, socket.rotation)});
}

}  // namespace kelp
