// SPDX-License-Identifier: MIT
#include "summary.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace kelp::bake_cli {
namespace {

// What a length of 1 means only glTF says, or whoever gives the unit.
std::string printLength(double length, const Options& options, const std::string& format) {
  return fmt::format("{:.4g} {}", length, options.unit_given || format.rfind("glTF", 0) == 0 ? "m" : length == 1 ? "unit" : "units");
}

// Of a volume that nobody asked another resolution of.
const char* keptVoxels(const std::string& format) {
  return format == "MagicaVoxel" || format == "binvox" ? "the file's own voxels" : "voxels as large as the volume's own (--resolution N to change)";
}

// What the largest part's longest side has in voxels depends on this; so say where it came from.
std::string printGrain(const Options& options, const std::string& format) {
  if (options.settings.voxel_size) return "voxels of " + printLength(*options.settings.voxel_size, options, format);
  return fmt::format("resolution {}{}", options.settings.resolution, options.settings.resolution_given ? "" : " (default; --resolution N to change)");
}

std::string counted(std::uint64_t count, const char* what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

// What is odd about a mesh and what was done about it; empty for a sound one.
std::string printRepairs(const bake::Report::Part& part) {
  std::vector<std::string> words;
  const bake::MeshCounts& mesh = part.mesh;
  if (mesh.boundary_edges > 0) words.push_back(counted(mesh.boundary_edges, "boundary edge") + " in " + counted(mesh.boundaries, "loop"));
  if (mesh.non_manifold_edges > 0) words.push_back(counted(mesh.non_manifold_edges, "edge") + " of more than two triangles");
  if (part.repairs.turned > 0) words.push_back(counted(part.repairs.turned, "triangle") + " turned");
  if (mesh.dropped + part.repairs.doubled > 0) words.push_back(counted(mesh.dropped + part.repairs.doubled, "triangle") + " dropped (doubled, or without an area)");
  return fmt::format("{}", fmt::join(words, ", "));
}

// The largest parts one by one, the others together.
void printParts(const Options& options, const bake::Report& report) {
  constexpr std::size_t kShown = 12;
  std::vector<const bake::Report::Part*> parts;
  for (const bake::Report::Part& part : report.parts)
    if (!part.carrier) parts.push_back(&part);
  const std::size_t shown = std::min(parts.size(), kShown);
  if (shown < parts.size()) std::stable_sort(parts.begin(), parts.end(), [](const auto* a, const auto* b) { return a->solid_voxels + a->fog_voxels > b->solid_voxels + b->fog_voxels; });
  for (std::size_t i = 0; i < shown; ++i) {
    const bake::Report::Part& part = *parts[i];
    fmt::print(stderr, "  part '{}': {} x {} x {} voxels of {}; rig: {}; {}\n", part.name, part.size.x, part.size.y, part.size.z, printLength(part.voxel_size, options, report.format), part.rig_origin, part.fill);
    if (const std::string repairs = printRepairs(part); !repairs.empty()) fmt::print(stderr, "    {}\n", repairs);
  }
  if (shown < parts.size()) fmt::print(stderr, "  and {} smaller parts; --report FILE.json tells of each\n", parts.size() - shown);
}

// A clip that only moves parts as wholes is one line; one that bends is a line for each part that it bends.
void printClips(const bake::Report& report) {
  std::map<std::string, std::size_t> moved;
  for (const bake::Report::Clip& clip : report.clips) moved[clip.name] += clip.moves;
  std::set<std::string> told;
  for (const bake::Report::Clip& clip : report.clips) {
    if (clip.bends) {
      fmt::print(stderr, "  clip '{}' of '{}': {:.3g} s, ", clip.name, clip.part, clip.duration);
      if (clip.leaves_box > 0) {
        fmt::print(stderr, "leaves the box at rest by up to {:.0f} % of the part's length\n", std::max(1.0, 100.0 * static_cast<double>(clip.leaves_box)));
      } else {
        std::fputs("stays within the box\n", stderr);
      }
    }
    if (clip.moves && told.insert(clip.name).second) fmt::print(stderr, "  clip '{}': {:.3g} s, moves {}\n", clip.name, clip.duration, counted(moved[clip.name], "part"));
  }
}

}  // namespace

std::string oneLine(std::string text) {
  std::replace_if(text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  return text;
}

std::string printBytes(std::uint64_t bytes) {
  const double kib = static_cast<double>(bytes) / 1024.0;
  return kib < 1024 ? fmt::format("{:.1f} KiB", kib) : kib < 1024 * 1024 ? fmt::format("{:.1f} MiB", kib / 1024) : fmt::format("{:.2f} GiB", kib / (1024 * 1024));
}

void writeStdout(const std::string& text) {
  std::fputs(text.c_str(), stdout);
  if (std::fflush(stdout) != 0) throw bake::BakeError(bake::Exit::kIo, "stdout can not be written; choose a file on a disk with space left");
}

void printEstimate(const Options& options, const bake::Report& report) {
  fmt::print(stderr, "kelp-bake: {}: baking needs about {} of memory\n", options.input.filename().string(), printBytes(report.estimated_bytes));
}

void printSummary(const Options& options, const bake::Report& report, double seconds) {
  std::uint64_t triangles = 0, surface = 0, fog = 0, peak = 0;
  std::size_t parts = 0;
  for (const bake::Report::Part& part : report.parts) {
    triangles += part.triangles;
    surface += part.surface_voxels;
    fog += part.fog_voxels;
    parts += !part.carrier;
  }
  fmt::print(stderr, "kelp-bake: {}: {}, {}", options.input.filename().string(), report.format, counted(parts, "part"));
  if (triangles > 0) fmt::print(stderr, ", {}, {}", counted(triangles, "triangle"), counted(report.materials, "material"));
  if (report.images > 0) fmt::print(stderr, ", {}", counted(report.images, "picture"));
  fmt::print(stderr, ", {}\n", triangles > 0 || options.settings.voxel_size || options.settings.resolution_given ? printGrain(options, report.format) : keptVoxels(report.format));
  printParts(options, report);
  printClips(report);
  for (const std::string& notice : report.notices) fmt::print(stderr, "kelp-bake: warning: {}\n", notice);
  if (report.palette_error > 0) {
    fmt::print(stderr, "  {}: the palette is off by {:.4f} in the mean (OKLab)\n", options.settings.palette_file ? options.settings.palette_file->filename().string() : "more than 256 materials", report.palette_error);
  }
  const bake::Report::Stage* longest = nullptr;
  for (const bake::Report::Stage& stage : report.stages) {
    peak = std::max(peak, stage.peak_bytes);
    if (!longest || stage.seconds > longest->seconds) longest = &stage;
  }
  std::vector<std::string> made;
  if (surface > 0 || fog == 0) made.push_back(counted(surface, "surface voxel"));
  if (fog > 0) made.push_back(counted(fog, "voxel") + " of fog");
  fmt::print(stderr, "kelp-bake: wrote {}: {}, {}, in {:.2f} s", options.output.string(), printBytes(report.pack_bytes), fmt::join(made, ", "), seconds);
  if (longest) fmt::print(stderr, " ({} {:.2f} s) and at most {} of memory", longest->name, longest->seconds, printBytes(peak));
  std::fputs("\n", stderr);
}

void printCached(const Options& options, const std::vector<std::string>& notices, std::uint64_t pack_bytes, double seconds) {
  for (const std::string& notice : notices) fmt::print(stderr, "kelp-bake: warning: {}\n", oneLine(notice));
  fmt::print(stderr, "kelp-bake: wrote {} from the cache: {}, in {:.2f} s\n", options.output.string(), printBytes(pack_bytes), seconds);
}

}  // namespace kelp::bake_cli
