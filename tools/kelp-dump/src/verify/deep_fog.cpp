// SPDX-License-Identifier: MIT
#include "verify/deep_level.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "kelp/common/dense_index.h"

#include "kelp/fields/fields.h"
#include "kelp/formats/fog.h"

namespace kelp::dump {
namespace {

using fields::FogSamples;

// True if all bricks of the grid, also empty ones, agree with the dense field that they make together.
bool bricksAgree(const LevelPlace& place, const StoredLevel& level, const FogSamples& samples,
                 VerifyReport& report) {
  Tally seam(DeepIssueId::kFogSeam, place);
  for (std::size_t c = 0; c < level.raw.cells.size(); ++c) {
    const glm::ivec3 brick = voxelAt(level.grid, c);
    const bool stored = level.raw.cells[c] & kCellSolid;
    const std::size_t first = stored ? std::size_t{level.raw.cells[c] & kCellSlotMask} * kFogSamples : 0;
    for (int i = 0; i < kFogSamples; ++i) {
      const glm::ivec3 at =
          brick * kBrickSide + glm::ivec3(i % kFogSide, i / kFogSide % kFogSide, i / (kFogSide * kFogSide));
      if (at.x >= samples.size.x || at.y >= samples.size.y || at.z >= samples.size.z) continue;
      const std::size_t dense = denseIndex(samples.size, at);
      const auto differs = [&](const std::vector<std::uint8_t>& raw, const std::vector<std::uint8_t>& field) {
        return !field.empty() && (stored ? raw[first + static_cast<std::size_t>(i)] : 0) != field[dense];
      };
      if (differs(level.raw.density, samples.density) || differs(level.raw.heat, samples.heat))
        seam.add(brick, at,
                 stored ? "a neighbor holds another value"
                        : "the brick is empty, and a neighbor holds fog at its edge");
    }
  }
  seam.report(report);
  return seam.count() == 0;
}

void checkCells(const LevelPlace& place, const StoredLevel& level, const FogSamples& samples, int threads,
                VerifyReport& report) {
  // All bricks agree about their samples, and no stored brick is clear. So both have the same bricks in the
  // same slots.
  compareClearances(level, fields::buildFogLevel(samples, threads), place, report);
}

void checkSamples(const LevelPlace& place, const FogSamples& stored, const FogSamples& right,
                  VerifyReport& report) {
  Tally wrong(DeepIssueId::kFogSample, place);
  const auto compare = [&](const char* what, const std::vector<std::uint8_t>& a,
                           const std::vector<std::uint8_t>& b) {
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (a[i] == b[i]) continue;
      const glm::ivec3 at = voxelAt(stored.size, i);
      wrong.add(glm::min(at, latticeSize(PartKind::kFog, stored.size) - 1) / kBrickSide, at,
                fmt::format("{} {} stored, {} is right", what, a[i], b[i]));
    }
  };
  compare("density", stored.density, right.density);
  compare("heat", stored.heat, right.heat);
  wrong.report(report);
}

}  // namespace

void checkFogDeeply(PackFile& file, int index, int threads, VerifyReport& report) {
  const Part& part = file.pack().parts()[static_cast<std::size_t>(index)];
  FogSamples finer;  // empty where it is unsure
  for (int l = 0; l < part.levels; ++l) {
    const LevelPlace place{index, l};
    const StoredLevel level = readStored(file, place);
    FogSamples samples = fields::fogSamplesOf(level.raw, levelSize(part.size, l));
    if (!bricksAgree(place, level, samples, report)) {
      finer = FogSamples();
      continue;
    }
    if (!finer.density.empty()) {
      const float stored = part.fog->extinction[static_cast<std::size_t>(l)];
      float right = part.fog->extinction[static_cast<std::size_t>(l - 1)];
      checkSamples(place, samples, fields::coarserFog(std::exchange(finer, FogSamples()), right, threads),
                   report);
      // The tolerance allows for another order of summing.
      if (std::abs(stored - right) > 1e-5f * right) {
        Tally wrong(DeepIssueId::kFogExtinction, place);
        wrong.add(std::nullopt, std::nullopt, fmt::format("{} stored, {} is right", stored, right));
        wrong.report(report);
      }
    }
    checkCells(place, level, samples, threads, report);
    finer = std::move(samples);
  }
}

std::uint64_t deepFogBytes(std::uint64_t voxels, int channels) {
  // This level and the finer one as dense arrays, the cubes between samples, and the bricks as stored and as
  // recomputed (729 bytes for 512 cubes, with room to grow).
  return voxels + static_cast<std::uint64_t>(channels) * (2 * voxels + 5 * voxels);
}

}  // namespace kelp::dump
