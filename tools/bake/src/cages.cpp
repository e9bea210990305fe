// SPDX-License-Identifier: MIT
#include <algorithm>
#include <new>
#include <utility>

#include <fmt/format.h>

#include "kelp/common/parallel.h"
#include "kelp/fields/cages.h"
#include "kelp/fields/fields.h"
#include "kelp/formats/cage.h"
#include "kelp/formats/pack.h"
#include "part_frames.h"
#include "steps.h"

namespace kelp::bake {
namespace {

// Of a pack's metadata; the rest is for the other tables.
constexpr std::uint64_t kMostCageBytes = PackLimits{}.max_metadata_bytes / 16 * 15;

// A skin chooses its own: the largest are the only ones that it may need. Sections that nobody gives cells
// have the largest that draw them to 1 %.
int cellOf(const SourcePart& part, const Settings& settings, int height) {
  if (part.skin) return settings.cell.value_or(fields::kLargestCell);
  if (part.rig.cell != 0 || settings.cell) return part.rig.cell != 0 ? part.rig.cell : *settings.cell;
  int cell = kDefaultCell;
  while (part.sections >= 0 && cell > fields::kSmallestCell && sectionError(part.rig, height, cell) > 0.01)
    cell /= 2;
  return cell;
}

// As it is written where the part's cells are chosen.
std::string cellText(const SourcePart& part, int cell) {
  return fmt::format(fmt::runtime(part.rig.cell != 0 ? "\"cell\": {}" : "--cell {}"), cell);
}

bool hasCage(const SourcePart& part) { return part.rig.caged && !part.isEmpty(); }

// Bytes that readers have left for cages, and the most that they need while they make one.
struct Room {
  std::uint64_t decoded = kMostCageBytes, tables = kMostCageBytes, making = 0;
};

// False: there is not as much.
bool takeRoom(const std::vector<RawCage>& cages, const RawPart& part, int levels, Room& room) {
  CageMemory even, odd;
  Cage made[2];
  for (std::size_t i = 0; i < cages.size(); ++i) {
    const RawCage& raw = cages[i];
    const std::uint64_t numbers = sizeof(std::uint32_t) * (raw.split_points.size() + raw.follows.size()) +
                                  (i == 0 ? part.influences.size() * sizeof(Influences) : 0),
                        bytes = raw.blocks.size() + raw.masks.size() + raw.splits.size() + numbers;
    if (bytes > room.decoded) return false;
    room.decoded -= bytes;
    const Result<Cage> cage =
        makeCage(raw.source(), part.size, levels, part.cell, static_cast<int>(i),
                 i > 0 ? &made[(i - 1) & 1] : nullptr, 4 * kMostCageBytes, i & 1 ? odd : even);
    if (!cage && cage.error().code == ErrorCode::kOutOfMemory) throw std::bad_alloc();
    if (!cage || cage->bytes() + numbers > room.tables) return false;
    room.tables -= cage->bytes() + numbers;
    room.making = std::max(room.making, cageMakingBytes(cage->cells()));
    if (room.making > room.tables) return false;
    made[i & 1] = *cage;
  }
  return true;
}

// Gives all parts of `pack` their cages, with cells of at least so many voxels. Or the part at which there
// are more than readers take by default; null: there are not.
const SourcePart* buildAll(SourceModel& model, const Settings& settings, int least, const Progress& progress,
                           const Sides& sides, RawPack& pack) {
  Room room;
  for (std::size_t i = 0; i < pack.parts.size(); ++i) {
    if (progress && !progress("cages", static_cast<double>(i) / static_cast<double>(pack.parts.size())))
      throw ToolError(Exit::kInterrupted, "interrupted");
    if (!hasCage(model.parts[i])) continue;
    RawPart& part = pack.parts[i];
    VoxelGrid& grid = *model.parts[i].grid;
    const int levels = levelCount(grid.size, settings.levels);
    if (part.cages.empty() || part.cell < least) {
      part.cell = std::max(cellOf(model.parts[i], settings, part.size.y), least);
      fields::Occupancy occupancy{grid.size, std::move(grid.solid)};
      const fields::SolidBits bits(occupancy, threadCount(settings.threads));
      grid.solid = std::move(occupancy.solid);
      part.cages = fields::buildCages(bits, levels, part.cell);
      if (const auto its = sides.find(i); its != sides.end())
        part.influences = followSides(part, levels, its->second);
    }
    if (!takeRoom(part.cages, part, levels, room)) return &model.parts[i];
  }
  return nullptr;
}

}  // namespace

void checkCages(const SourceModel& model, const RawPack& pack, const Settings& settings,
                const std::filesystem::path& input) {
  bool any = false;
  for (std::size_t i = 0; i < model.parts.size(); ++i) {
    const SourcePart& part = model.parts[i];
    any = any || part.rig.caged;
    if (!part.rig.caged) continue;
    if (part.fog)
      throw ToolError(Exit::kUnsupported, partPlace(input, part) +
                                              ": is fog, which has no cages; write \"bend\": \"sweep\" or "
                                              "\"shear\" in its rig");
    const glm::ivec3& size = pack.parts[i].size;
    const int longest = std::max({size.x, size.y, size.z}), cell = cellOf(part, settings, size.y);
    if (longest <= kMostCageCells * cell) continue;
    int fits = cell;
    while (fits < fields::kLargestCell && longest > kMostCageCells * fits) fits *= 2;
    throw ToolError(
        Exit::kUsage,
        fmt::format("{}: {} voxels are more than {} cells of {}; {}", partPlace(input, part), longest,
                    kMostCageCells, cellText(part, cell),
                    longest > kMostCageCells * fits ? fmt::format("bake with a --resolution of at most {}",
                                                                  kMostCageCells * fields::kLargestCell)
                                                    : cellText(part, fits) + " fits"));
  }
  if (settings.cell && !any)
    throw ToolError(
        Exit::kUsage,
        fmt::format("--cell {}: no part has a cage; add --bend cage, or leave it out", *settings.cell));
}

void addCages(SourceModel& model, const Settings& settings, const Progress& progress,
              const std::filesystem::path& input, const Sides& sides, RawPack& pack) {
  const SourcePart* const first = buildAll(model, settings, fields::kSmallestCell, progress, sides, pack);
  if (!first) return;
  const SourcePart& part = *first;
  const int cell = pack.parts[static_cast<std::size_t>(first - model.parts.data())].cell;
  int fits = 2 * cell;
  while (fits <= fields::kLargestCell && buildAll(model, settings, fits, progress, sides, pack)) fits *= 2;
  throw ToolError(
      Exit::kUnsupported,
      fmt::format(
          "{}: cages of {} take more than {} MiB in memory, and packs with such cages are "
          "not read by default; {}",
          partPlace(input, part), cellText(part, cell), kMostCageBytes >> 20,
          fits > fields::kLargestCell ? "bake with a lower --resolution" : cellText(part, fits) + " fits"));
}

}  // namespace kelp::bake
