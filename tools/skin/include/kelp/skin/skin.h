// SPDX-License-Identifier: MIT
// From a skin to parts: a mesh that bends by joints becomes parts that move as its surface moves. Most are
// rigid; some are swept along chains of joints.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "kelp/common/progress.h"
#include "kelp/import/core/frame.h"
#include "kelp/import/core/source_model.h"

namespace kelp::bake {

// How far parts are from the skinned surface, in voxels: at 12 moments of a clip, weighted by area.
struct SkinDistances {
  double mean = 0, p95 = 0, max = 0;
};

struct SkinPart {
  std::string name;     // of its joint; further parts of a joint: "joint.2"
  int parent = -1;      // an earlier part, -1: none
  glm::dvec3 pivot{0};  // what it turns about, in the soup's space; the pivot's axes are the soup's
  bool swept = false;   // along its rig's knots; else rigid
  // Rigid: the joint that it was made for, or those of its entry in the rig; swept: those of the chain.
  // Joints of one name are told apart: "joint.2".
  std::vector<std::string> joints;
  SkinDistances fit;   // in the clip in which it is worst; zeros without clips
  VoxelGrid grid;      // rigid: a box of the whole grid, with the same axes; swept: straightened
  RigDescription rig;  // knots, place on the parent's spline, a clip for each of the skin's in their order
};

struct SkinFit {
  std::string clip;
  SkinDistances distances;  // of all parts
  std::string joint;        // that moves the surface most where the distance is greatest
};

// How far a socket's part takes it from where its joint does, in voxels, in the clip in which that is most.
struct SocketFit {
  std::string socket, part, clip;
  double most = 0;
};

struct SkinParts {
  std::vector<SkinPart> parts;  // at least one
  // Of each joint of the skin: the parts that have it among their joints; ascending.
  std::vector<std::vector<std::uint32_t>> parts_of_joints;
  std::vector<SkinFit> fits;         // of each clip
  std::vector<SocketFit> sockets;    // of each of the skin's
  std::vector<std::string> notices;  // where the parts are not as the rig asks
};

// Throws if `part`, which has a skin, cannot be divided as its rig asks (RigDescription::skin, not empty).
// The RigError names the joint that the skin lacks, or that is not below the joint before it in a chain.
void checkSkinRig(const SourcePart& part);

// Divides `whole`, the voxels of `part` of the model in `frame`, among parts that follow its skin: those that
// follow it best, or those that `part.rig.skin` asks for, which checkSkinRig has accepted. Every
// solid voxel is in at least one part, and no part has others; straightened voxels are within one of their
// place. Each part also has some of its neighbors' voxels, so that bends stay closed. The same result with
// any number of threads. ToolError kInterrupted if `progress`, told 0 to 1 in "skin", asks to stop.
SkinParts divideSkin(const SourceModel& model, const SourcePart& part, const Frame& frame,
                     const VoxelGrid& whole, int threads, const Progress& progress);

// Bytes that divideSkin needs beside its arguments and its result, for a box of so many voxels.
double skinBytes(double voxels, std::size_t joints);

}  // namespace kelp::bake
