// SPDX-License-Identifier: MIT
// The baker as a library: a file in, a pack out. Stages are functions from plain data to plain data, in the order of this header.
// Everything here throws BakeError, and nothing else; one boundary in tools/kelp-bake turns it into an exit code and a line.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "kelp/bake/source_model.h"
#include "kelp/formats/raw_pack.h"

namespace kelp::bake {

// Exit codes of every kelp program (DESIGN: section 7).
enum class Exit : int { kOk = 0, kUsage = 1, kIo = 2, kInvalid = 3, kRuntime = 4, kUnsupported = 5, kDifference = 7, kInterrupted = 130 };

// what() is one line: file, place, what is wrong, what to do.
struct BakeError : std::runtime_error {
  BakeError(Exit code, const std::string& what) : std::runtime_error(what), exit(code) {}
  Exit exit;
};

enum class Fill : std::uint8_t { kAuto, kSolid, kSurface };

// What becomes a part. kOne: nodes with rigs with their subtrees, and one of all the rest. kNodes: every node with a mesh, beside what rigs bend;
// animations of nodes become clips.
enum class Parts : std::uint8_t { kOne, kNodes };

// What a volume becomes. kAuto: level sets, masks and whatever an isovalue is given for are solid, densities are fog.
enum class VolumeKind : std::uint8_t { kAuto, kSolid, kFog };

// A moment of an animation of the file.
struct Moment {
  std::string clip;
  double seconds = 0;  // at least 0; beyond the last key its values hold
};

struct Settings {
  int resolution = 128;                // voxels along the longest side of the largest part; ignored if voxel_size is set
  bool resolution_given = false;       // resolution was asked for, not defaulted: volumes, which have voxels of their own, are resampled to it
  std::optional<double> voxel_size;    // metres in the object: after `unit`. Of .vox and .binvox, whose voxels are kept, how large they are
  std::optional<Axis> axis;            // for rigs that name none; without, `up`
  std::optional<Axis> up;              // the file's axis that points up, the object's +y; without, +y
  double unit = 1;                     // metres to a unit of the file, 1e-6 to 1e6
  int pad = 0;                         // empty voxels on every side of a part, 0 to 1024; not along the axis of one that bends
  std::optional<std::filesystem::path> rig_file;
  std::optional<std::string> rig_preset;
  std::optional<std::string> scene;    // of a glTF file: its index, or else its name; without, the file's default
  Fill fill = Fill::kAuto;
  Parts parts = Parts::kOne;
  std::optional<Moment> at;            // nodes, skins and morph targets as they are then: what is baked, and what clips start from
  std::optional<std::filesystem::path> palette_file;  // its colours are the palette; see readPalette
  bool keep_materials = false;         // no palette entry serves two of the file's materials; not with palette_file
  VolumeKind volume = VolumeKind::kAuto;
  std::optional<std::string> grid;        // of a volume file with several: its name, or else its index
  std::optional<std::string> color_grid;  // the Vec3 grid that colours it; without, Cd or color if there is one
  std::optional<std::string> heat_grid;   // the grid that makes fog glow; without, flame, flames, heat or temperature if there is one; empty: none
  std::optional<double> isovalue;         // where the surface of a solid volume is; without, 0 for level sets and half the greatest value for others
  double density = 1;                     // factor on the densities of fog, > 0
  std::optional<std::filesystem::path> ramp_file;  // colours that fog glows in, cold to hot; see readPalette. Without, those of a black body
  std::optional<int> frame;               // of a MagicaVoxel animation; without, the first
  int levels = 0;                      // 0: down to a single brick
  int threads = 0;                     // 0: all
  std::uint64_t max_memory = 0;        // bytes; 0: the machine's physical memory
};

// Called with a stage's name and its progress 0..1; answers false to stop (BakeError kInterrupted). Called from the baking thread only.
using Progress = std::function<bool(std::string_view stage, double done)>;

// The files that a pack was made of.
struct FilesUsed {
  struct File {
    std::filesystem::path path;
    std::string xxh3;  // of its bytes as they were read, or were just before a library read them: XXH3-64, 16 hexadecimal digits
  };
  std::vector<File> read;                      // each once
  std::vector<std::filesystem::path> missing;  // looked for in vain, or not to be read: otherwise they would have been
};

// A mesh as the file has it, corners in equal places being one.
struct MeshCounts {
  std::uint64_t vertices = 0, triangles = 0;
  std::uint64_t boundary_edges = 0;      // of one triangle alone
  std::uint64_t boundaries = 0;          // what those hang together to: the rims of holes and of open sheets
  std::uint64_t non_manifold_edges = 0;  // of three triangles or more
  std::uint64_t dropped = 0;             // triangles that are not among these: without an area, or not finite
};

// What the fill made of it, after welding to a fraction of a voxel.
struct FillCounts {
  std::uint64_t components = 0, closed = 0, capped = 0, sheets = 0, walls = 0;  // what hangs together by edges; walls: faces modelled from both sides between bodies
  std::uint64_t doubled = 0;        // triangles left out: modelled twice, or no more than a line that others have as a side
  std::uint64_t turned = 0;         // triangles wound against their neighbours, or inside out
  std::uint64_t cap_triangles = 0;  // that close holes
  std::uint64_t kept_voxels = 0;    // solid though their centres lie in no body: sheets, and what is thinner than a voxel
};

// Seconds and numbers of a bake, for --report and the closing lines.
struct Report {
  // What hangs together by shared edges: why it became solid or stayed a surface.
  struct Component {
    std::uint64_t triangles = 0;
    double surface_share = 0;  // of the part's area
    bool solid = false;
    std::string why;           // "closed", "holes of 2.2 % of its surface were capped", "open: ..."
  };
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
    bool carrier = false;    // there for its motion alone
    MeshCounts mesh;         // zeros for volumes
    FillCounts repairs;
    std::string parent;      // the part that it follows; empty: none
    std::vector<Component> components;  // the largest kMaxComponents, by area; empty for volumes
  };
  static constexpr std::size_t kMaxComponents = 64;
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
  std::vector<std::string> palette_materials;  // with Settings::keep_materials, the material of each palette entry
  double palette_error = 0;             // mean distance in OKLab between a surface voxel's colour and its palette entry
  std::uint64_t estimated_bytes = 0;    // of memory, announced before the work
  std::uint64_t pack_bytes = 0;
  std::string pack_hash;                // of the pack's bytes, by Hash (kelp/bake/hash.h)
};

// --- 1. import -------------------------------------------------------------------------------------------------------------------
// Picks the importer by the file's extension and checks the content against it. `used`, if given, gets every file opened or looked for.
SourceModel importFile(const std::filesystem::path& path, const Settings& settings, FilesUsed* used = nullptr);
SourceModel importGltf(const std::filesystem::path& path, const Settings& settings, FilesUsed* used = nullptr);
SourceModel importMesh(const std::filesystem::path& path, const Settings& settings, FilesUsed* used = nullptr);
SourceModel importVdb(const std::filesystem::path& path, const Settings& settings, FilesUsed* used = nullptr);
SourceModel importVox(const std::filesystem::path& path, const Settings& settings, FilesUsed* used = nullptr);
SourceModel importBinvox(const std::filesystem::path& path, const Settings& settings, FilesUsed* used = nullptr);
SourceModel importRaw(const std::filesystem::path& path, const Settings& settings, FilesUsed* used = nullptr);

// --- 2. voxelize -----------------------------------------------------------------------------------------------------------------
// The frame a part is voxelized in: `size` voxels of edge voxel_size; voxel = node_to_voxel * node.
struct Frame {
  glm::ivec3 size{0};
  double voxel_size = 0;
  glm::dmat4 node_to_voxel{1};
};
// The rig frame of a soup: its bounding box turned so that the rig's axis is +y; along y the box fits whole voxels exactly where the voxel
// size is ours to choose (so the spline spans just the source's extent). `what` names the part in errors; `metres` to a unit of the soup, for them too.
// BakeError kInvalid for a soup that is empty, not finite, or so far from its origin that voxels can not be told apart.
Frame makeFrame(const TriangleSoup& soup, Axis axis, double voxel_size, const std::string& what, double metres = 1);

struct VoxelizeResult {
  VoxelGrid grid;
  bool closed = false;    // the mesh has no boundary edge after welding equal positions
  std::string fill;       // "solid" or "surface", and why
  std::vector<Report::Component> components;  // see Report::Part
  std::vector<std::string> notices;
  FillCounts counts;
};
VoxelizeResult voxelize(const SourceModel& model, const SourcePart& part, const Frame& frame, Fill fill, int threads, const Progress& progress);

// --- 3. palette ------------------------------------------------------------------------------------------------------------------
// Base colours, linear, 1 to 256, of a palette that somebody painted: a GIMP palette (.gpl, in its order), or a picture (row by row from the top left, each
// colour once; what is transparent is no colour). BakeError kIo and kInvalid. Safe for hostile input.
std::vector<glm::vec3> readPalette(const std::filesystem::path& path, FilesUsed* used = nullptr);

struct PaletteRules {
  std::vector<Material> entries;  // of a file that is painted by index, if it is: kept as they are, each voxel has the one that SurfaceSample::source names. Without `colors`
  std::vector<glm::vec3> colors;  // the entries, in this order, if there are any: each voxel gets the nearest in OKLab. Gloss and glow are means
  bool keep_materials = false;    // samples of two sources never share an entry
  bool blends = false;            // of `entries`: SourceModel::palette_blends
};
struct Palette {
  std::vector<Material> entries;                       // 1 to 256
  std::vector<std::uint32_t> sources;                  // with keep_materials or given entries that do not blend, SurfaceSample::source of each entry; else empty
  std::vector<std::vector<std::uint8_t>> indices;      // one list a grid, one index a surface sample
  double mean_error = 0;                               // OKLab
};
// BakeError kUnsupported where more materials than entries are to be kept apart.
Palette choosePalette(const std::vector<const VoxelGrid*>& grids, int threads, const PaletteRules& rules = {});

// --- 4. pack ---------------------------------------------------------------------------------------------------------------------
// Occupancy, attributes and levels of one grid, which is used up: its arrays are the largest there are.
// `sources`: Palette::sources; coarse voxels then keep the material of most of their children.
std::vector<RawLevel> buildLevels(VoxelGrid grid, const std::vector<std::uint8_t>& palette_indices, const std::vector<Material>& palette,
                                  int levels, int threads, const Progress& progress, const std::vector<std::uint32_t>& sources = {});

// The same of fog. Heat is dropped where no sample of it is left.
std::vector<RawLevel> buildFogLevels(FogGrid grid, int levels, int threads, const Progress& progress);

// --- all of it -------------------------------------------------------------------------------------------------------------------
// What of the settings can not be: each a BakeError kUsage that names the option. bake() throws the first.
std::vector<BakeError> settingsFaults(const Settings& settings);
// Bakes a file to a pack in memory.
RawPack bake(const std::filesystem::path& input, const Settings& settings, Report& report, const Progress& progress = {});
// What a pack says of its making (INFO), and the files that were asked for it.
struct Recipe {
  std::string info;
  FilesUsed files;
};
// What is known before anything but the named files is read: two bakes of one input with the same answer read the same files, as far as those are the same.
Recipe recipeBefore(const std::filesystem::path& input, const Settings& settings);
// What a pack that says `info` would say if it were baked from the files as they are now: the same text, if none of them changed. It decides the pack's bytes.
// nullopt if it is not what bake() writes. Safe for hostile text. BakeError kIo for a file that can not be read.
std::optional<Recipe> recipeNow(const std::string& info, const std::filesystem::path& input, const Settings& settings);
// Whether `pack` is what bake() would make of the input: whole, and baked by this version with these options from files whose content, by their hashes,
// is still the same; names that were looked for in vain must still be absent. Reads all of it. Never throws; a pack that is absent, damaged or hostile is not current.
bool isCurrent(const std::filesystem::path& pack, const std::filesystem::path& input, const Settings& settings);
// Whether writePackFile could write `path`, asked before the long work: BakeError kIo that says why not. Leaves nothing behind.
void checkOutput(const std::filesystem::path& path);
// Writes the pack beside `path`, flushes it to disk and renames it over `path`: an existing file is whole at every moment, and whatever
// goes wrong leaves nothing behind.
void writePackFile(const RawPack& pack, const std::filesystem::path& path, int threads, Report& report, const Progress& progress = {});

// Writes a text, such as a report, in the same way. What is no regular file (/dev/stdout) is written as it is. BakeError kIo.
void writeTextFile(const std::filesystem::path& path, std::string_view text);

}  // namespace kelp::bake
