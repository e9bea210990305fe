// SPDX-License-Identifier: MIT
#include "deep_fog.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "kelp/fields/fields.h"
#include "kelp/formats/fog.h"

namespace kelp::dump {
namespace {

using fields::FogSamples;

// What every brick of the grid, an empty one too, says of the samples at its corners, against the dense field that they make together.
bool bricksAgree(const Place& place, const StoredLevel& level, const FogSamples& samples, VerifyReport& report) {
  Tally seam(DeepIssue::kFogSeam, place);
  for (std::size_t c = 0; c < level.raw.cells.size(); ++c) {
    const glm::ivec3 brick = positionOf(c, level.grid);
    const bool stored = level.raw.cells[c] & kCellSolid;
    const std::size_t first = stored ? std::size_t{level.raw.cells[c] & kCellSlotMask} * kFogSamples : 0;
    for (int i = 0; i < kFogSamples; ++i) {
      const glm::ivec3 at = brick * kBrickSide + glm::ivec3(i % kFogSide, i / kFogSide % kFogSide, i / (kFogSide * kFogSide));
      if (at.x >= samples.size.x || at.y >= samples.size.y || at.z >= samples.size.z) continue;
      const std::size_t dense = static_cast<std::size_t>(at.x) + static_cast<std::size_t>(samples.size.x) * (static_cast<std::size_t>(at.y) + static_cast<std::size_t>(samples.size.y) * static_cast<std::size_t>(at.z));
      const auto differs = [&](const std::vector<std::uint8_t>& raw, const std::vector<std::uint8_t>& field) {
        return !field.empty() && (stored ? raw[first + static_cast<std::size_t>(i)] : 0) != field[dense];
      };
      if (differs(level.raw.density, samples.density) || differs(level.raw.heat, samples.heat))
        seam.add(brick, at, stored ? "a neighbour holds another value" : "the brick is empty, and a neighbour holds fog at its edge");
    }
  }
  seam.report(report);
  return seam.count() == 0;
}

void checkCells(const Place& place, const StoredLevel& level, const FogSamples& samples, int threads, VerifyReport& report) {
  const RawLevel exact = fields::buildFogLevel(samples, threads);
  Tally untrue(DeepIssue::kFalseEmptiness, place), lesser(DeepIssue::kNotBestEmptiness, place);
  // Bricks agree about their samples, and none that is stored is clear: so the same ones are stored, in the same slots.
  for (std::size_t c = 0; c < exact.cells.size(); ++c) compareCell(level.raw.cells[c], c, exact.cells, level.grid, untrue, lesser);
  untrue.report(report);
  lesser.report(report);
}

void checkSamples(const Place& place, const FogSamples& stored, const FogSamples& right, VerifyReport& report) {
  Tally wrong(DeepIssue::kFogSample, place);
  const auto compare = [&](const char* what, const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (a[i] == b[i]) continue;
      const glm::ivec3 at = positionOf(i, stored.size);
      wrong.add(glm::min(at, latticeSize(PartKind::kFog, stored.size) - 1) / kBrickSide, at, fmt::format("{} {} stored, {} is right", what, a[i], b[i]));
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
    const Place place{index, l};
    const StoredLevel level = readStored(file, place);
    FogSamples samples = fields::fogSamplesOf(level.raw, levelSize(part.size, l));
    if (!bricksAgree(place, level, samples, report)) {
      finer = FogSamples();
      continue;
    }
    if (!finer.density.empty()) {
      const float stored = part.fog->extinction[static_cast<std::size_t>(l)];
      float right = part.fog->extinction[static_cast<std::size_t>(l - 1)];
      checkSamples(place, samples, fields::coarserFog(std::exchange(finer, FogSamples()), right, threads), report);
      // To the rounding of another way to the same mean.
      if (std::abs(stored - right) > 1e-5f * right) {
        Tally wrong(DeepIssue::kFogExtinction, place);
        wrong.add(std::nullopt, std::nullopt, fmt::format("{} stored, {} is right", stored, right));
        wrong.report(report);
      }
    }
    checkCells(place, level, samples, threads, report);
    finer = std::move(samples);
  }
}

std::uint64_t deepFogBytes(std::uint64_t voxels, int channels) {
  // The level and the finer one densely, the cubes between samples, and bricks as stored and as recomputed: 729 bytes for 512 cubes, with room to grow.
  return voxels + static_cast<std::uint64_t>(channels) * (2 * voxels + 5 * voxels);
}

}  // namespace kelp::dump
