// SPDX-License-Identifier: MIT
#include "sockets.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>

#include "kelp/import/core/source_model.h"
#include "knots.h"

namespace kelp::bake {
namespace {

// of the extent: how far beyond the mesh's end a socket may lie without a notice
constexpr double kEndTolerance = 0.02;

// "hand" of "socket.hand", "socket_hand" or "socket-hand". Empty: another name.
std::string socketName(const std::string& name) {
  if (name.size() < 8 || name.rfind("socket", 0) != 0) return "";
  if (name[6] != '.' && name[6] != '_' && name[6] != '-') return "";
  return name.substr(7);
}

// Without the ".001" that Blender appends to a name that another object has.
std::string withoutNumber(const std::string& name) {
  const std::size_t dot = name.size() < 5 ? 0 : name.size() - 4;
  const bool numbered = dot > 0 && name[dot] == '.' &&
                        std::all_of(name.begin() + static_cast<std::ptrdiff_t>(dot) + 1, name.end(),
                                    [](unsigned char c) { return std::isdigit(c); });
  return numbered ? name.substr(0, dot) : name;
}

bool hasSocket(const RigDescription& rig, const std::string& name) {
  return std::any_of(rig.sockets.begin(), rig.sockets.end(),
                     [&](const RigDescription::Socket& socket) { return socket.name == name; });
}

glm::dvec3 middleOf(const TriangleSoup& soup) {
  glm::dvec3 low(INFINITY), high(-INFINITY);
  for (const glm::vec3& position : soup.positions) {
    low = glm::min(low, glm::dvec3(position));
    high = glm::max(high, glm::dvec3(position));
  }
  return 0.5 * (low + high);
}

// The rotation of a matrix whose columns may have any lengths. Mirrored ones keep their x and y.
glm::dquat rotationOf(const glm::dmat3& m) {
  const glm::dvec3 y = glm::normalize(m[1]), x = glm::normalize(m[0] - glm::dot(m[0], y) * y);
  return glm::normalize(glm::quat_cast(glm::dmat3(x, y, glm::cross(x, y))));
}

}  // namespace

std::vector<SocketNode> findSockets(const GltfModel& model, const std::set<int>& part_nodes) {
  std::vector<SocketNode> sockets;
  for (const int node : model.order) {
    const std::string name = socketName(model.node(node).name);
    if (name.empty() || model.node(node).mesh >= 0) continue;
    int owner = model.parents[static_cast<std::size_t>(node)];
    while (owner >= 0 && !part_nodes.contains(owner)) owner = model.parents[static_cast<std::size_t>(owner)];
    sockets.push_back({node, owner, oneLine(name, 80)});
  }
  return sockets;
}

void addSockets(const GltfModel& model, const std::vector<SocketNode>& sockets, int node, SourcePart& part) {
  const Axis axis = part.rig.axis.value_or(Axis::kPlusY);
  const KnotExtent extent = extentAlong(part.soup, axis);
  const glm::dvec3 middle = middleOf(part.soup);
  const glm::dmat4 from_object =
      glm::inverse(glm::dmat4(glm::dmat4x3(part.to_object)));  // the last row of a widened matrix is 0 0 0 1
  for (const SocketNode& socket : sockets) {
    if (socket.owner != node) continue;
    const std::string place = "socket '" + socket.name + "' of part '" + part.name + "'";
    const std::string plain = withoutNumber(socket.name);
    const std::string& name = hasSocket(part.rig, plain) ? socket.name : plain;
    if (hasSocket(part.rig, name)) {
      model.note(place + " is in the rig already: the empty of that name is left out");
      continue;
    }
    const glm::dmat4 in_part = from_object * model.world[static_cast<std::size_t>(socket.node)];
    const glm::dvec3 at(in_part[3]);
    const glm::dmat3 turn(in_part);
    const double along = (glm::dot(extent.axis, at) - extent.low) / extent.length;
    if (!(extent.length > 0) || !std::isfinite(along) || !(std::abs(glm::determinant(turn)) > 0)) {
      model.note(place + " has no place: it or its mesh is flat, or too far away; it is left out");
      continue;
    }
    if (along < -kEndTolerance || along > 1 + kEndTolerance)
      model.note(fmt::format("{} lies {:.0f} % of the mesh's length beyond its end and is taken to the end",
                             place, 100 * (along < 0 ? -along : along - 1)));
    glm::dvec3 beside = (at - middle) / extent.length;
    beside -= glm::dot(beside, extent.axis) * extent.axis;
    // A socket without a rotation has the part's axes, whose y is the rig's axis: the rest is the empty's
    // own.
    const glm::quat rotation(rotationOf(turn) * glm::quat_cast(glm::dmat3(axisRotation(axis))));
    part.rig.sockets.push_back(
        {name, static_cast<float>(std::clamp(along, 0.0, 1.0)), glm::vec3(beside), glm::normalize(rotation)});
  }
}

}  // namespace kelp::bake
