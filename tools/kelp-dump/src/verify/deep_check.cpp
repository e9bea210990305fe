// SPDX-License-Identifier: MIT
#include "verify/deep_level.h"

#include <algorithm>
#include <stdexcept>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "kelp/common/dense_index.h"

#include "kelp/common/error.h"
#include "kelp/fields/fields.h"
#include "text/checks.h"
#include "text/text.h"

namespace kelp::dump {
namespace {

using fields::Occupancy;

// Two values of an occupancy, so that one array tells both: solid, and solid with an attribute.
constexpr std::uint8_t kPlain = 1, kAttributed = 2;

Occupancy occupancyOf(const StoredLevel& level) {
  Occupancy occupancy = fields::occupancyOf(level.raw, level.size);
  static_assert(kPlain == 1, "what fields::occupancyOf makes of solid voxels");
  for (std::size_t slot = 0; slot < level.brick_of_slot.size(); ++slot) {
    const std::uint8_t* const codes = level.raw.codes.data() + slot * kBrickVoxels;
    for (int i = 0; i < kBrickVoxels; ++i) {
      if (!isSurfaceCode(codes[i])) continue;
      const glm::ivec3 voxel =
          level.brick_of_slot[slot] * kBrickSide + glm::ivec3(i & 7, (i >> 3) & 7, i >> 6);
      // No solid voxel lies outside: formats' verify has checked that.
      occupancy.solid[occupancy.index(voxel)] = kAttributed;
    }
  }
  return occupancy;
}

class DeepCheck {
 public:
  DeepCheck(PackFile& file, VerifyReport& report)
      : file_(file),
        pack_(file.pack()),
        report_(report),
        threads_(static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1u, 64u))) {}

  void run() {
    std::vector<bool> unsound(pack_.parts().size());
    for (const Issue& f : report_.issues) {
      // The file may have changed since it was verified, and had more parts then.
      if (f.severity == Severity::kError && f.part >= 0 && static_cast<std::size_t>(f.part) < unsound.size())
        unsound[static_cast<std::size_t>(f.part)] = true;
    }
    for (std::size_t p = 0; p < pack_.parts().size(); ++p) {
      if (unsound[p] || pack_.parts()[p].kind == PartKind::kEmpty) continue;
      requireMemoryFor(static_cast<int>(p));
      if (pack_.parts()[p].fog)
        checkFogDeeply(file_, static_cast<int>(p), threads_, report_);
      else
        checkSolid(static_cast<int>(p));
    }
  }

 private:
  void requireMemoryFor(int p) const {
    const Part& part = pack_.parts()[static_cast<std::size_t>(p)];
    const std::uint64_t voxels = denseCount(part.size);
    // In addition to recomputing, solids need: the occupancy of this level and of the finer one, and the
    // stored level.
    const std::uint64_t needed = fields::peakBytes(part.size, voxels) +
                                 (part.fog ? deepFogBytes(voxels, part.fog->channels()) : 3 * voxels);
    requireMemory(needed,
                  fmt::format("{}: part {} '{}': checking {} voxels deeply", file_.path(), p,
                              nameText(part.name), sizeText(part.size)),
                  "verify without --deep, or on a larger machine");
  }

  void checkSolid(int part) {
    const Part& of = pack_.parts()[static_cast<std::size_t>(part)];
    Occupancy finer;
    for (int l = 0; l < of.levels; ++l) {
      const LevelPlace place{part, l};
      const StoredLevel level = readStored(file_, place);
      Occupancy occupancy = occupancyOf(level);
      if (l > 0) checkOccupancy(place, occupancy, fields::coarser(finer, threads_));
      checkAttributes(place, occupancy, l == 0 ? nullptr : &finer);
      finer = Occupancy();
      checkEmptiness(place, level, occupancy);
      if (!of.cages.empty()) checkCage(of.cages[static_cast<std::size_t>(l)], place, occupancy, report_);
      finer = std::move(occupancy);
      if (pack_.hasDistances()) checkDistances(file_, place, finer, threads_, report_);
    }
    // Distances go on beyond the voxels' levels.
    for (int l = of.levels; l < pack_.distanceLevels(part); ++l) {
      finer = fields::coarser(finer, threads_);
      checkDistances(file_, {part, l}, finer, threads_, report_);
    }
  }

  void checkOccupancy(const LevelPlace& place, const Occupancy& stored, const Occupancy& expected) {
    Tally lacks(DeepIssueId::kLacksVoxel, place), extra(DeepIssueId::kExtraVoxel, place);
    for (std::size_t i = 0; i < stored.solid.size(); ++i) {
      if ((stored.solid[i] != 0) == (expected.solid[i] != 0)) continue;
      const glm::ivec3 voxel = voxelAt(stored.size, i);
      (stored.solid[i] ? extra : lacks).add(voxel / kBrickSide, voxel);
    }
    lacks.report(report_);
    extra.report(report_);
  }

  // `finer` is null at level 0.
  void checkAttributes(const LevelPlace& place, const Occupancy& occupancy, const Occupancy* finer) {
    Tally lacks(DeepIssueId::kSurfaceLacksAttribute, place), extra(DeepIssueId::kExtraAttribute, place);
    const auto compare = [&](std::size_t i, bool expected) {
      // A missing voxel has been reported as missing.
      if (!occupancy.solid[i] || (occupancy.solid[i] == kAttributed) == expected) return;
      const glm::ivec3 voxel = voxelAt(occupancy.size, i);
      (expected ? lacks : extra).add(voxel / kBrickSide, voxel);
    };
    if (finer) {
      std::vector<bool> expected(occupancy.solid.size());
      for (std::size_t i = 0; i < finer->solid.size(); ++i) {
        if (finer->solid[i] == kAttributed) expected[occupancy.index(voxelAt(finer->size, i) / 2)] = true;
      }
      for (std::size_t i = 0; i < occupancy.solid.size(); ++i) compare(i, expected[i]);
    } else {
      const std::vector<std::uint64_t> surface = fields::surfaceVoxels(occupancy, threads_);
      auto next = surface.begin();
      for (std::size_t i = 0; i < occupancy.solid.size(); ++i) {
        const bool expected = next != surface.end() && *next == i;
        next += expected;
        compare(i, expected);
      }
    }
    lacks.report(report_);
    extra.report(report_);
  }

  void checkEmptiness(const LevelPlace& place, const StoredLevel& level, const Occupancy& occupancy) {
    std::vector<fields::SurfaceVoxel> surface;
    for (std::size_t i = 0; i < occupancy.solid.size(); ++i) {
      if (occupancy.solid[i] == kAttributed) surface.push_back({i, 0});
    }
    compareClearances(level, fields::buildLevel(occupancy, surface, threads_), place, report_);
  }

  PackFile& file_;
  const Pack& pack_;
  VerifyReport& report_;
  int threads_;
};

}  // namespace

const char* toString(DeepIssueId issue) {
  switch (issue) {
    case DeepIssueId::kFalseEmptiness:
      return "A cell promises emptiness where something is, so rays skip it. The program that wrote "
             "the pack is wrong: bake it again.";
    case DeepIssueId::kNotBestEmptiness:
      return "A cell promises less emptiness than there is, so rays take needless steps. Bake the pack "
             "again.";
    case DeepIssueId::kLacksVoxel:
      return "A level is empty where the next finer one is solid, so it shows holes from afar. Bake the "
             "pack again.";
    case DeepIssueId::kExtraVoxel:
      return "A level is solid where the next finer one is empty. Bake the pack again.";
    case DeepIssueId::kSurfaceLacksAttribute:
      return "A voxel of the surface has no color and normal. Bake the pack again.";
    case DeepIssueId::kExtraAttribute:
      return "A voxel that is not of the surface has a color and normal. Bake the pack again.";
    case DeepIssueId::kFogSample:
      return "A sample of fog is not the mean of the next finer level's, so fog changes from afar. Bake "
             "the pack again.";
    case DeepIssueId::kFogExtinction:
      return "A level of fog is not as dense as the next finer one. Bake the pack again.";
    case DeepIssueId::kFogSeam:
      return "Bricks of fog disagree about a sample that they share, so a seam shows. The program that "
             "wrote the pack is wrong: bake it again.";
    case DeepIssueId::kDistance:
      return "A distance is not that of the voxels, so things collide or shade wrongly. Bake the pack again.";
    case DeepIssueId::kCage:
      return "A cage does not hold the voxels of its part, so the part has holes when it bends. Bake the "
             "pack "
             "again.";
  }
  return "Unknown issue.";
}

void checkDeeply(PackFile& file, VerifyReport& report) {
  try {
    DeepCheck(file, report).run();
  } catch (const std::invalid_argument& error) {  // what fields ask for has been verified
    throw ToolError(
        Exit::kInvalid,
        fmt::format("{}: {}, unlike a moment ago: the file is being written; verify it again afterwards",
                    file.path(), error.what()));
  }
}

}  // namespace kelp::dump
