// SPDX-License-Identifier: MIT
#include "window/rig_panel.h"

#include <algorithm>
#include <cstdio>

#include <imgui.h>

#include "window/panel.h"
#include "window/rig_controls.h"

namespace kelp::view {
namespace {

const char* const kAxes[] = {"+x", "-x", "+y", "-y", "+z", "-z"};

void drawHead(RigPanel& panel, RigEditor& editor, const std::function<void()>& save) {
  if (editor.parts() > 1) {
    ImGui::SetNextItemWidth(200);
    if (ImGui::BeginCombo("part", editor.name(panel.part).c_str())) {
      for (int i = 0; i < editor.parts(); ++i) {
        if (ImGui::Selectable((editor.name(i) + "##" + std::to_string(i)).c_str(), i == panel.part))
          panel.part = i;
      }
      ImGui::EndCombo();
    }
  }
  if (button("Undo", editor.canUndo())) editor.undo();
  ImGui::SameLine();
  if (button("Redo", editor.canRedo())) editor.redo();
  ImGui::SameLine();
  if (ImGui::Button("Reset")) editor.reset(panel.part);
  tip("Goes back to the rig that the pack has.");
  ImGui::SameLine();
  if (ImGui::Button("Save rig")) save();
  ImGui::SameLine();
  if (editor.unsaved(panel.part))
    ImGui::TextColored(kUnsaved, "not saved");
  else
    ImGui::TextDisabled("nothing to save");
  char path[1024];
  std::snprintf(path, sizeof path, "%s", panel.path.c_str());
  ImGui::SetNextItemWidth(-1);
  if (ImGui::InputText("##path", path, sizeof path)) panel.path = path;
  tip("The file that Save rig writes, for kelp-bake --rig. It keeps the rigs of other parts.");
}

}  // namespace

void drawRigPanel(RigPanel& panel, RigEditor& editor, double now, const std::function<void()>& save) {
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({screen.x - 12, 12}, ImGuiCond_FirstUseEver, {1, 0});
  ImGui::SetNextWindowSize({380, std::max(screen.y - 24, 200.0f)}, ImGuiCond_FirstUseEver);
  bool open = true;
  if (ImGui::Begin("rig", &open)) {
    drawHead(panel, editor, save);
    ImGui::PushTextWrapPos(0);
    if (!panel.said.empty()) ImGui::TextColored(panel.refused ? kBad : kGood, "%s", panel.said.c_str());
    if (const std::string& trouble = editor.axes(panel.part).trouble; !trouble.empty())
      ImGui::TextDisabled("%s", trouble.c_str());
    ImGui::PopTextWrapPos();

    ImGui::BeginChild("rest");
    Draft draft{editor.rig(panel.part)};
    drawBend(draft);
    if (ImGui::CollapsingHeader("Knots", ImGuiTreeNodeFlags_DefaultOpen)) {
      ImGui::TextDisabled("along %s of the %s, 1 = its length there",
                          kAxes[static_cast<int>(draft.rig.axis.value_or(Axis::kPlusY))],
                          editor.rigged().by_part ? "part's node" : "file");
      for (int knot = 0; knot < static_cast<int>(draft.rig.knots.size()); ++knot) drawKnot(draft, knot);
    }
    if (ImGui::CollapsingHeader("Sockets")) drawSockets(draft);
    if (ImGui::CollapsingHeader("Clips", ImGuiTreeNodeFlags_DefaultOpen)) {
      drawClipChoice(draft, panel.clips);
      if (!draft.rig.clips.empty() && panel.clips.clip < static_cast<int>(draft.rig.clips.size()))
        drawClip(draft, panel.clips, now);
    }
    ImGui::EndChild();
    if (draft.changed) {
      panel.said = editor.change(panel.part, draft.rig);
      panel.refused = !panel.said.empty();
    }
  }
  ImGui::End();
  panel.closed = !open;
}

}  // namespace kelp::view
