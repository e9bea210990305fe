// SPDX-License-Identifier: MIT
// From a skin to a cage: a mesh that bends by joints and morph targets becomes one part whose cage follows
// them, each of which is an empty part.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "kelp/common/progress.h"
#include "kelp/import/core/frame.h"
#include "kelp/import/core/source_model.h"

namespace kelp::bake {

// How far the cage is from linear blend skinning, in voxels: at 12 moments of a clip, weighted by area, at
// points of the surface that the weights were not chosen for. A point has the weights that are interpolated
// between its triangle's corners; long triangles, drawn flat, cut off the bends that this makes.
struct SkinDistances {
  double mean = 0, p95 = 0, max = 0;
};

struct SkinFit {
  std::string clip;  // or morph target: its weight is 1, where it or the cage moves the surface
  SkinDistances distances;
  std::string joint;  // that moves the surface most where the distance is greatest
};

// An empty part that moves as a joint does.
struct SkinJoint {
  std::string name;       // joints of one name are told apart: "joint.2"
  int parent = -1;        // an earlier joint
  glm::dmat4x3 pivot{1};  // pivot space -> the soup's
  RigDescription rig;     // a clip for each of the skin's, in their order; sockets
  // Layers of voxels by which its box is longer than the body's, below and above along y: sockets lie there.
  glm::ivec2 grow{0};
};

// An empty part whose translation along x is the weight of a morph target.
struct SkinMorph {
  std::string name;    // as in the file: joints and other morph targets may have it, too
  RawMorph moves;      // its `part` is not set
  RigDescription rig;  // a clip for each of the skin's that moves it
  SkinFit fit;
};

struct SkinCage {
  int cell = 0;  // side of the finest cells
  std::vector<RawCage> cages;
  std::vector<Influences> influences;  // of the finest cage's nodes; their `parts` are joints
  std::vector<SkinJoint> joints;       // of the skin, all of them
  std::vector<SkinMorph> morphs;       // those that move a node
  std::vector<SkinFit> fits;           // of each clip
  std::vector<std::string> notices;
};

// Takes joints away until there are at most `most`: first those that move nothing; then, with a notice, those
// that move least, whose vertices and sockets follow the nearest joint above that is kept.
void limitJoints(SourceSkin& skin, std::size_t most, std::vector<std::string>& notices);

// Takes morph targets away, those that move least, until there are at most `most`. A notice says so.
void limitMorphs(SourceSkin& skin, std::size_t most, std::vector<std::string>& notices);

// The cage of a soup that bends by joints, and its joints as parts. `whole`: its voxels, which are in
// `frame`. cell: side of the finest cells, 2, 4, 8 or 16; 0: the largest with which the cage follows the skin
// in every clip, and each morph target, as well as pictures need: 0.3 voxels in the mean, 1 at 95 % of the
// surface. The same result with any number of threads. ToolError kInterrupted if `progress`, told 0 to 1 in
// "skin", asks to stop.
SkinCage cageOfSkin(const TriangleSoup& soup, const SourceSkin& skin, const Frame& frame,
                    const VoxelGrid& whole, int cell, int levels, int threads, const Progress& progress);

// Bytes that cageOfSkin needs beside its arguments and its result, for a box of so many voxels.
double skinBytes(double voxels, const SourceSkin& skin);

}  // namespace kelp::bake
