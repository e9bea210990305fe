// SPDX-License-Identifier: MIT
// `extract`: a pack's voxels in formats of other programs. One file each; all of them get the same request.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pack_file.h"
#include "level_voxels.h"

namespace kelp::dump {

struct ExtractRequest {
  PackFile& file;
  std::vector<std::uint32_t> parts;  // at least one
  int level = 0;                     // of parts that have fewer: their coarsest
  std::string output;

  const Part& part(std::uint32_t index) const { return file.pack().parts()[index]; }
  bool fog(std::uint32_t index) const { return part(index).kind == PartKind::kFog; }
  LevelVoxels read(std::uint32_t index) const;
};

// A line to stderr, for what the user should know though it went well: "kelp-dump: reed.kelp: ...".
void note(const ExtractRequest& request, const std::string& text);

// Says how the rigs of the parts that bend come along, where `kelp-dump rig` as such is not the answer. `file_to_object` turns the file's axes to the object's.
void noteRigs(const ExtractRequest& request, const std::vector<std::uint32_t>& parts, const glm::dmat3& file_to_object);

// The parts that are solid: what surfaces are made of. DumpError (kUnsupported) if none is; says which ones are left out.
std::vector<std::uint32_t> solidParts(const ExtractRequest& request, const char* format);

// A format, and what writes it. Which of several sources defines a writer says what this program was built with: extract_vdb.cpp, vdb_program.cpp, without_vdb.cpp.
struct Writer {
  const char* name;                                           // of the option, too
  const char* needs;                                          // the libraries that were missing, where nothing below is there
  const char* shown_as = nullptr;                             // what goes to standard output ("a binary PLY"); null: it can not go there
  void (*write)(const ExtractRequest&) = nullptr;
  void (*handOver)(std::vector<std::string> arguments) = nullptr;  // in place of `write`: another program does it; does not come back
  bool (*isThere)() = nullptr;                                // whether that one is
};
extern const Writer kVoxWriter, kPlyWriter, kSlicesWriter, kVdbWriter, kNanoVdbWriter;

// MagicaVoxel, version 200: a model for each part, or several of 256 voxels a side, placed by the scene graph; z up.
void extractVox(const ExtractRequest& request);
// Binary PLY: the faces between solid and empty voxels as quads, in the object's space, metres.
void extractPly(const ExtractRequest& request);
// A folder of PNGs, one for each layer across the spline.
void extractSlices(const ExtractRequest& request);
// OpenVDB, NanoVDB: level sets and densities as grids. Built into kelp-dump-vdb alone.
void extractVdb(const ExtractRequest& request);
void extractNvdb(const ExtractRequest& request);

// Display colour of a palette entry, 8 bits a channel, with its alpha.
struct Rgba {
  std::uint8_t r = 0, g = 0, b = 0, a = 0;
};
Rgba displayColor(const Material& material);

}  // namespace kelp::dump
