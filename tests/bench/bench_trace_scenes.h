// SPDX-License-Identifier: MIT
// The scenes of bench_trace: those of the paper's Table 1 at its sizes, and models that bend by an angle in
// both maps. From files, voxelized by kelp::bake, or made.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "kelp/fields/fields.h"
#include "kelp/formats/spline.h"

namespace kelp::bench {

// A voxel volume with what kelp traces, standing somewhere in the scene. World units are voxels.
struct Item {
  std::string name;
  fields::Occupancy volume;
  RawLevel level;
  glm::dmat4 to_world{1};  // of part space; rigid
};

struct Scene {
  std::string name;
  std::string size;  // of the volumes, in words
  std::vector<Item> items;
  Bend bend = Bend::kShear;
  bool caged = false;
  enum class Poses {
    kSines,    // tangents that swing
    kFigure6,  // these, and the paper's Figure 6
    kAngles,   // bent by angles; swept parts also curled
  } poses = Poses::kSines;
};

// The ending of the names of swept scenes; without it, the same models sheared.
inline constexpr char kSweptEnding[] = " swept";
// And of those in cages.
inline constexpr char kCagedEnding[] = " caged";
inline constexpr int kCageCell = 8;  // side of their cells, voxels

// The names that makeScene takes.
std::vector<std::string> sceneNames();

// Throws std::exception with a line that says which file is absent or bad.
Scene makeScene(const std::string& name, const std::filesystem::path& models,
                const std::filesystem::path& assets, int threads);

}  // namespace kelp::bench
