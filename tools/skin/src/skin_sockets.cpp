// SPDX-License-Identifier: MIT
#include "skin_sockets.h"

#include <algorithm>
#include <cmath>

#include "rigid.h"

namespace kelp::bake {
namespace {

// The rotation of axes that may be stretched; y keeps its direction.
glm::quat turnOf(const glm::dmat3& axes) {
  const glm::dvec3 y = glm::normalize(axes[1]), x = glm::normalize(axes[0] - glm::dot(axes[0], y) * y);
  return glm::quat(quaternionOf({x, y, glm::cross(x, y)}));
}

}  // namespace

void addJointSockets(const SourceSkin& skin, const Frame& frame, std::vector<SkinJoint>& joints,
                     std::vector<std::string>& notices) {
  const glm::dvec3 size(frame.size);
  const double longest = kMaxResolution;
  const auto inVoxels = [&](const SourceSkin::Socket& socket) { return frame.node_to_voxel * socket.place; };
  const auto fits = [&](const glm::dmat4& place, const glm::ivec2& grow) {
    return size.y + grow.x + grow.y <= longest && glm::length(glm::dvec3(place[3])) < 1e6 * size.y;
  };
  const auto grown = [&](const glm::dmat4& place, const glm::ivec2& grow) {
    const double below = std::clamp(std::ceil(-place[3].y), 0.0, longest),
                 above = std::clamp(std::ceil(place[3].y - size.y), 0.0, longest);
    return glm::max(grow, glm::ivec2(static_cast<int>(below), static_cast<int>(above)));
  };
  std::vector<bool> kept;
  for (const SourceSkin::Socket& socket : skin.sockets) {  // first the boxes grow
    glm::ivec2& grow = joints[socket.joint].grow;
    const glm::dmat4 place = inVoxels(socket);
    const glm::ivec2 wanted = grown(place, grow);
    kept.push_back(fits(place, wanted));
    if (kept.back())
      grow = wanted;
    else
      notices.push_back("socket '" + socket.name + "' is too far from the model to be on joint '" +
                        joints[socket.joint].name + "': it is left out");
  }
  for (std::size_t i = 0; i < skin.sockets.size(); ++i) {
    if (!kept[i]) continue;
    const SourceSkin::Socket& socket = skin.sockets[i];
    SkinJoint& joint = joints[socket.joint];
    const glm::dmat4 place = inVoxels(socket);
    const double below = joint.grow.x, height = size.y + joint.grow.x + joint.grow.y;
    RigDescription::Socket& its = joint.rig.sockets.emplace_back();
    its.name = socket.name;
    its.at = static_cast<float>(std::clamp((place[3].y + below) / height, 0.0, 1.0));
    its.offset = glm::vec3((place[3].x - 0.5 * size.x) / height, 0, (place[3].z - 0.5 * size.z) / height);
    its.rotation = turnOf(glm::dmat3(place));
  }
}

}  // namespace kelp::bake
