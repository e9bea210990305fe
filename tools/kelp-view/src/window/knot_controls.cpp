// SPDX-License-Identifier: MIT
#include "window/rig_controls.h"

#include <imgui.h>

#include "rig_knots.h"

namespace kelp::view {
namespace {

// From the part's axes to those of the file.
glm::mat3 toArtist(const RigDescription& rig) {
  return glm::transpose(axisRotation(rig.axis.value_or(Axis::kPlusY)));
}

}  // namespace

void drawKnot(Draft& draft, int index) {
  RigDescription::Knot& knot = draft.rig.knots[static_cast<std::size_t>(index)];
  const int count = static_cast<int>(draft.rig.knots.size());
  const bool inner = index > 0 && index + 1 < count;
  ImGui::PushID(index);
  ImGui::AlignTextToFramePadding();
  ImGui::TextColored({1, 0.78f, 0.24f, 1}, "knot %d", index);
  ImGui::SameLine(70);
  if (inner) {
    const float before = draft.rig.knots[static_cast<std::size_t>(index - 1)].at,
                after = draft.rig.knots[static_cast<std::size_t>(index + 1)].at;
    draft.changed |= dragNumber("at", knot.at, kLengthsPerPixel, before + 0.01f, after - 0.01f, "%.3f");
    tip("Where along the axis: 0 is the first knot, 1 the last.");
    ImGui::SameLine();
    if (ImGui::SmallButton("remove")) {
      removeKnot(draft.rig, index);
      draft.changed = true;
      ImGui::PopID();
      return;
    }
    tip("Removes the knot, and the waves and keys that move it.");
  } else {
    ImGui::TextDisabled("at %.0f", static_cast<double>(knot.at));
  }
  if (index + 1 < count && count < kMaxKnots) {
    ImGui::SameLine();
    if (ImGui::SmallButton("add next")) {
      insertKnot(draft.rig, index);
      draft.changed = true;
      ImGui::PopID();
      return;
    }
    tip("Adds a knot on the spline, half way to the next one.");
  }
  draft.changed |= dragLengths("offset", knot.offset);
  tip("How far the knot is from its place in the straight rig, in the file's axes. 1 is the model's length "
      "along "
      "the axis. Drag, or double-click and type.");
  glm::vec3 tangent = knot.tangent.value_or(glm::vec3(0));
  if (!knot.tangent) {  // show the automatic one; it is stored once the user drags it
    const std::vector<Knot> knots = realizeKnots(draft.rig);
    tangent = toArtist(draft.rig) * knots[static_cast<std::size_t>(index)].tangent;
  }
  if (dragLengths("tangent", tangent)) {
    knot.tangent = tangent;
    draft.changed = true;
  }
  tip("The direction and speed of the spline here. In a straight rig it has length 1 and points along the "
      "axis.");
  ImGui::SameLine();
  bool automatic = !knot.tangent;
  if (ImGui::Checkbox("auto", &automatic)) {
    knot.tangent = automatic ? std::optional<glm::vec3>() : tangent;
    draft.changed = true;
  }
  tip("Takes the tangent from the neighbors (Catmull-Rom).");
  ImGui::PopID();
}

void drawBend(Draft& draft) {
  constexpr const char* kBends[] = {"shear", "sweep", "cage"};  // as kelp::Bend, and one more
  constexpr int kCage = 2;
  int bend = draft.rig.caged ? kCage : static_cast<int>(draft.rig.bend.value_or(kDefaultBend));
  if (choose("bend", bend, kBends, 3, 82)) {
    bendAs(draft.rig, bend == kCage ? Bend::kSweep : static_cast<Bend>(bend), bend == kCage);
    draft.changed = true;
  }
  tip("shear: layers across the axis stay level, and the spline must rise. sweep: they stay perpendicular to "
      "the spline, which may turn back and curl. cage: as sweep, through a lattice of nodes; it is drawn "
      "so once the rig is saved and the model baked with it, as --watch does.");
  if (draft.rig.bend != Bend::kSweep) return;
  ImGui::SameLine();
  float roll = static_cast<float>(rollInDegrees(draft.rig.roll));
  if (dragNumber("roll", roll, 0.5f, -180, 180, "%.1f deg")) {
    draft.rig.roll = rollOfDegrees(static_cast<double>(roll));
    draft.changed = true;
  }
  tip("By how much the part is turned about its spline at the first knot, anticlockwise as seen from its "
      "end.");
}

}  // namespace kelp::view
