// SPDX-License-Identifier: MIT
// Sockets drawn with empties socket.NAME: the place is the socket's, the axes are those of what a game will
// attach.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <set>

#include <fmt/format.h>

#include "gltf_model.h"

namespace kelp::bake {
namespace {

// of the extent: how far beyond the mesh's end a socket may lie without a notice
constexpr double kBeyondEnd = 0.02;
constexpr double kNothing = 1e-6;  // of the extent, of a quaternion: less is nothing
constexpr double kFarthest = 1e6;  // in extents: as far as a rig's numbers go

// "hand" of "socket.hand", "socket_hand" or "socket-hand"; empty: another name.
std::string nameOf(const std::string& node) {
  constexpr std::size_t kPrefix = 6;
  if (node.rfind("socket", 0) != 0 || node.size() < kPrefix + 2) return "";
  const char mark = node[kPrefix];
  return mark == '.' || mark == '_' || mark == '-' ? oneLine(node.substr(kPrefix + 1), 80) : "";
}

// Without the ".001" that Blender appends to a name that exists already.
std::string withoutCopyNumber(const std::string& name) {
  const std::size_t at = name.size() < 5 ? std::string::npos : name.size() - 4;
  const bool copy = at != std::string::npos && name[at] == '.' &&
                    std::all_of(name.begin() + static_cast<std::ptrdiff_t>(at) + 1, name.end(),
                                [](unsigned char c) { return std::isdigit(c); });
  return copy ? name.substr(0, at) : name;
}

// The box around the triangles, in the axes of the rig: y along the spline.
struct RigBox {
  glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-low};

  RigBox(const TriangleSoup& soup, const glm::dmat3& to_rig) {
    for (const TriangleSoup::Triangle& triangle : soup.triangles)
      for (const std::uint32_t vertex : triangle.vertex) {
        const glm::dvec3 p = to_rig * glm::dvec3(soup.positions[vertex]);
        low = glm::min(low, p);
        high = glm::max(high, p);
      }
  }
};

// The rotation of axes that may be stretched; y keeps its direction.
glm::dquat rotationOf(const glm::dmat3& axes) {
  const glm::dvec3 y = glm::normalize(axes[1]);
  const glm::dvec3 x = glm::normalize(axes[0] - glm::dot(axes[0], y) * y);
  const glm::dquat turn = glm::quat_cast(glm::dmat3(x, y, glm::cross(x, y)));
  return turn.w < 0 ? -turn : turn;
}

double snapped(double value) { return std::abs(value) < kNothing ? 0 : value; }

bool isUsable(const glm::dquat& q) {
  return std::isfinite(q.x) && std::isfinite(q.y) && std::isfinite(q.z) && std::isfinite(q.w);
}

}  // namespace

bool isSocket(const GltfModel& model, int node) {
  const tinygltf::Node& source = model.node(node);
  return source.mesh < 0 && !nameOf(source.name).empty();
}

std::vector<std::pair<int, std::string>> socketNames(const GltfModel& model, const std::vector<int>& nodes,
                                                     const std::string& part) {
  // Names as they are come first, so that "hand" is no copy of "hand.001".
  std::vector<int> order = nodes;
  std::stable_partition(order.begin(), order.end(), [&](int node) {
    const std::string name = nameOf(model.node(node).name);
    return withoutCopyNumber(name) == name;
  });
  std::vector<std::pair<int, std::string>> names;
  std::set<std::string> taken;
  for (const int node : order) {
    const std::string full = nameOf(model.node(node).name);
    const std::string name = taken.count(withoutCopyNumber(full)) ? full : withoutCopyNumber(full);
    if (names.size() == kMaxSockets) {
      model.note(
          fmt::format("part '{}' has more than {} sockets: the others are left out", part, kMaxSockets));
      break;
    }
    if (taken.insert(name).second)
      names.emplace_back(node, name);
    else
      model.note(fmt::format("{}: part '{}' has a socket '{}' already; rename one", model.nodeName(node),
                             part, name));
  }
  return names;
}

void addSockets(const GltfModel& model, const std::vector<int>& nodes, const glm::dmat4& space,
                SourcePart& part) {
  if (nodes.empty()) return;
  if (!part.rig.sockets.empty()) {
    model.note(fmt::format("part '{}': its rig ({}) has sockets: they count, not the {} of nodes", part.name,
                           part.rig_origin, nodes.size()));
    return;
  }
  const glm::dmat3 to_rig(axisRotation(part.rig.axis.value_or(Axis::kPlusY)));
  const RigBox box(part.soup, to_rig);
  const double length = box.high.y - box.low.y;
  for (const auto& [node, name] : socketNames(model, nodes, part.name)) {
    const std::string place = model.nodeName(node);
    const glm::dmat4 seat = glm::inverse(space) * model.world[static_cast<std::size_t>(node)];
    const glm::dvec3 at = to_rig * glm::dvec3(seat[3]);
    const glm::dvec3 offset = (at - (box.low + box.high) / 2.0) / length;
    const double along = (at.y - box.low.y) / length;
    const glm::dquat turn = rotationOf(to_rig * glm::dmat3(seat));
    if (!(length > 0) || !isUsable(turn) ||
        !(glm::length(glm::dvec3(offset.x, along, offset.z)) < kFarthest)) {
      model.note(place + ": no socket is made of it: " +
                 (length > 0 ? "its place or scale is beyond sense" : "the part is flat along its spline"));
      continue;
    }
    if (const double beyond = std::max(-along, along - 1); beyond > kBeyondEnd)
      model.note(
          fmt::format("{} lies {:.0f} % of the mesh's length beyond its end and is taken to the end; "
                      "move it there",
                      place, 100 * beyond));
    RigDescription::Socket& socket = part.rig.sockets.emplace_back();
    socket.name = name;
    socket.at = static_cast<float>(std::clamp(snapped(along), 0.0, 1.0));
    socket.offset = glm::vec3(glm::transpose(to_rig) * glm::dvec3(snapped(offset.x), 0, snapped(offset.z)));
    // `turn` takes the part's axes to the empty's. A rig has it in the axes of the node.
    const glm::dvec3 vector =
        glm::transpose(to_rig) * glm::dvec3(snapped(turn.x), snapped(turn.y), snapped(turn.z));
    socket.rotation = glm::quat(glm::normalize(glm::dquat(turn.w, vector.x, vector.y, vector.z)));
  }
}

}  // namespace kelp::bake
