// SPDX-License-Identifier: MIT
// Settings of the importers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "kelp/rig/rig.h"

namespace kelp::bake {

// The choice of parts. kOne: each node with a rig, with its subtree, and one part of all the rest. kNodes:
// every node with a mesh that no rig bends; animations of nodes become clips.
enum class Parts : std::uint8_t { kOne, kNodes };

// The kind of a volume. kAuto: level sets and masks are solid, and any grid with an isovalue; densities are
// fog.
enum class VolumeKind : std::uint8_t { kAuto, kSolid, kFog };

// The name, beside those of presets, that asks for the file's own skin as the rig.
inline constexpr char kSkinRig[] = "skin";

// A moment of one of the file's animations.
struct Moment {
  std::string clip;
  double seconds = 0;  // at least 0; after the last key its values hold
};

struct ImportSettings {
  // voxels along the longest side of the largest part; ignored if voxel_size is set
  int resolution = 128;
  // the user asked for the resolution: volumes, which have their own voxels, are resampled to it
  bool resolution_given = false;
  // meters, after `unit`. .vox and .binvox keep their voxels: for them, how large a voxel is
  std::optional<double> voxel_size;
  std::optional<Axis> axis;  // for rigs that name none; absent: `up`
  std::optional<Axis> up;    // the file's axis that points up, the object's +y; absent: +y
  double unit = 1;           // meters to a unit of the file, 1e-6 to 1e6
  // empty voxels on every side of a part, 0 to 1024; none along the axis of a part that bends
  int pad = 0;
  std::optional<std::filesystem::path> rig_file;
  std::optional<std::string> rig_preset;
  std::optional<Bend> bend;  // of solid parts whose rig does not say; kDefaultBend if absent
  bool caged = false;        // such parts get cages; `bend` is kSweep then
  // of a glTF file: its index, or else its name; absent: the file's default scene
  std::optional<std::string> scene;
  Parts parts = Parts::kOne;
  // glTF: bake surfaces too that viewers cull all around, as outlines for toon shading
  bool keep_culled = false;
  // bake nodes, skins and morph targets as they are at this moment; clips start from it
  std::optional<Moment> at;
  VolumeKind volume = VolumeKind::kAuto;
  std::optional<std::string> grid;  // of a volume file with several: its name, or else its index
  // the Vec3 grid that colors a solid; absent: Cd or color if there is one
  std::optional<std::string> color_grid;
  // the grid that makes fog glow; absent: flame, flames, heat or temperature if there is one; empty: none
  std::optional<std::string> heat_grid;
  // the value at the surface of a solid; absent: 0 for level sets, half the greatest value for others
  std::optional<double> isovalue;
  double density = 1;  // factor on the densities of fog, > 0
  // a palette of the colors that fog glows in, cold to hot; absent: those of a black body
  std::optional<std::filesystem::path> ramp_file;
  std::optional<int> frame;      // of a MagicaVoxel animation; absent: the first
  int threads = 0;               // 0: all
  std::uint64_t max_memory = 0;  // bytes; 0: the machine's physical memory
};

}  // namespace kelp::bake
