// SPDX-License-Identifier: MIT
// The baker as a library: a file in, a pack out. Stages are functions from plain data to plain data, in the
// order of this header. Everything here throws ToolError and nothing else; tools/kelp-bake turns it into an
// exit code and a line. Functions may run on several threads at once, each with its own arguments.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "kelp/common/error.h"
#include "kelp/common/output_file.h"
#include "kelp/common/progress.h"
#include "kelp/formats/raw_pack.h"
#include "kelp/import/core/files_used.h"
#include "kelp/import/core/import_settings.h"
#include "kelp/import/core/source_model.h"
#include "kelp/import/import.h"
#include "kelp/voxelize/topology/fill_report.h"
#include "kelp/voxelize/voxelize.h"

namespace kelp::bake {

// The side of the cells of cages, in voxels, if nobody asks for another. Those of skins follow from the fit.
inline constexpr int kDefaultCell = 8;

// The options of a bake.
struct Settings : ImportSettings {
  Fill fill = Fill::kAuto;
  std::optional<std::filesystem::path> palette_file;  // the palette's colors; see readPalette
  // Two of the file's materials never share a palette entry. Not together with palette_file.
  bool keep_materials = false;
  int levels = 0;        // how many; 0: until a level is a single brick
  bool distance = true;  // whether the pack holds distances
  // Side of the cells of cages, in voxels: 2, 4, 8 or 16; of parts whose rig does not say. Absent:
  // kDefaultCell
  std::optional<int> cell;
  Effort effort = Effort::kFast;
};

// Numbers of a bake, for --report and the closing lines.
struct Report {
  struct Stage {
    std::string name;
    double seconds = 0;
    std::uint64_t peak_bytes = 0;  // most memory of one of its processes until this stage ended
  };
  // How far the cage of a skin is from where its joints and morph targets would draw it, in voxels
  // (kelp/skin/skin.h).
  struct Fit {
    double mean = 0, p95 = 0, max = 0;
    std::string joint;  // where it is worst; empty: not of a skin
  };
  struct Part {
    std::string name, rig_origin, fill;
    glm::ivec3 size{0};
    double voxel_size = 0;  // meters
    std::uint64_t triangles = 0, solid_voxels = 0, surface_voxels = 0, bricks = 0;
    bool fog = false;
    std::uint64_t fog_voxels = 0;  // with density above 0; a fog part has no solid_voxels
    bool closed = false;
    bool empty = false;  // has no voxels, only motion
    MeshCounts mesh;     // zeros for volumes
    FillCounts repairs;
    std::string parent;                          // the part it follows; empty: none
    float parent_at = kelp::Part::kNotOnSpline;  // where on that part's spline it hangs
    bool swept = false, caged = false;
    int cell = 0;    // side of the cells of its cage, voxels; 0: it has none
    float roll = 0;  // radians, as in RawRig
    std::vector<std::string> sockets;
    std::vector<ComponentReport> components;  // empty for volumes
    Fit fit;                                  // of a morph target
  };
  struct Clip {
    std::string name, part;
    float duration = 0;                 // seconds
    float leaves_box = 0;               // how far bending leaves the box at rest, in lengths of the part
    bool bends = false, moves = false;  // bends the part; moves it as a whole
    Fit fit;                            // the whole clip's
  };
  std::string format;
  std::vector<Stage> stages;
  std::vector<Part> parts;
  std::vector<Clip> clips;
  std::vector<std::string> notices;
  FilesUsed files;
  std::uint64_t materials = 0, images = 0;  // materials that triangles use; images that were read
  std::uint64_t palette_entries = 0;
  // with Settings::keep_materials: the material of each palette entry
  std::vector<std::string> palette_materials;
  // mean distance in OKLab between a surface voxel's color and its palette entry
  double palette_error = 0;
  std::uint64_t estimated_bytes = 0;  // of memory, announced before the work
  std::uint64_t pack_bytes = 0;
  std::string pack_hash;  // of the pack's bytes, by Hash (kelp/common/hash.h); kelp-bake sets it
};

// --- 1. palette ----------------------------------------------------------------------------------
// The 1 to 256 base colors, linear, of a palette file: a GIMP palette (.gpl, in its order), or a picture
// (row by row from the top left; each color once; transparent pixels are skipped). Throws ToolError kIo or
// kInvalid. Safe for hostile input.
std::vector<glm::vec3> readPalette(const std::filesystem::path& path, FilesUsed* used = nullptr);

struct PaletteRules {
  // The palette of a file that has one (MagicaVoxel); otherwise empty. Kept as it is: SurfaceSample::source
  // is the index. Not together with `colors`.
  std::vector<Material> entries;
  // If not empty, the palette's colors in this order; each voxel gets the nearest in OKLab. Metallic,
  // roughness and emission of an entry are means over its voxels.
  std::vector<glm::vec3> colors;
  bool keep_materials = false;  // samples with different sources never share an entry
  bool blends = false;          // of `entries`: SourceModel::palette_blends
};
struct Palette {
  std::vector<Material> entries;  // 1 to 256
  // SurfaceSample::source of each entry, with keep_materials or with given entries that do not blend;
  // otherwise empty
  std::vector<std::uint32_t> sources;
  std::vector<std::vector<std::uint8_t>> indices;  // one list per grid, one index per surface sample
  double mean_error = 0;                           // OKLab
};
// One palette for all grids. Throws ToolError kUnsupported if keep_materials asks for more than 256 entries.
Palette choosePalette(const std::vector<const VoxelGrid*>& grids, int threads,
                      const PaletteRules& rules = {});

// --- 2. pack -------------------------------------------------------------------------------------
// Occupancy, attributes and levels of one grid. Frees the grid's arrays as it goes: they are the largest of a
// bake. With `sources` (Palette::sources), a coarse voxel gets the material of most of its children.
std::vector<RawLevel> buildLevels(VoxelGrid grid, const std::vector<std::uint8_t>& palette_indices,
                                  const std::vector<Material>& palette, int levels, int threads,
                                  const Progress& progress, const std::vector<std::uint32_t>& sources = {});

// The same for fog. Without any heat above 0, the levels have no heat.
std::vector<RawLevel> buildFogLevels(FogGrid grid, int levels, int threads, const Progress& progress);

// The distances of a solid part whose levels are built. Progress: 0 to 1 in "distances".
std::vector<RawDistances> buildDistances(const RawPart& part, int threads, const Progress& progress);

// --- all of it -----------------------------------------------------------------------------------
// Throws ToolError kUsage, which names the option, for an invalid setting. bake() calls it first.
void checkSettings(const Settings& settings);
// Bakes a file to a pack in memory. Safe for hostile input.
RawPack bake(const std::filesystem::path& input, const Settings& settings, Report& report,
             const Progress& progress = {});
// The text with which the INFO of every pack of this input begins: version, name, format and hash.
// `xxh3`: hashFile(input).
std::string sourceInfo(const std::filesystem::path& input, const std::string& format,
                       const std::string& xxh3);
// Writes the pack's bytes into a file that the caller commits, and their number into the report. Throws
// ToolError kIo.
void writePackInto(const RawPack& pack, OutputFile& file, int threads, Report& report,
                   const Progress& progress = {}, Effort effort = Effort::kFast);
// The same, whole: to a temporary file beside `path`, flushes it to disk and renames it to `path`. So an
// existing file is whole at every moment, and an error leaves no temporary file. Throws ToolError kIo.
void writePackFile(const RawPack& pack, const std::filesystem::path& path, int threads, Report& report,
                   const Progress& progress = {}, Effort effort = Effort::kFast);

}  // namespace kelp::bake
