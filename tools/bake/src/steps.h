// SPDX-License-Identifier: MIT
// The steps of bake(), in the order in which it takes them.
#pragma once

#include <filesystem>
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

// A part that bends by joints becomes rigid parts that move.
struct DividedSkin {
  std::vector<SkinFit> fits;       // how well the new parts follow the skin, for each clip
  std::vector<SocketFit> sockets;  // and their sockets
  std::string info;                // JSON: what a pack says of its parts, INFO's "skin"
  std::vector<RawJoint> joints;    // none where one of them cannot be stored
};

// ToolError kInvalid if the rig asks for parts that the skin cannot have.
void requirePlan(const SourcePart& part, const std::filesystem::path& input);

// Replaces the model's first part, whose voxels are made, and its line of the report.
DividedSkin divideSkinnedPart(SourceModel& model, const Frame& frame, int pad, int threads,
                              const Progress& progress, Report& report);

// Adds what a skin needs to the size of its part: the division itself, and parts that have cuts and voxels of
// their neighbors beside the surface.
void countSkin(const SourceSkin& skin, PartSize& size);

// Adds how well clips fit to the report, and a notice for those that do not fit well. `frame` is the whole's.
void reportFits(const DividedSkin& divided, const Frame& frame, Report& report);

// ToolError kInvalid, with the names of the parts there are, if the outer rig has a rig for another part.
void requireRiggedParts(const SourceModel& model, const ImportSettings& settings,
                        const std::filesystem::path& input);

// Gives the parts of `pack`, whose names and sizes are set, their knots, in the voxels of their frames, and
// the pack its clips and sockets. Proves that no clip folds a part; `report` gets a line per clip and part.
// ToolError for rigs and clips that cannot be.
void rigParts(const SourceModel& model, const std::filesystem::path& input, RawPack& pack, Report& report);

// ToolError for parts that cannot have the cages that their rigs or the settings ask for. `pack`: has the
// parts' sizes.
void checkCages(const SourceModel& model, const RawPack& pack, const Settings& settings,
                const std::filesystem::path& input);
// Builds them from the voxels. ToolError if they are more than a reader takes by default.
void addCages(SourceModel& model, const Settings& settings, const Progress& progress,
              const std::filesystem::path& input, RawPack& pack);

// Levels of a volume: down to a single brick, or `asked` if that is fewer (0: all).
int levelCount(const glm::ivec3& size, int asked);

// The look of a fog part: white, scattering equally to all sides. Where there is heat, it glows in the colors
// of `ramp`, or of a black body if `ramp` is empty. It is as bright as the ramp where both heat and density
// are greatest.
RawFog fogLook(const FogGrid& grid, const std::vector<glm::vec3>& ramp);

// The pack's INFO: tool version, source name and hash, the options that change content, and the other files
// it was made of by their names beside the source: a hash, or null where one was looked for in vain. Nothing
// that differs between two bakes of the same input: no place, time or number of threads.
// `pack`: has the places of the model's parts. `skin`: JSON, what became of a skin; empty: there was none.
std::string makeInfo(const std::filesystem::path& input, const SourceModel& model, const RawPack& pack,
                     bool volume, const Settings& settings, const FilesUsed& used, const std::string& skin);

// STEM.rig.json, which is taken where no rig is asked for.
std::filesystem::path rigBeside(const std::filesystem::path& input);

}  // namespace kelp::bake
