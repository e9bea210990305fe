// SPDX-License-Identifier: MIT
#include "summary.h"

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>

namespace kelp::bake_cli {
namespace {

std::string printBytes(std::uint64_t bytes) {
  const double kib = static_cast<double>(bytes) / 1024.0;
  return kib < 1024 ? fmt::format("{:.1f} KiB", kib) : kib < 1024 * 1024 ? fmt::format("{:.1f} MiB", kib / 1024) : fmt::format("{:.2f} GiB", kib / (1024 * 1024));
}

// Only glTF says what a length of 1 means.
std::string printLength(double length, const std::string& format) {
  return fmt::format("{:.4g} {}", length, format.rfind("glTF", 0) == 0 ? "m" : length == 1 ? "unit" : "units");
}

// What the largest part's longest side has in voxels depends on this; so say where it came from.
std::string printGrain(const Options& options, const std::string& format) {
  if (options.settings.voxel_size) return "voxels of " + printLength(*options.settings.voxel_size, format);
  return fmt::format("resolution {}{}", options.settings.resolution, options.settings.resolution_given ? "" : " (default; --resolution N to change)");
}

}  // namespace

void printSummary(const Options& options, const bake::Report& report, double seconds) {
  std::uint64_t triangles = 0, surface = 0;
  for (const bake::Report::Part& part : report.parts) {
    triangles += part.triangles;
    surface += part.surface_voxels;
  }
  fmt::print(stderr, "kelp-bake: {}: {}, {} part{}", options.input.filename().string(), report.format, report.parts.size(), report.parts.size() == 1 ? "" : "s");
  if (triangles > 0) fmt::print(stderr, ", {} triangle{}", triangles, triangles == 1 ? "" : "s");
  fmt::print(stderr, ", {}\n", triangles > 0 || options.settings.voxel_size || options.settings.resolution_given ? printGrain(options, report.format) : "the volume's own voxels (--resolution N to change)");
  for (const bake::Report::Part& part : report.parts) {
    fmt::print(stderr, "  part '{}': {} x {} x {} voxels of {}; rig: {}; {}\n", part.name, part.size.x, part.size.y, part.size.z, printLength(part.voxel_size, report.format), part.rig_origin, part.fill);
  }
  for (const bake::Report::Clip& clip : report.clips) {
    fmt::print(stderr, "  clip '{}' of '{}': {:.3g} s, ", clip.name, clip.part, clip.duration);
    if (clip.leaves_box > 0) {
      fmt::print(stderr, "leaves the box at rest by up to {:.0f} % of the part's length\n", std::max(1.0, 100.0 * static_cast<double>(clip.leaves_box)));
    } else {
      std::fputs("stays within the box\n", stderr);
    }
  }
  for (const std::string& notice : report.notices) fmt::print(stderr, "kelp-bake: warning: {}\n", notice);
  if (report.palette_error > 0) fmt::print(stderr, "  more than 256 materials: the palette is off by {:.4f} in the mean (OKLab)\n", report.palette_error);
  fmt::print(stderr, "kelp-bake: wrote {}: {}, {} surface voxel{}, in {:.2f} s\n", options.output.string(), printBytes(report.pack_bytes), surface, surface == 1 ? "" : "s", seconds);
}

}  // namespace kelp::bake_cli
