// SPDX-License-Identifier: MIT
#include "kelp/import/core/memory_estimate.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "kelp/common/error.h"
#include "kelp/common/memory.h"
#include "kelp/fields/fields.h"
#include "kelp/formats/fog.h"
#include "kelp/import/core/frame.h"
#include "kelp/import/core/source_model.h"

namespace kelp::bake {

PartSize volumeSize(const glm::ivec3& size, const glm::ivec3& pad, double surface_voxels,
                    double solid_voxels) {
  PartSize result{size + 2 * pad, 0, 0, surface_voxels, surface_voxels / 64, solid_voxels};
  result.volume_voxels = static_cast<double>(size.x) * size.y * size.z;
  return result;
}

PartSize fogSize(const glm::ivec3& size, const glm::ivec3& pad, bool heat) {
  PartSize result = volumeSize(size, pad, 0, 0);
  result.fog_channels = heat ? 2 : 1;
  return result;
}

std::uint64_t estimateMemory(std::span<const PartSize> parts, std::uint64_t image_bytes) {
  // Measured on real files (see the README of this folder). Bytes for each triangle and for each vertex:
  // as they were read, while the mesh is analysed; for each triangle with its hierarchy. Bytes while the
  // surface is found: a bit for each voxel, and for each surface voxel; while it is sampled, and while levels
  // are built: for each surface voxel. Bricks within the band of distances for each brick that the surface
  // passes through. The process that bakes takes some memory of its own, the one that watches it and reads
  // the pack back more, which is the least.
  constexpr double kProgram = 12e6, kWatching = 41e6, kTriangle = 36, kVertex = 46, kAnalysing = 95,
                   kAnalysingVertex = 190, kHierarchy = 140, kFinding = 36, kSampling = 32, kLeveling = 36,
                   kBricksOfBand = 3;
  // Reductions of images hold a third as many texels, each four times as large.
  double kept = kProgram + static_cast<double>(image_bytes) * (1 + 4.0 / 3);
  for (const PartSize& part : parts)
    kept += static_cast<double>(part.triangles) * kTriangle + static_cast<double>(part.vertices) * kVertex;
  double peak = kept;
  const auto gridBytes = [](const PartSize& part) {
    if (part.fog_channels > 0) return part.voxels() * part.fog_channels * sizeof(std::uint16_t);
    return part.voxels() + part.surface_voxels * sizeof(SurfaceSample);
  };
  const auto bitsOf = [](const PartSize& part) {
    return static_cast<double>(fields::SolidBits::bytes(part.size));
  };
  for (const PartSize& part : parts) {
    const double triangles = static_cast<double>(part.triangles),
                 analysing = triangles * kAnalysing + static_cast<double>(part.vertices) * kAnalysingVertex;
    if (part.triangles > 0) {
      const double finding = std::max(bitsOf(part) + part.surface_voxels * kFinding,
                                      part.surface_voxels * (sizeof(SurfaceSample) + kSampling));
      peak = std::max({peak, kept + analysing, kept + part.voxels() + analysing + part.scan_bytes,
                       kept + part.voxels() + triangles * kHierarchy + finding});
    }
    kept += gridBytes(part);
    peak = std::max(peak, kept + part.source_bytes);
    // both copies, while it is padded
    peak = std::max(peak, kept + part.volume_voxels * (part.fog_channels > 0 ? sizeof(std::uint16_t) : 1));
  }
  for (const PartSize& part : parts) {
    if (part.fog_channels > 0) {
      // Codes, and a byte a voxel for the cubes that are not clear. At worst all of it becomes bricks.
      const double bricks = part.voxels() / kBrickVoxels;
      peak = std::max(
          peak, kept + part.voxels() * ((part.fog_channels + 1.0)) +
                    static_cast<double>(fields::peakBytes(part.size, static_cast<std::uint64_t>(bricks))));
      kept += bricks * kFogSamples * part.fog_channels - gridBytes(part);
      continue;
    }
    // Bricks that the surface passes through, one half of which is solid, and bricks inside.
    const double bricks =
        part.surface_bricks + std::max(0.0, part.solid_voxels / kBrickVoxels - 0.5 * part.surface_bricks);
    // The voxels become bits before anything else is made.
    peak =
        std::max({peak, kept + bitsOf(part),
                  kept - part.voxels() + part.surface_voxels * kLeveling +
                      static_cast<double>(fields::peakBytes(part.size, static_cast<std::uint64_t>(bricks)))});
    // The level stays.
    kept += bricks * kBrickVoxels + part.surface_voxels * sizeof(std::uint32_t) - gridBytes(part);
    // Distances: the bricks around the surface.
    const double near_bricks = std::min(part.voxels() / kBrickVoxels, kBricksOfBand * part.surface_bricks);
    peak = std::max(peak, kept + near_bricks * kBrickVoxels);
    kept += near_bricks * kBrickVoxels;
  }
  return static_cast<std::uint64_t>(std::max(peak, kWatching));
}

namespace {

// The smallest of 1 to `most` steps with fits(step), by bisection. fits(most) must hold. The last call of
// fits is for the result.
int leastThatFits(int most, const std::function<bool(int)>& fits) {
  int too_little = 0, enough = most;
  while (enough - too_little > 1) {
    const int middle = too_little + (enough - too_little) / 2;
    (fits(middle) ? enough : too_little) = middle;
  }
  fits(enough);
  return enough;
}

// "--resolution 100 would fit", with the smallest change that does; empty if none does. A step is a voxel
// along the longest side, or a hundredth of a voxel's edge.
std::string largestThatFits(const std::function<std::uint64_t(const ImportSettings&)>& need,
                            const ImportSettings& settings, int resolution, std::uint64_t limit) {
  constexpr double kStep = 1.01;
  constexpr int kSteps = 1200;  // beyond a hundred thousand times as long
  ImportSettings changed = settings;
  const auto fits = [&](int step) {
    if (settings.voxel_size) {
      // Rounded as it will be printed.
      changed.voxel_size = std::stod(fmt::format("{:.4g}", *settings.voxel_size * std::pow(kStep, step)));
      if (*changed.voxel_size <= *settings.voxel_size || *changed.voxel_size > kLargestVoxel) return false;
    } else {
      changed.resolution = resolution - step;
      changed.resolution_given = true;
    }
    return need(changed) <= limit;
  };
  const int most = settings.voxel_size ? kSteps : resolution - 1;
  if (most < 1 || !fits(most)) return "";
  leastThatFits(most, fits);
  return settings.voxel_size ? fmt::format("--voxel-size {:.4g} would fit", *changed.voxel_size)
                             : fmt::format("--resolution {} would fit", changed.resolution);
}

}  // namespace

std::uint64_t requireMemory(std::span<const PartSize> parts,
                            const std::function<std::vector<PartSize>(const ImportSettings&)>& sizes,
                            std::uint64_t image_bytes, const ImportSettings& settings, int resolution,
                            const std::filesystem::path& input) {
  const std::uint64_t limit = settings.max_memory > 0 ? settings.max_memory : physicalMemory();
  const auto need = [&](const ImportSettings& changed) {
    return estimateMemory(sizes(changed), image_bytes);
  };
  const std::uint64_t estimate = estimateMemory(parts, image_bytes);
  if (estimate <= limit) return estimate;
  std::string advice = largestThatFits(need, settings, resolution, limit);
  if (settings.pad > 0) {
    ImportSettings bare = settings;
    bare.pad = 0;
    if (need(bare) <= limit) {
      const int pad = leastThatFits(settings.pad, [&](int less) {
        bare.pad = settings.pad - less;
        return need(bare) <= limit;
      });
      advice += fmt::format("{}--pad {} would fit", advice.empty() ? "" : ", or ", settings.pad - pad);
    } else if (advice.empty()) {
      advice = largestThatFits(need, bare, resolution, limit);
      if (!advice.empty())
        advice = fmt::format("no resolution would fit with --pad {}; without it {}", settings.pad, advice);
    }
  }
  advice = advice.empty() ? "no resolution would fit: the file itself is too large" : advice + "; take that";
  throw ToolError(
      Exit::kRuntime,
      fmt::format("{}: baking needs about {} of memory, {} is the limit ({}); {}, or raise --max-memory",
                  input.filename().string(), printBytes(estimate), printBytes(limit),
                  settings.max_memory > 0 ? "--max-memory" : "this machine's memory", advice));
}

}  // namespace kelp::bake
