// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "kelp/bake/bake.h"
#include "kelp/fields/cages.h"
#include "kelp/formats/pack.h"
#include "kelp/import/core/padding.h"
#include "steps.h"

namespace kelp::bake {

void checkSettings(const Settings& settings) {
  const auto wrong = [](const std::string& what) { throw ToolError(Exit::kUsage, what); };
  if (settings.voxel_size &&
      !(*settings.voxel_size >= kSmallestVoxel && *settings.voxel_size <= kLargestVoxel)) {
    wrong(
        fmt::format("--voxel-size {}: not a length above 0 that a pack can hold; give the edge of a voxel in "
                    "meters, such as 0.01",
                    *settings.voxel_size));
  }
  if (!settings.voxel_size && (settings.resolution < 1 || settings.resolution > kMaxResolution)) {
    wrong(fmt::format("--resolution {}: not between 1 and {}; 128 is the default, 256 shows fine detail",
                      settings.resolution, kMaxResolution));
  }
  if (settings.levels < 0 || settings.levels > kMaxLevels)
    wrong(
        fmt::format("--levels {}: not between 1 and {}; leave it out for all", settings.levels, kMaxLevels));
  if (const int cell = settings.cell.value_or(kDefaultCell);
      cell < fields::kSmallestCell || cell > fields::kLargestCell || (cell & (cell - 1)) != 0)
    wrong(fmt::format("--cell {}: not 2, 4, 8 or 16; {} is the default", cell, kDefaultCell));
  if (settings.threads < 0 || settings.threads > 1024)
    wrong(fmt::format("--threads {}: not between 1 and 1024; leave it out for all", settings.threads));
  if (settings.palette_file && settings.keep_materials)
    wrong("--palette and --keep-materials at once: fixed colors may serve several materials; choose one");
  if (!(settings.unit >= kSmallestUnit && settings.unit <= kLargestUnit))
    wrong(
        fmt::format("--unit {}: not between {:g} and {:g} meters; give the length of a unit of the file, "
                    "such as cm or 0.01",
                    settings.unit, kSmallestUnit, kLargestUnit));
  if (settings.pad < 0 || settings.pad > kMaxPad)
    wrong(fmt::format("--pad {}: not between 0 and {} voxels; 1 or 2 is usual", settings.pad, kMaxPad));
  if (settings.rig_file && settings.rig_preset) wrong("a rig file and a preset at once; choose one");
}

}  // namespace kelp::bake
