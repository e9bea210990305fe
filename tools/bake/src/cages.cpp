// SPDX-License-Identifier: MIT
#include <algorithm>

#include <fmt/format.h>

#include "kelp/fields/cages.h"
#include "kelp/formats/cage.h"
#include "part_frames.h"
#include "steps.h"

namespace kelp::bake {

void checkCages(const SourceModel& model, const RawPack& pack, const Settings& settings,
                const std::filesystem::path& input) {
  const int cell = settings.cell.value_or(kDefaultCell);
  bool any = false;
  for (std::size_t i = 0; i < model.parts.size(); ++i) {
    const SourcePart& part = model.parts[i];
    if (part.skin && settings.caged)
      throw ToolError(Exit::kUnsupported,
                      partPlace(input, part) +
                          ": bends by its joints, and parts of a skin have no cages; leave --bend cage out, "
                          "or add --rig none for the model at rest, or a rig");
    any = any || part.skin || part.rig.caged;
    if (!part.rig.caged) continue;
    if (part.fog)
      throw ToolError(Exit::kUnsupported, partPlace(input, part) +
                                              ": is fog, which has no cages; write \"bend\": \"sweep\" or "
                                              "\"shear\" in its rig");
    const glm::ivec3& size = pack.parts[i].size;
    const int longest = std::max({size.x, size.y, size.z});
    if (longest <= kMostCageCells * cell) continue;
    int fits = cell;
    while (fits < fields::kLargestCell && longest > kMostCageCells * fits) fits *= 2;
    throw ToolError(Exit::kUsage, fmt::format("{}: {} voxels are more than {} cells of --cell {}; {}",
                                              partPlace(input, part), longest, kMostCageCells, cell,
                                              longest > kMostCageCells * fits
                                                  ? fmt::format("bake with a --resolution of at most {}",
                                                                kMostCageCells * fields::kLargestCell)
                                                  : fmt::format("--cell {} fits", fits)));
  }
  if (settings.cell && !any)
    throw ToolError(Exit::kUsage,
                    fmt::format("--cell {}: no part has a cage; add --bend cage, or leave it out", cell));
}

void addCages(const SourceModel& model, const Settings& settings, const Progress& progress, RawPack& pack) {
  for (std::size_t i = 0; i < pack.parts.size(); ++i) {
    if (progress && !progress("cages", static_cast<double>(i) / static_cast<double>(pack.parts.size())))
      throw ToolError(Exit::kInterrupted, "interrupted");
    RawPart& part = pack.parts[i];
    if (!model.parts[i].rig.caged || part.levels.empty()) continue;
    part.cell = settings.cell.value_or(kDefaultCell);
    part.cages =
        fields::buildCages(part.levels.front(), part.size, static_cast<int>(part.levels.size()), part.cell);
  }
}

}  // namespace kelp::bake
