// SPDX-License-Identifier: MIT
#include "window/part_list.h"

#include <algorithm>
#include <cstdio>

#include <imgui.h>

#include "kelp/common/part_colors.h"

namespace kelp::view {
namespace {

constexpr int kMostRows = 12;   // of a list; a longer one scrolls
constexpr int kNumberRows = 4;  // for the numbers of a part, so that the panel does not jump

ImU32 toImGui(const glm::u8vec3& color) { return IM_COL32(color.r, color.g, color.b, 255); }

void drawSizes(const Model& model) {
  const std::span<const Part> parts = model.asset().pack().parts();
  for (int i = 0; i < static_cast<int>(parts.size()); ++i) {
    const Part& part = parts[static_cast<std::size_t>(i)];
    if (part.kind == PartKind::kEmpty) continue;
    ImGui::Text("%.*s: %d x %d x %d, level %d of 0..%d", static_cast<int>(part.name.size()), part.name.data(),
                part.size.x, part.size.y, part.size.z, model.asset().residentLevel(i), part.levels - 1);
  }
}

// A square of its colour, its name, and on the right whether it is swept, or how closely it follows.
void drawRow(const Model& model, Surface surface, int index, PartFocus& focus) {
  const Part& part = model.asset().pack().parts()[static_cast<std::size_t>(index)];
  ImGui::PushID(index);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float height = ImGui::GetTextLineHeight(), width = ImGui::GetContentRegionAvail().x;
  if (ImGui::Selectable("##part", index == focus.chosen)) focus.chosen = index == focus.chosen ? -1 : index;
  if (ImGui::IsItemHovered()) focus.pointed = index;
  ImDrawList* const list = ImGui::GetWindowDrawList();
  list->AddRectFilled({at.x + 1, at.y + 1}, {at.x + height - 1, at.y + height - 1},
                      toImGui(colorOf(model, surface, index)));
  const ImU32 ink = ImGui::GetColorU32(ImGuiCol_Text);
  list->AddText({at.x + height + 6, at.y}, ink, part.name.data(), part.name.data() + part.name.size());
  char right[32] = "";
  const auto& fit = model.skin()[static_cast<std::size_t>(index)].fit;
  if (surface == Surface::kFit)
    std::snprintf(right, sizeof right, fit ? "%.2f" : "-", fit ? fit->p95 : 0);
  else if (isSwept(model, index))
    std::snprintf(right, sizeof right, "swept, %d", static_cast<int>(part.knots.size()));
  list->AddText({at.x + width - ImGui::CalcTextSize(right).x - 4, at.y}, ink, right);
  ImGui::PopID();
}

// Green to red with its numbers; a mark where the part is.
void drawFitScale(const std::optional<PartFit>& marked) {
  ImDrawList* const list = ImGui::GetWindowDrawList();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x, line = ImGui::GetTextLineHeight();
  const float bar = 12, middle = at.x + 0.5f * width;
  const auto color = [](double share) { return toImGui(fitColor(share * kPoorFit)); };
  list->AddRectFilledMultiColor(at, {middle, at.y + bar}, color(0), color(0.5), color(0.5), color(0));
  list->AddRectFilledMultiColor({middle, at.y}, {at.x + width, at.y + bar}, color(0.5), color(1), color(1),
                                color(0.5));
  if (marked) {
    const float x = at.x + width * static_cast<float>(std::min(marked->p95 / kPoorFit, 1.0));
    list->AddRectFilled({x - 2.5f, at.y - 2}, {x + 2.5f, at.y + bar + 2}, IM_COL32(0, 0, 0, 255));
    list->AddRectFilled({x - 1, at.y - 1}, {x + 1, at.y + bar + 1}, IM_COL32(255, 255, 255, 255));
  }
  char half[16], most[32];
  std::snprintf(half, sizeof half, "%g", 0.5 * kPoorFit);
  std::snprintf(most, sizeof most, "%g voxels and more", kPoorFit);
  const ImU32 ink = ImGui::GetColorU32(ImGuiCol_Text);
  const float below = at.y + bar + 2;
  list->AddText({at.x, below}, ink, "0");
  list->AddText({middle - 0.5f * ImGui::CalcTextSize(half).x, below}, ink, half);
  list->AddText({at.x + width - ImGui::CalcTextSize(most).x, below}, ink, most);
  ImGui::Dummy({width, bar + line + 2});
}

}  // namespace

void drawPartList(const Stage& stage, PartFocus& focus) {
  const Model& model = *stage.model();
  const int parts = static_cast<int>(model.skin().size());
  if (ImGui::GetIO().WantCaptureMouse) focus.pointed = -1;  // the mouse is not in the picture
  const bool scrolls = parts > kMostRows;
  if (scrolls) ImGui::BeginChild("parts", {0, kMostRows * ImGui::GetTextLineHeightWithSpacing()});
  if (!showsParts(stage.surface())) {
    ImGui::PushTextWrapPos(0);
    drawSizes(model);
    ImGui::PopTextWrapPos();
  } else {
    for (int i = 0; i < parts; ++i) drawRow(model, stage.surface(), i, focus);
  }
  if (scrolls) ImGui::EndChild();
}

void drawPartNumbers(const Stage& stage, const PartFocus& focus) {
  if (!showsParts(stage.surface())) return;
  const Model& model = *stage.model();
  const int part = focus.part();
  if (stage.surface() == Surface::kFit) {
    ImGui::TextDisabled("95 %% of a part's surface is within:");
    drawFitScale(part >= 0 ? model.skin()[static_cast<std::size_t>(part)].fit : std::nullopt);
    if (!knowsFit(model.skin())) ImGui::TextUnformatted(kNoFit);
  }
  ImGui::BeginChild("numbers", {0, kNumberRows * ImGui::GetTextLineHeightWithSpacing()});
  ImGui::PushTextWrapPos(0);
  if (part < 0) ImGui::TextDisabled("point at a part for its numbers; click it to keep them");
  if (part >= 0) {
    for (const std::string& line : describePart(model, part)) ImGui::TextUnformatted(line.c_str());
  }
  ImGui::PopTextWrapPos();
  ImGui::EndChild();
}

}  // namespace kelp::view
