// SPDX-License-Identifier: MIT
// The results of a run, as a table and as JSON.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench_trace_gpu.h"

namespace kelp::bench {

// One method's figures in one view of one pose. Means are over the rays that meet the deformed box, all items
// together.
struct Record {
  std::string scene, size, pose, view;
  Bend bend = Bend::kShear;
  bool caged = false;
  int inverted = 0;  // tetrahedra
  bool moderate = false;
  Method method = Method::kKelp;
  std::uint64_t rays = 0, hits = 0;
  double steps_mean = 0, steps_max = 0, outside_mean = 0, fetches_mean = 0;
  // of rays compared with the ground truth
  std::uint64_t checked = 0, owed = 0, grazing = 0, missed = 0, false_hits = 0;
  std::uint64_t farther = 0;    // missed, but there is a hit behind
  std::uint64_t depth_off = 0;  // hits, not grazing, more than half a voxel from the truth
  double frame_ms = 0;
  // kelp only: rays for which the C++ build of trace.glsl answers otherwise or counts otherwise
  std::uint64_t cpp_differs = 0;
};

// One block for each scene and pose, averaged over the views; then, for each kind of bend, ratios of frame
// times, and of swept parts of steps too.
void printTable(const std::vector<Record>& records);
// An array with an object for each record. Throws std::runtime_error if the file cannot be written.
void writeJson(const std::vector<Record>& records, const std::string& machine,
               const std::filesystem::path& path);

}  // namespace kelp::bench
