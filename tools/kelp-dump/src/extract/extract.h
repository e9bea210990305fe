// SPDX-License-Identifier: MIT
// `extract`: a pack's voxels in formats of other programs. Each format has a file, and all get the same
// request.
#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "pack/level_voxels.h"
#include "pack/pack_file.h"

namespace kelp::dump {

struct ExtractRequest {
  PackFile& file;
  std::vector<std::uint32_t> parts;  // at least one
  // Of parts that have fewer: their coarsest. For --npy, also one of those that only the distances have.
  int level = 0;
  std::string output;
  double error = kProxyError;  // of proxies, in voxels

  static constexpr double kProxyError = 1.5;

  const Part& part(std::uint32_t index) const { return file.pack().parts()[index]; }
  bool fog(std::uint32_t index) const { return part(index).kind == PartKind::kFog; }
  LevelVoxels read(std::uint32_t index) const;
};

// A line to stderr about what the format could not hold: "kelp-dump: reed.kelp: ...".
void note(const ExtractRequest& request, const std::string& text);

// For parts that bend: says which rig to bake the file with, unless plain `kelp-dump rig` prints it.
// `file_to_object` maps the file's axes to the object's.
void noteRigs(const ExtractRequest& request, const std::vector<std::uint32_t>& parts,
              const glm::dmat3& file_to_object);

// The solid parts, for formats that cannot hold fog. Says on stderr which parts are left out. ToolError
// kUnsupported if all are fog.
std::vector<std::uint32_t> solidParts(const ExtractRequest& request, const char* format);

// Creates the folder of the output, if it is not there, for `what` ("pictures"). ToolError kIo.
std::filesystem::path makeFolder(const std::string& output, const char* what);

// A file name for a part: without characters that are special to a shell or a file system, and unlike all
// names in `taken`.
std::string partFileName(std::string_view name, std::uint32_t index, std::set<std::string>& taken);

// Writes a format. not_built.cpp defines the writers of libraries that are not installed.
struct Writer {
  // Libraries that this build lacks. Empty if it can write the format.
  const char* needs = "";
  // Names it in messages when it goes to standard output ("a .vox file"). Null: it is written to files only.
  const char* shown_as = nullptr;
  void (*write)(const ExtractRequest&) = nullptr;
  // In place of `write`: another program does the work. Does not return.
  void (*handOver)(std::vector<std::string> arguments) = nullptr;
  // True if that program is installed.
  bool (*isThere)() = nullptr;
};
extern const Writer kVoxWriter, kProxyWriter, kNpyWriter, kVdbWriter, kNanoVdbWriter;

// MagicaVoxel, version 200, z up. Each part is one model, or several of 256 voxels a side. The scene graph
// places them.
void extractVox(const ExtractRequest& request);
// Closed, decimated surfaces in the object's space, meters: a file for each part.
void extractProxy(const ExtractRequest& request);
// A folder of NumPy arrays, three for each solid part: PART.occupancy.npy (uint8, axes z, y, x),
// PART.distance.npy (float32, voxels, negative inside, infinite beyond the band) and PART.gradient.npy
// (float32, a fourth axis of x, y, z).
void extractNpy(const ExtractRequest& request);
// OpenVDB, NanoVDB: level sets and densities as grids. Only built into kelp-dump-vdb.
void extractVdb(const ExtractRequest& request);
void extractNvdb(const ExtractRequest& request);

// Display color of a palette entry, 8 bits a channel, with its alpha.
struct Rgba {
  std::uint8_t r = 0, g = 0, b = 0, a = 0;
};
Rgba displayColor(const Material& material);

}  // namespace kelp::dump
