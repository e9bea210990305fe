// SPDX-License-Identifier: MIT
// Many awkward rays through caged parts: cage_walk.glsl and cage_tree.glsl, compiled as C++, judged by the
// ground truth.
#pragma once

#include <functional>
#include <memory>

#include "kelp/formats/cage.h"
#include "reference/trials.h"

namespace kelp::reference {

// A level of a volume in its cage, with the coarser one that is seen through it.
struct CagedVolume {
  std::string name;
  glm::ivec3 size{0};  // of level 0
  int level = 0;
  std::vector<RawCage> sources;  // finest first; the last one is that of the level
  std::vector<std::unique_ptr<CageMemory>> memories;
  std::vector<Cage> cages;
  std::vector<fields::Occupancy> voxels;  // of the level and the coarser ones
  std::vector<RawLevel> levels;
  bool lost = false;  // bricks are missing, also of coarser levels

  const Cage& cage() const { return cages.back(); }
};
// cell: side of the finest cage's cells, voxels. `lost`: every other brick is missing.
CagedVolume cagedVolume(std::string name, const fields::Occupancy& volume, int cell, int level = 0,
                        bool lost = false);

struct CagePose {
  std::string name;
  std::function<glm::dvec3(const glm::dvec3& rest)> map;  // voxels
  // Nodes are moved by up to half of this along each axis, in sides of a cell.
  double shaken = 0;
};
// At rest but not at round numbers; sheared as in Figure 6; bent by 90 degrees; twisted by 360 from end to
// end; 1.5 times as large; squeezed.
std::vector<CagePose> namedCagePoses(const glm::ivec3& size);
CagePose shakenPose(double shaken);

struct CageTally : TrialTally {
  std::uint64_t inverted = 0;  // tetrahedra
  std::uint64_t tetrahedra = 0;
  int most_tetrahedra = 0;
  std::uint64_t inside = 0;  // rays that began where no cell is

  void add(const CageTally& more);
};
struct CageTallies {
  CageTally traced, walked;  // by kelpTraceCaged, by kelpWalkCaged
  CageTally aimed;           // walked, of rays that are aimed at nodes, edges and faces of tetrahedra
};
// Rays of every kind: past solid voxels; through a node, an edge, a face; within a face, along an edge; along
// an axis; within a face of voxels; from 30 sizes of the bounds away; from inside cells, and where no cell
// is. Walks begin outside.
inline constexpr int kCageRayKinds = 11;
CageTallies runCageTrial(const CagedVolume& volume, const CagePose& pose, int rays, unsigned seed);

}  // namespace kelp::reference
