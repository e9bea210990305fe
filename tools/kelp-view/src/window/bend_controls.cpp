// SPDX-License-Identifier: MIT
#include "window/bend_controls.h"

#include <imgui.h>

#include "rig_knots.h"

namespace kelp::view {

void drawBend(Draft& draft) {
  constexpr const char* kBends[] = {"shear", "sweep"};  // as kelp::Bend
  int bend = static_cast<int>(draft.rig.bend.value_or(kDefaultBend));
  if (choose("bend", bend, kBends, 2, 82)) {
    bendAs(draft.rig, static_cast<Bend>(bend));
    draft.changed = true;
  }
  tip("shear: layers across the axis stay level, and the spline must rise. sweep: they stay perpendicular to "
      "the spline, which may turn back and curl.");
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
