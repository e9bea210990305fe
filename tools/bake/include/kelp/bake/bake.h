// SPDX-License-Identifier: MIT
// The baker as a library: a file in, a pack out. Stages are functions from plain data to plain data, in the
// order of this header. Everything here throws ToolError, and nothing else; one boundary in tools/kelp-bake
// turns it into an exit code and a line.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "kelp/common/error.h"
#include "kelp/common/progress.h"
#include "kelp/formats/raw_pack.h"
#include "kelp/import/core/files_used.h"
#include "kelp/import/core/import_settings.h"
#include "kelp/import/core/source_model.h"
#include "kelp/import/import.h"
#include "kelp/voxelize/topology/fill_report.h"
#include "kelp/voxelize/voxelize.h"

namespace kelp::bake {

// What the user asks of a bake.
struct Settings : ImportSettings {
  Fill fill = Fill::kAuto;
  std::optional<std::filesystem::path> palette_file;  // its colours are the palette; see readPalette
  // no palette entry serves two of the file's materials; not with palette_file
  bool keep_materials = false;
  int levels = 0;  // 0: down to a single brick
};

// Seconds and numbers of a bake, for --report and the closing lines.
struct Report {
  struct Stage {
    std::string name;
    double seconds = 0;
    std::uint64_t peak_bytes = 0;  // the most memory that the program has held until this stage ended
  };
  struct Part {
    std::string name, rig_origin, fill;
    glm::ivec3 size{0};
    double voxel_size = 0;
    std::uint64_t triangles = 0, solid_voxels = 0, surface_voxels = 0, bricks = 0;
    bool fog = false;
    std::uint64_t fog_voxels = 0;  // that are not clear; a fog part has no solid_voxels
    bool closed = false;
    bool carrier = false;  // there for its motion alone
    MeshCounts mesh;       // zeros for volumes
    FillCounts repairs;
    std::string parent;                       // the part that it follows; empty: none
    std::vector<ComponentReport> components;  // empty for volumes
  };
  struct Clip {
    std::string name, part;
    float duration = 0, leaves_box = 0;
    bool bends = false, moves = false;  // moves its knots; moves it as a whole
  };
  std::string format;
  std::vector<Stage> stages;
  std::vector<Part> parts;
  std::vector<Clip> clips;
  std::vector<std::string> notices;
  FilesUsed files;
  std::uint64_t materials = 0, images = 0;  // that triangles use; pictures that could be had
  std::uint64_t palette_entries = 0;
  // with Settings::keep_materials, the material of each palette entry
  std::vector<std::string> palette_materials;
  // mean distance in OKLab between a surface voxel's colour and its palette entry
  double palette_error = 0;
  std::uint64_t estimated_bytes = 0;  // of memory, announced before the work
  std::uint64_t pack_bytes = 0;
  std::string pack_hash;  // of the pack's bytes, by Hash (kelp/common/hash.h)
};

// --- 1. palette ----------------------------------------------------------------------------------
// Base colours, linear, 1 to 256, of a palette that somebody painted: a GIMP palette (.gpl, in its order), or
// a picture (row by row from the top left, each colour once; what is transparent is no colour). ToolError kIo
// and kInvalid. Safe for hostile input.
std::vector<glm::vec3> readPalette(const std::filesystem::path& path, FilesUsed* used = nullptr);

struct PaletteRules {
  // of a file that is painted by index, if it is: kept as they are, each voxel has the one that
  // SurfaceSample::source names. Without `colors`
  std::vector<Material> entries;
  // the entries, in this order, if there are any: each voxel gets the nearest in OKLab. Gloss and glow are
  // means
  std::vector<glm::vec3> colors;
  bool keep_materials = false;  // samples of two sources never share an entry
  bool blends = false;          // of `entries`: SourceModel::palette_blends
};
struct Palette {
  std::vector<Material> entries;  // 1 to 256
  // with keep_materials or given entries that do not blend, SurfaceSample::source of each entry; else empty
  std::vector<std::uint32_t> sources;
  std::vector<std::vector<std::uint8_t>> indices;  // one list a grid, one index a surface sample
  double mean_error = 0;                           // OKLab
};
// ToolError kUnsupported where more materials than entries are to be kept apart.
Palette choosePalette(const std::vector<const VoxelGrid*>& grids, int threads,
                      const PaletteRules& rules = {});

// --- 2. pack -------------------------------------------------------------------------------------
// Occupancy, attributes and levels of one grid, which is used up: its arrays are the largest there are.
// `sources`: Palette::sources; coarse voxels then keep the material of most of their children.
std::vector<RawLevel> buildLevels(VoxelGrid grid, const std::vector<std::uint8_t>& palette_indices,
                                  const std::vector<Material>& palette, int levels, int threads,
                                  const Progress& progress, const std::vector<std::uint32_t>& sources = {});

// The same of fog. Heat is dropped where no sample of it is left.
std::vector<RawLevel> buildFogLevels(FogGrid grid, int levels, int threads, const Progress& progress);

// --- all of it -----------------------------------------------------------------------------------
// What of the settings cannot be: each a ToolError kUsage that names the option. bake() throws the first.
std::vector<ToolError> settingsFaults(const Settings& settings);
// Bakes a file to a pack in memory.
RawPack bake(const std::filesystem::path& input, const Settings& settings, Report& report,
             const Progress& progress = {});
// What a pack says of its making (INFO), and the files that were asked for it.
struct Recipe {
  std::string info;
  FilesUsed files;
};
// What is known before anything but the named files is read: two bakes of one input with the same answer read
// the same files, as far as those are the same.
Recipe recipeBefore(const std::filesystem::path& input, const Settings& settings);
// What a pack that says `info` would say if it were baked from the files as they are now: the same text, if
// none of them changed. It decides the pack's bytes. nullopt if it is not what bake() writes. Safe for
// hostile text. ToolError kIo for a file that cannot be read.
std::optional<Recipe> recipeNow(const std::string& info, const std::filesystem::path& input,
                                const Settings& settings);
// Whether `pack` is what bake() would make of the input: whole, and baked by this version with these options
// from files whose content, by their hashes, is still the same; names that were looked for in vain must still
// be absent. Reads all of it. Never throws; a pack that is absent, damaged or hostile is not current.
bool isCurrent(const std::filesystem::path& pack, const std::filesystem::path& input,
               const Settings& settings);
// Writes the pack beside `path`, flushes it to disk and renames it over `path`: an existing file is whole at
// every moment, and whatever goes wrong leaves nothing behind.
void writePackFile(const RawPack& pack, const std::filesystem::path& path, int threads, Report& report,
                   const Progress& progress = {});

}  // namespace kelp::bake
