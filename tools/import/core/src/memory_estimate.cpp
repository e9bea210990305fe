// SPDX-License-Identifier: MIT
#include "kelp/import/core/memory_estimate.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "kelp/common/error.h"
#include "kelp/common/memory.h"
#include "kelp/import/core/frame.h"

namespace kelp::bake {

std::uint64_t estimateMemory(std::span<const PartSize> parts, std::uint64_t image_bytes) {
  constexpr double kProgram = 32e6, kTriangle = 36, kVertex = 46;
  double kept = 0, work = 0;
  for (const PartSize& part : parts) {
    const double mesh =
        static_cast<double>(part.triangles) * kTriangle + static_cast<double>(part.vertices) * kVertex;
    const double values = part.fog_channels > 0 ? 2 * part.fog_channels : 1;  // bytes of a voxel
    kept += mesh + values * part.voxels() + 40 * part.surface_voxels;
    work =
        std::max(work, 3 * mesh + values * part.voxels() / 2 + 40 * part.surface_voxels + part.source_bytes);
  }
  // Reductions of images hold a third as many texels, each four times as large.
  return static_cast<std::uint64_t>(kProgram + kept + work + static_cast<double>(image_bytes) * 7 / 3);
}

namespace {

// "--resolution 100 would fit", with the smallest change that does; empty if none does. A step is a voxel
// along the longest side, or a hundredth of a voxel's edge.
std::string largestThatFits(const std::function<bool(const ImportSettings&)>& fits,
                            const ImportSettings& settings, int resolution) {
  constexpr double kStep = 1.01;
  constexpr int kSteps = 1200;  // beyond a hundred thousand times as long
  ImportSettings changed = settings;
  const auto fitsAfter = [&](int steps) {
    if (settings.voxel_size) {
      // Rounded as it will be printed.
      changed.voxel_size = std::stod(fmt::format("{:.4g}", *settings.voxel_size * std::pow(kStep, steps)));
      if (*changed.voxel_size <= *settings.voxel_size || *changed.voxel_size > kLargestVoxel) return false;
    } else {
      changed.resolution = resolution - steps;
      changed.resolution_given = true;
    }
    return fits(changed);
  };
  int too_few = 0, enough = settings.voxel_size ? kSteps : resolution - 1;
  if (enough < 1 || !fitsAfter(enough)) return "";
  while (enough - too_few > 1) {
    const int middle = too_few + (enough - too_few) / 2;
    (fitsAfter(middle) ? enough : too_few) = middle;
  }
  fitsAfter(enough);
  return settings.voxel_size ? fmt::format("--voxel-size {:.4g} would fit", *changed.voxel_size)
                             : fmt::format("--resolution {} would fit", changed.resolution);
}

}  // namespace

std::uint64_t requireMemory(std::span<const PartSize> parts,
                            const std::function<std::vector<PartSize>(const ImportSettings&)>& sizes,
                            std::uint64_t image_bytes, const ImportSettings& settings, int resolution,
                            const std::filesystem::path& input) {
  const std::uint64_t limit = settings.max_memory > 0 ? settings.max_memory : physicalMemory();
  const std::uint64_t estimate = estimateMemory(parts, image_bytes);
  if (estimate <= limit) return estimate;
  const auto fits = [&](const ImportSettings& changed) {
    return estimateMemory(sizes(changed), image_bytes) <= limit;
  };
  std::string advice = largestThatFits(fits, settings, resolution);
  if (advice.empty() && settings.pad > 0) {
    ImportSettings bare = settings;
    bare.pad = 0;
    if (fits(bare)) {
      advice = "--pad 0 would fit";
    } else if (advice = largestThatFits(fits, bare, resolution); !advice.empty()) {
      advice = "with --pad 0 " + advice;
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
