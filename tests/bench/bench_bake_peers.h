// SPDX-License-Identifier: MIT
// The peers of bench_bake. Each of the optional ones is compiled in where its library was found, and answers
// an empty list of seconds otherwise.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "kelp/bake/bake.h"
#include "kelp/fields/fields.h"

namespace kelp::bench {

// A peer's distance transform: seconds of the transform alone, and its squared distances to the nearest set
// voxel (empty where it failed).
struct EdtRun {
  double seconds = 0;
  std::vector<float> squared;
};

// SignedMaurerDistanceMapImageFilter. Distances of set voxels are negative or 0.
bool haveItk();
EdtRun runItk(const fields::Occupancy& volume, int threads);
// seung-lab's edt.hpp, edtsq of the empty voxels.
bool haveSeungLab();
EdtRun runSeungLab(const fields::Occupancy& volume, int threads);
// scipy.ndimage.distance_transform_edt, in a process of its own that times itself. One thread, as it has no
// other.
bool haveScipy();
EdtRun runScipy(const fields::Occupancy& volume, const std::filesystem::path& scratch);

// meshToLevelSet of OpenVDB on the part's triangles, in the voxels of `frame`, 3 voxels to both sides, on
// `threads` threads.
struct LevelSetRun {
  double seconds = 0;
  // how it was written, and bytes; only if asked for
  std::vector<std::pair<std::string, std::uint64_t>> files;
};
LevelSetRun runMeshToLevelSet(const bake::TriangleSoup& soup, const bake::Frame& frame, int threads,
                              const std::filesystem::path* scratch);

// Writes a binary PLY file of the same surface in so many triangles (one less where that does not go), at
// least as many as there are.
void writeDivided(const bake::TriangleSoup& soup, std::size_t triangles, const std::filesystem::path& path);

}  // namespace kelp::bench
