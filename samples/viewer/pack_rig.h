// SPDX-License-Identifier: MIT
// The rigs of a whole pack in voxels, and how each stands in the axes of the file that it was made from.
#pragma once

#include <string>
#include <vector>

#include "kelp/formats/pack.h"
#include "kelp/rig_json/rig_json.h"

namespace viewer {

using Sizes = std::vector<glm::ivec3>;  // of each part, level-0 voxels
Sizes sizesOf(const kelp::Pack& pack);

// What RIGS and CLIP of a pack hold.
struct PackRig {
  std::vector<std::vector<kelp::Knot>> knots;  // of each part
  std::vector<kelp::RawClip> clips;
};
PackRig rigOf(const kelp::Pack& pack);
// Whether they look the same: numbers within a ten thousandth of the part's height.
bool alike(const PackRig& a, const PackRig& b, const Sizes& sizes);

// An artist writes a rig in the axes of the file; a part may be turned in it.
struct RigAxes {
  kelp::Axis axis = kelp::Axis::kPlusY;  // along which the spline runs in the file
  glm::mat3 turn{1};                     // what realizeKnots() gives -> the part's voxels; a turn about y
  std::string trouble;                   // why kelp-bake --rig would make another pack of the rig; empty: it makes the same
};
RigAxes axesOf(const kelp::Pack& pack, int part);

// The part's rig as an artist would have written it: tangents that are those of the neighbours are left automatic.
kelp::RigDescription describe(const PackRig& rig, const Sizes& sizes, int part, const RigAxes& axes);
// The way back: all parts' descriptions in voxels. RigError for what no rig may hold.
PackRig realize(const std::vector<kelp::RigDescription>& rigs, const Sizes& sizes, const std::vector<RigAxes>& axes);
// What kelp-bake proves before it writes a pack: no spline turns back, at rest or in a clip. RigError that says where.
void prove(const PackRig& rig, const Sizes& sizes);

}  // namespace viewer
