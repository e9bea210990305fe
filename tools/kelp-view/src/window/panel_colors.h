// SPDX-License-Identifier: MIT
#pragma once

#include <imgui.h>

namespace kelp::view {

inline const ImVec4 kBad{1, 0.45f, 0.4f, 1}, kGood{0.55f, 0.85f, 0.5f, 1}, kUnsaved{1, 0.8f, 0.3f, 1};

}  // namespace kelp::view
