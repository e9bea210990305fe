// SPDX-License-Identifier: MIT
// What bench_trace draws: the scenes of the paper's Table 1 at its sizes, from files, voxelized by
// kelp::bake.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "kelp/fields/fields.h"

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
  bool figure6 = false;  // also posed as in Figure 6
};

// The names that makeScene takes.
std::vector<std::string> sceneNames();

// Throws std::exception with a line that says which file is absent or bad.
Scene makeScene(const std::string& name, const std::filesystem::path& models,
                const std::filesystem::path& assets, int threads);

}  // namespace kelp::bench
