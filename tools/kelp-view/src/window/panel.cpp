// SPDX-License-Identifier: MIT
#include "window/panel.h"

#include <algorithm>

#include <imgui.h>

namespace kelp::view {
namespace {

constexpr ImU32 kSpline = IM_COL32(255, 255, 255, 150);
constexpr ImU32 kSocketAxes[] = {IM_COL32(235, 80, 80, 255), IM_COL32(90, 210, 90, 255),
                                 IM_COL32(90, 130, 255, 255)};
constexpr ImU32 kSocketName = IM_COL32(255, 255, 255, 230);
constexpr ImU32 kKnot = IM_COL32(255, 200, 60, 255);
constexpr ImU32 kTangent = IM_COL32(90, 200, 255, 255);
constexpr ImU32 kLit = IM_COL32(255, 255, 255, 255);

ImVec2 toImGui(const glm::vec2& v) { return {v.x, v.y}; }

void drawClips(Model& model, Choices& choices) {
  const std::span<const Clip> clips = model.clips();
  if (clips.empty()) return ImGui::TextDisabled("no clips; to make one: E, then 'new clip'");
  if (ImGui::Button(choices.play ? "Pause" : "Play")) choices.play = !choices.play;
  ImGui::SameLine();
  ImGui::Text("%.2f s", choices.seconds);
  for (std::size_t i = 0; i < clips.size(); ++i) {
    const std::string name = std::string(clips[i].name) + "###clip" + std::to_string(i);
    ImGui::SliderFloat(name.c_str(), &model.clipWeights()[i], 0, 2, "%.2f");
  }
}

void drawParts(const Model& model) {
  const std::span<const Part> parts = model.asset().pack().parts();
  constexpr std::size_t kMostLines = 12;
  for (std::size_t i = 0; i < std::min(parts.size(), kMostLines); ++i) {
    const Part& part = parts[i];
    if (part.kind == PartKind::kEmpty) continue;
    const std::optional<int> level = model.asset().residentLevel(static_cast<int>(i));
    ImGui::Text("%.*s: %d x %d x %d, level %s of 0..%d", static_cast<int>(part.name.size()), part.name.data(),
                part.size.x, part.size.y, part.size.z, level ? std::to_string(*level).c_str() : "none",
                part.levels - 1);
  }
  if (parts.size() > kMostLines)
    ImGui::Text("... and %d more parts", static_cast<int>(parts.size() - kMostLines));
}

void drawSurface(Stage& stage, Choices& choices, std::string& wrong) {
  if (ImGui::BeginCombo("colors", toString(stage.surface()))) {
    for (int i = 0; i < static_cast<int>(Surface::kCount); ++i) {
      const auto surface = static_cast<Surface>(i);
      if (ImGui::Selectable(toString(surface), surface == stage.surface()) && surface != stage.surface())
        wrong = stage.paint(surface);
    }
    ImGui::EndCombo();
  }
  ImGui::SliderFloat("pixels/voxel", &choices.pixels_per_voxel, 0, 40, "%.1f", ImGuiSliderFlags_Logarithmic);
}

void drawBake(const Workshop& workshop) {
  if (workshop.baking()) {
    ImGui::ProgressBar(workshop.job().done(), {-1, 0}, workshop.job().stage().c_str());
    ImGui::TextDisabled("baking %s", workshop.order().source.c_str());
  } else if (!workshop.error().empty()) {
    ImGui::TextColored(kBad, "%s", workshop.error().c_str());
    ImGui::TextDisabled("bakes again when the file changes");
  } else {
    ImGui::TextDisabled("watching %s", workshop.order().source.c_str());
  }
  ImGui::Separator();
}

}  // namespace

void drawPanel(Stage& stage, Choices& choices, const std::optional<runtime::Hit>& under_mouse,
               Status& status) {
  ImGui::SetNextWindowPos({12, 12}, ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSizeConstraints({330, 0}, {330, 1e4f});  // as high as it needs to be
  ImGui::Begin("kelp", nullptr, ImGuiWindowFlags_AlwaysAutoResize);
  ImGui::PushTextWrapPos(0);
  if (status.workshop) drawBake(*status.workshop);
  if (Model* model = stage.model()) {
    ImGui::TextUnformatted(model->path().c_str());
    drawParts(*model);
    ImGui::Separator();
    drawClips(*model, choices);
    ImGui::Separator();
    ImGui::Checkbox("edit the rig (E)", &choices.edit);
    if (status.unsaved) {
      ImGui::SameLine();
      ImGui::TextColored(kUnsaved, "not saved");
    }
    ImGui::Checkbox("knots and tangents (H)", &choices.handles);
    if (model->edited()) {
      ImGui::SameLine();
      if (ImGui::Button("Reset")) model->forgetEdits();
    }
    ImGui::Separator();
    drawSurface(stage, choices, status.wrong);
    ImGui::Text("%.1f MiB on the GPU", static_cast<double>(stage.stats().gpu_bytes) / (1 << 20));
    if (under_mouse) {
      const glm::ivec3 v = under_mouse->voxel;
      ImGui::Text("voxel %d %d %d of part %d, color %d", v.x, v.y, v.z, under_mouse->part,
                  under_mouse->material);
    } else {
      ImGui::TextDisabled("no voxel under the mouse");
    }
    if (const std::string error = model->loadError(); !error.empty())
      ImGui::TextColored(kBad, "%s", error.c_str());
  } else if (!status.workshop) {
    ImGui::TextUnformatted("Drop a .kelp file here.");
  }
  if (!status.notice.empty()) ImGui::TextUnformatted(status.notice.c_str());
  if (!status.wrong.empty()) ImGui::TextColored(kBad, "%s", status.wrong.c_str());
  ImGui::TextDisabled(
      "drag: turn, or move a handle. right drag: move. wheel: zoom. F: fit. space: play. %s",
      choices.edit ? "ctrl Z, Y: undo, redo. ctrl S: save the rig." : "R: reset the handles.");
  ImGui::PopTextWrapPos();
  ImGui::End();
}

void drawHandles(const Model& model, const OrbitCamera& camera, const std::optional<Handle>& lit,
                 std::span<const RawSocket> sockets) {
  ImDrawList* const list = ImGui::GetBackgroundDrawList();
  const auto line = [&](const glm::vec3& a, const glm::vec3& b, ImU32 color, float width) {
    const std::optional<glm::vec2> from = camera.project(a), to = camera.project(b);
    if (from && to) list->AddLine(toImGui(*from), toImGui(*to), color, width);
  };
  for (int part = 0; part < static_cast<int>(model.asset().pack().parts().size()); ++part) {
    const std::vector<glm::vec3> spline = splineOf(model, part);
    for (std::size_t i = 1; i < spline.size(); ++i) line(spline[i - 1], spline[i], kSpline, 2);
  }
  for (const Handle& handle : handlesOf(model)) {
    const bool tangent = handle.kind == Handle::Kind::kTangent;
    const glm::vec3 at = position(model, handle);
    if (tangent) line(position(model, {handle.part, handle.knot, Handle::Kind::kKnot}), at, kTangent, 1.5f);
    const std::optional<glm::vec2> pixel = camera.project(at);
    if (!pixel) continue;
    const bool is_lit = lit && *lit == handle;
    list->AddCircleFilled(toImGui(*pixel),
                          is_lit    ? 8.0f
                          : tangent ? 5.0f
                                    : 6.0f,
                          is_lit    ? kLit
                          : tangent ? kTangent
                                    : kKnot);
    list->AddCircle(toImGui(*pixel), is_lit ? 8.0f : tangent ? 5.0f : 6.0f, IM_COL32(0, 0, 0, 160), 0, 1.5f);
  }
  for (const RawSocket& socket : sockets) {
    const glm::mat4 frame = socketFrame(model, socket);
    const glm::vec3 at(frame[3]);
    const Box box = bounds(model.instance());
    const float reach = 0.04f * glm::length(box.max - box.min);
    for (int axis = 0; axis < 3; ++axis) line(at, at + reach * glm::vec3(frame[axis]), kSocketAxes[axis], 2);
    if (const std::optional<glm::vec2> pixel = camera.project(at))
      list->AddText(toImGui(*pixel + glm::vec2(6, 4)), kSocketName, socket.name.c_str());
  }
}

}  // namespace kelp::view
