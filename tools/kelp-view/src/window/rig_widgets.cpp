// SPDX-License-Identifier: MIT
#include "window/rig_controls.h"

#include <cstdio>

#include <imgui.h>

namespace kelp::view {

const char* const kTargetNames[5] = {"offset", "tangent", "translation", "rotation", "scale"};
const char* const kInterpolationNames[3] = {"step", "linear", "cubic"};

void tip(const char* text) {
  if (!ImGui::IsItemHovered()) return;
  ImGui::SetNextWindowPos({ImGui::GetWindowPos().x - 20, ImGui::GetItemRectMin().y}, ImGuiCond_Always,
                          {1, 0});
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(26 * ImGui::GetFontSize());
  ImGui::TextUnformatted(text);
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

bool button(const char* label, bool enabled) {
  if (!enabled) ImGui::BeginDisabled();
  const bool pressed = ImGui::Button(label);
  if (!enabled) ImGui::EndDisabled();
  return pressed && enabled;
}

bool choose(const char* label, int& index, const char* const* names, int count, float width) {
  ImGui::SetNextItemWidth(width);
  return ImGui::Combo(label, &index, names, count);
}

bool chooseKnot(const char* label, int& knot, std::size_t knots) {
  char shown[16];
  std::snprintf(shown, sizeof shown, "knot %d", knot);
  bool changed = false;
  ImGui::SetNextItemWidth(82);
  if (!ImGui::BeginCombo(label, shown)) return false;
  for (int i = 0; i < static_cast<int>(knots); ++i) {
    std::snprintf(shown, sizeof shown, "knot %d", i);
    if (ImGui::Selectable(shown, i == knot)) changed = knot != i, knot = i;
  }
  ImGui::EndCombo();
  return changed;
}

bool dragLengths(const char* label, glm::vec3& v) {
  ImGui::SetNextItemWidth(230);
  return ImGui::DragFloat3(label, &v.x, kLengthsPerPixel, -1e6f, 1e6f, "%.3f");
}

bool dragNumber(const char* label, float& v, float speed, float least, float most, const char* format) {
  ImGui::SetNextItemWidth(96);
  return ImGui::DragFloat(label, &v, speed, least, most, format, ImGuiSliderFlags_AlwaysClamp);
}

}  // namespace kelp::view
