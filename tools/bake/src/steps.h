// SPDX-License-Identifier: MIT
// The steps of bake(), in the order in which it takes them.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "kelp/bake/bake.h"
#include "kelp/formats/raw_pack.h"
#include "kelp/import/core/frame.h"
#include "kelp/import/core/memory_estimate.h"
#include "kelp/import/core/source_model.h"
#include "kelp/skin/skin.h"

namespace kelp::bake {

// Units a file may be in; meters.
inline constexpr double kSmallestUnit = 1e-6, kLargestUnit = 1e6;

// Turns Settings::up to the object's +y and scales by Settings::unit: only matrices change, so voxels, rigs
// and clips stay in the file's own axes and units.
void placeInObject(SourceModel& model, const ImportSettings& settings);

// Counts of voxels and triangles of a part before it is voxelized, for the memory estimate. `frame`: of a
// mesh, padded already. `pad` is added to volumes and fog.
PartSize partSize(const SourcePart& part, const Frame& frame, const glm::ivec3& pad);

// True if thousands of triangles lie over each other nearly everywhere: sorting their crossings would take
// too long.
bool isPile(const PartSize& part);

// A part that bends by joints: its cage, and the joints that the nodes follow.
struct SkinnedBody {
  std::vector<SkinFit> fits;  // how well the cage follows the skin, for each clip
  int cell = 0;
  std::vector<RawCage> cages;
  std::vector<Influences> influences;  // joint j is part 1 + j
  std::vector<RawJoint> joints;        // none where one of them cannot be stored
  std::vector<RawMorph> morphs;        // their parts follow those of the joints
  std::vector<SkinFit> morph_fits;     // of each
};

// Leaves out joints and morph targets of the model's first part if it has more than a pack can have parts.
void limitSkin(SourceModel& model, Report& report);

// Makes the cage of the model's first part, whose voxels are made in `frame`, and appends an empty part for
// each joint, then one for each morph target.
SkinnedBody divideSkinnedPart(SourceModel& model, const Frame& frame, const Settings& settings, int threads,
                              const Progress& progress, Report& report);

// Adds what the cage of a skin needs to the size of its part.
void countSkin(const SourceSkin& skin, PartSize& size);

// Adds how well clips and morph targets fit to the report, and a notice for those that do not fit well.
void reportFits(const SkinnedBody& body, Report& report);

// How each part bends: as its rig says, else by the settings; and which have others, or sides, on their
// splines.
void chooseBends(SourceModel& model, const Settings& settings);

// ToolError kInvalid, with the names of the parts there are, if the outer rig has a rig for another part.
void requireRiggedParts(const SourceModel& model, const ImportSettings& settings,
                        const std::filesystem::path& input);

// Gives the parts of `pack`, whose names and sizes are set, their knots, in the voxels of their frames, and
// the pack its clips and sockets. Proves that no clip folds a part; `report` gets a line per clip and part.
// ToolError for rigs and clips that cannot be.
void rigParts(const SourceModel& model, const std::filesystem::path& input, RawPack& pack, Report& report);

// The parts that the nodes of a part with sides follow, by that part: one for each corner, as cornerName().
using Sides = std::map<std::size_t, std::array<std::uint32_t, 4>>;

// Appends these parts, which are empty, and as many frames, which are padded. ToolError for sides that cannot
// be.
Sides addSides(SourceModel& model, std::vector<Frame>& frames, const std::filesystem::path& input);
// The parts that the nodes of a part's finest cage follow: bilinear between the corners.
std::vector<Influences> followSides(const RawPart& part, int levels,
                                    const std::array<std::uint32_t, 4>& followed);
// How far off widths are at most, as a share, between the nodes of cells of this side, which follow sections
// linearly, while a clip plays: a bulge is cut off, and what turns is drawn in. height: of the part, voxels.
double sectionError(const RigDescription& rig, int height, int cell);
// A notice if that is much.
void noteCoarseSections(const SourcePart& part, const RawPart& raw, Report& report);
// A notice for each part whose sides cross, or whose sections a clip may narrow to nothing. `pack`: has its
// rigs.
void noteCrossings(const SourceModel& model, const Sides& sides, const RawPack& pack, Report& report);

// ToolError for parts that cannot have the cages that their rigs or the settings ask for. `pack`: has the
// parts' sizes.
void checkCages(const SourceModel& model, const RawPack& pack, const Settings& settings,
                const std::filesystem::path& input);
// Builds those that are missing from the voxels; with sides, what their nodes follow. ToolError if they are
// more than a reader takes by default.
void addCages(SourceModel& model, const Settings& settings, const Progress& progress,
              const std::filesystem::path& input, const Sides& sides, RawPack& pack);

// Levels of a volume: down to a single brick, or `asked` if that is fewer (0: all).
int levelCount(const glm::ivec3& size, int asked);

// The look of a fog part: white, scattering equally to all sides. Where there is heat, it glows in the colors
// of `ramp`, or of a black body if `ramp` is empty. It is as bright as the ramp where both heat and density
// are greatest.
RawFog fogLook(const FogGrid& grid, const std::vector<glm::vec3>& ramp);

// The pack's INFO: tool version, source name and hash, the options that change content, and the other files
// it was made of by their names beside the source: a hash, or null where one was looked for in vain. Nothing
// that differs between two bakes of the same input: no place, time or number of threads.
// `pack`: has the places of the model's parts.
std::string makeInfo(const std::filesystem::path& input, const SourceModel& model, const RawPack& pack,
                     bool volume, const Settings& settings, const FilesUsed& used);

// STEM.rig.json, which is taken where no rig is asked for.
std::filesystem::path rigBeside(const std::filesystem::path& input);

}  // namespace kelp::bake
