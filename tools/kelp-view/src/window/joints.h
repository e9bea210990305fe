// SPDX-License-Identifier: MIT
// Joints and chains over the picture, where the pose has them: a ring at each part's joint, a line to the
// part that it follows, and the centre line and the knots of swept parts.
#pragma once

#include "orbit_camera.h"
#include "part_look.h"

namespace kelp::view {

void drawJoints(const Model& model, const OrbitCamera& camera, Surface surface, const PartFocus& focus);

}  // namespace kelp::view
