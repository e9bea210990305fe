// SPDX-License-Identifier: MIT
#include "window/rig_controls.h"

#include <cstdio>

#include <imgui.h>
#include <glm/gtc/quaternion.hpp>

#include "rig_knots.h"

namespace kelp::view {
namespace {

// False: it is to be removed.
bool drawSocket(Draft& draft, RigDescription::Socket& socket) {
  char name[256];
  std::snprintf(name, sizeof name, "%s", socket.name.c_str());
  ImGui::SetNextItemWidth(150);
  // Taken when the user leaves the field: half a name may be another socket's.
  ImGui::InputText("##name", name, sizeof name);
  if (ImGui::IsItemDeactivatedAfterEdit() && name[0] != '\0') {
    socket.name = name;
    draft.changed = true;
  }
  tip("The name by which a game finds the socket.");
  ImGui::SameLine();
  draft.changed |= dragNumber("at", socket.at, kLengthsPerPixel, 0, 1, "%.3f");
  tip("Where along the axis: 0 is the first knot, 1 the last.");
  ImGui::SameLine();
  if (ImGui::SmallButton("remove")) return false;
  if (dragLengths("offset", socket.offset)) {
    socket.offset = acrossAxis(draft.rig, socket.offset);
    draft.changed = true;
  }
  tip("From the middle of the model, across the axis, in the file's axes. 1 is the model's length along the "
      "axis.");
  glm::vec3 degrees = glm::degrees(glm::eulerAngles(socket.rotation));
  if (ImGui::SetNextItemWidth(230), ImGui::DragFloat3("turn", &degrees.x, 0.5f, -180, 180, "%.1f")) {
    socket.rotation = glm::normalize(glm::quat(glm::radians(degrees)));
    draft.changed = true;
  }
  tip("Degrees about x, y and z. Without a turn, y runs along the spline.");
  return true;
}

}  // namespace

void drawSockets(Draft& draft) {
  std::vector<RigDescription::Socket>& sockets = draft.rig.sockets;
  for (std::size_t i = 0; i < sockets.size(); ++i) {
    ImGui::PushID(static_cast<int>(i));
    const bool stays = drawSocket(draft, sockets[i]);
    ImGui::PopID();
    if (stays) continue;
    sockets.erase(sockets.begin() + static_cast<std::ptrdiff_t>(i));
    draft.changed = true;
    break;
  }
  if (button("add a socket", sockets.size() < kMaxSockets)) {
    sockets.push_back(newSocket(draft.rig));
    draft.changed = true;
  }
  tip("A named place on the model, to which a game attaches things. It moves with the spline.");
}

}  // namespace kelp::view
