// SPDX-License-Identifier: MIT
// The sockets of a rig's JSON.
#include "json_place.h"
#include "sockets.h"

namespace kelp::rig {

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

}  // namespace kelp::rig
