// SPDX-License-Identifier: MIT
// The rigs of a whole pack, and their axes in the file that the pack was made from.
#pragma once

#include <string>
#include <vector>

#include "kelp/formats/pack.h"
#include "kelp/rig/rig_file.h"

namespace kelp::view {

using Sizes = std::vector<glm::ivec3>;  // of each part, level-0 voxels
Sizes sizesOf(const Pack& pack);

// The contents of a pack's RIGS, CLIP and SOCK chunks.
struct PackRig {
  std::vector<RestRig> parts;
  std::vector<RawClip> clips;
  std::vector<RawSocket> sockets = {};
};
PackRig rigOf(const Pack& pack);
// True if they look the same: all numbers within 1/10000 of the part's height.
bool alike(const PackRig& a, const PackRig& b);

// Artists write the rig of a whole file in the axes of the file, in which the part may be turned; the rig of
// one of several parts in the axes of its node.
struct RigAxes {
  Axis axis = Axis::kPlusY;  // along which the spline runs there
  glm::mat3 turn{1};         // what realizeKnots() gives -> the part's axes; a turn about y
  // empty, or why kelp-bake --rig would bake another pack from this rig
  std::string trouble;
};
RigAxes axesOf(const Pack& pack, const RiggedPack& rigged, int part);

// The part's rig as an artist would write it: a tangent that follows from the neighbors is left automatic.
RigDescription describe(const PackRig& rig, int part, const RigAxes& axes);
// The inverse, of the descriptions of all parts. RigError for an invalid rig.
PackRig realize(const std::vector<RigDescription>& rigs, const std::vector<RigAxes>& axes);
// Proves what kelp-bake proves before it writes a pack: no spline turns back, at rest or in a clip. RigError
// says where one does.
void prove(const PackRig& rig, const Sizes& sizes);

}  // namespace kelp::view
