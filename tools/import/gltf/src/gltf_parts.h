// SPDX-License-Identifier: MIT
// Which nodes of a glTF file become which parts, and whose animations move them.
#pragma once

#include "gltf_model.h"

namespace kelp::bake {

struct PartPlan {
  int node = -1;    // the node of the part; -1: the part of everything that belongs to no other
  int parent = -1;  // the plan whose motion it follows, an earlier one; -1: none
  // the node whose animations move it, in that node's pivot: `node` or one above it, below the parent's; -1:
  // none
  int mover = -1;
  std::optional<GltfRig> rig;
  std::vector<int> knots;
  std::vector<int> sockets;  // empties
  std::vector<int> members;  // the nodes whose meshes it holds; empty: the part exists only for its motion
  // no rig bends it: its space has the object's lengths, whatever scales its nodes have
  bool rigid = false;
};

// The plan of Parts::kOne: each node with a rig, with its subtree, and one part of the rest. With `single`,
// the whole file is one part.
std::vector<PartPlan> planByRigs(const GltfModel& model, bool single);

// The plan of Parts::kNodes. A rig takes the meshes below its node into one part, except those that
// animations move. Every other node with a mesh is a part that follows the nearest part above it. A pack
// stores one motion for each part. So where several animated nodes lie between a part and the next one above,
// those without a mesh become empty parts. Then motions one after the other stay exact.
std::vector<PartPlan> planByNodes(const GltfModel& model, const std::vector<GltfAnimation>& animations);

// The node's place and rotation in the object. Scale, shear and mirroring go into the triangles, so that
// voxels are cubes. Skins ignore the place of their node.
glm::dmat4 rigidSpace(const GltfModel& model, int node);
// The world of the parent, then the node's own place and rotation at rest: here its animated translation,
// rotation and scale act. Node -1: the identity.
glm::dmat4 pivotOf(const GltfModel& model, int node);

// The nearest node above all joints of a skin, which places a skinned mesh. -1: they have none in common.
int skinAnchor(const GltfModel& model, int skin);

// Makes notices of what animations move and no clip holds. `used`: for each channel of each animation,
// whether a clip has it. `single`: a rig for the whole file came from outside.
void noteUnusedMotion(const GltfModel& model, const std::vector<GltfAnimation>& animations,
                      const std::vector<std::vector<bool>>& used, Parts parts, bool single);

}  // namespace kelp::bake
