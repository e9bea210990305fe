// SPDX-License-Identifier: MIT
// Which nodes of a glTF file become which parts, and whose animations move them.
#pragma once

#include "import_gltf_model.h"

namespace kelp::bake {

struct PartPlan {
  int node = -1;             // whose part it is; -1: of all that belongs to no other
  int parent = -1;           // the plan whose motion it follows; comes before this one
  int mover = -1;            // the node whose animations move it, in that node's pivot; -1: none. Always at or above `node`, below the parent's
  std::optional<GltfRig> rig;
  std::vector<int> knots;
  std::vector<int> members;  // nodes whose meshes it holds; none: it is there for its motion
  bool rigid = false;        // no rig bends it: its own space keeps the object's lengths, whatever scales its nodes have
};

// Parts::kOne: nodes with rigs with their subtrees, and one of the rest. With `single`, the whole file is one part.
std::vector<PartPlan> planByRigs(const GltfModel& model, bool single);

// Parts::kNodes. A rig binds the meshes below its node to one part, but not those that animations move. Every other node with a mesh is a part
// that follows the nearest part above it. A part has one motion: where several animated nodes lie between a part and the next one above,
// those that have no mesh become parts of a single voxel too small to be seen, so that what nodes do one after the other stays exact.
std::vector<PartPlan> planByNodes(const GltfModel& model, const std::vector<GltfAnimation>& animations);

// A skinned mesh stands where its joints are: the nearest node that all of them belong to. -1: they have none in common.
int skinAnchor(const GltfModel& model, int skin);

// Says what animations do that no clip holds. `used`: of each animation's channels, those that a clip has. `single`: a rig for the whole file came from outside.
void noteUnusedMotion(const GltfModel& model, const std::vector<GltfAnimation>& animations, const std::vector<std::vector<bool>>& used, Parts parts, bool single);

}  // namespace kelp::bake
