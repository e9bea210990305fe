// SPDX-License-Identifier: MIT
#include "cli/messages.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "kelp/common/console.h"
#include "kelp/common/memory.h"

namespace kelp::bake_cli {
namespace {

using OrderedJson = nlohmann::ordered_json;

bool g_json = false;

std::string lineOf(OrderedJson json, std::string_view before, std::string_view text) {
  const std::string line = console::oneLine(std::string(text));
  if (!g_json) return std::string(before) + line;
  json["text"] = line;
  return console::escapeControls(json.dump(-1, ' ', false, OrderedJson::error_handler_t::replace));
}

// Prints the whole line at once: other processes may write to the same file.
void put(const std::string& line) {
  std::fputs((line + '\n').c_str(), stderr);
  std::fflush(stderr);
}

void say(const char* kind, std::string_view before, std::string_view text) {
  put(lineOf({{"kind", kind}}, before, text));
}

// Lengths are meters only in glTF or with --unit.
std::string printLength(double length, const Options& options, const std::string& format) {
  return fmt::format("{:.4g} {}", length,
                     options.unit_given || format.rfind("glTF", 0) == 0 ? "m"
                     : length == 1                                      ? "unit"
                                                                        : "units");
}

// For a volume that was not resampled.
const char* keptVoxels(const std::string& format) {
  return format == "MagicaVoxel" || format == "binvox"
             ? "the file's own voxels"
             : "voxels as large as the volume's own (--resolution N to change)";
}

// Prints where the resolution came from.
std::string printGrain(const Options& options, const std::string& format) {
  if (options.settings.voxel_size)
    return "voxels of " + printLength(*options.settings.voxel_size, options, format);
  return fmt::format("resolution {}{}", options.settings.resolution,
                     options.settings.resolution_given ? "" : " (default; --resolution N to change)");
}

std::string counted(std::uint64_t count, const std::string& one, const std::string& many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}
std::string counted(std::uint64_t count, const std::string& what) { return counted(count, what, what + "s"); }

// A mesh's faults and their repairs; empty without faults.
std::string printRepairs(const bake::Report::Part& part) {
  std::vector<std::string> words;
  const bake::MeshCounts& mesh = part.mesh;
  if (mesh.boundary_edges > 0)
    words.push_back(counted(mesh.boundary_edges, "boundary edge") + " in " +
                    counted(mesh.boundaries, "loop"));
  if (mesh.non_manifold_edges > 0)
    words.push_back(counted(mesh.non_manifold_edges, "edge") + " of more than two triangles");
  const bake::EdgeCounts& diagnosis = part.repairs.diagnosis;
  if (diagnosis.split_vertices > 0)
    words.push_back(counted(diagnosis.split_vertices, "vertex", "vertices") + " split where parts touch");
  if (diagnosis.cut_edges > 0)
    words.push_back("a surface with one side cut along " + counted(diagnosis.cut_edges, "edge"));
  if (part.repairs.turned > 0) words.push_back(counted(part.repairs.turned, "triangle") + " turned");
  if (mesh.dropped + part.repairs.doubled > 0)
    words.push_back(counted(mesh.dropped + part.repairs.doubled, "triangle") +
                    " dropped (doubled, or without an area)");
  return fmt::format("{}", fmt::join(words, ", "));
}

// "; sockets: 'hand', 'tip'", or nothing.
std::string printSockets(const std::vector<std::string>& sockets) {
  constexpr std::size_t kShown = 8;
  std::string text;
  for (std::size_t i = 0; i < sockets.size() && i < kShown; ++i)
    text += fmt::format("{}'{}'", i == 0 ? "; sockets: " : ", ", sockets[i]);
  return sockets.size() > kShown ? text + fmt::format(" and {} more", sockets.size() - kShown) : text;
}

// The largest parts one by one, the others together.
void printParts(const Options& options, const bake::Report& report) {
  constexpr std::size_t kShown = 12;
  std::vector<const bake::Report::Part*> parts;
  for (const bake::Report::Part& part : report.parts)
    if (!part.empty) parts.push_back(&part);
  const std::size_t shown = std::min(parts.size(), kShown);
  if (shown < parts.size())
    std::stable_sort(parts.begin(), parts.end(), [](const auto* a, const auto* b) {
      return a->solid_voxels + a->fog_voxels > b->solid_voxels + b->fog_voxels;
    });
  for (std::size_t i = 0; i < shown; ++i) {
    const bake::Report::Part& part = *parts[i];
    sayDetail(fmt::format("part '{}': {} x {} x {} voxels of {}; rig: {}{}; {}", part.name, part.size.x,
                          part.size.y, part.size.z, printLength(part.voxel_size, options, report.format),
                          part.rig_origin, printSockets(part.sockets), part.fill));
    if (const std::string repairs = printRepairs(part); !repairs.empty()) sayDetail("  " + repairs);
  }
  if (shown < parts.size())
    sayDetail(fmt::format("and {} smaller parts; --report FILE.json tells of each", parts.size() - shown));
}

// A clip that only moves parts as wholes is one line; one that bends is a line for each part that it bends.
void printClips(const bake::Report& report) {
  std::map<std::string, std::size_t> moved;
  for (const bake::Report::Clip& clip : report.clips) moved[clip.name] += clip.moves;
  std::set<std::string> told;
  for (const bake::Report::Clip& clip : report.clips) {
    if (clip.bends) {
      const std::string where =
          clip.leaves_box > 0 ? fmt::format("leaves the box at rest by up to {:.0f} % of the part's length",
                                            std::max(1.0, 100.0 * static_cast<double>(clip.leaves_box)))
                              : "stays within the box";
      sayDetail(fmt::format("clip '{}' of '{}': {:.3g} s, {}", clip.name, clip.part, clip.duration, where));
    }
    if (clip.moves && told.insert(clip.name).second)
      sayDetail(fmt::format("clip '{}': {:.3g} s, moves {}", clip.name, clip.duration,
                            counted(moved[clip.name], "part")));
  }
}

// Prints how far a skin's cage is from it, in the worst clip.
void printFit(const bake::Report& report) {
  const bake::Report::Clip* worst = nullptr;
  for (const bake::Report::Clip& clip : report.clips)
    if (!clip.fit.joint.empty() && (!worst || clip.fit.p95 > worst->fit.p95)) worst = &clip;
  if (!worst) return;
  const bake::Report::Fit& fit = worst->fit;
  sayDetail(
      fmt::format("skin: the cage is {:.2f} voxels off its surface in the mean, 95 % of it within "
                  "{:.2f}, all within {:.1f}, in the worst clip ('{}'), at joint '{}'",
                  fit.mean, fit.p95, fit.max, worst->name, fit.joint));
}

}  // namespace

void speakJson() { g_json = true; }

void sayNote(std::string_view text) { say("note", "kelp-bake: ", text); }

void sayDetail(std::string_view text) { say("detail", "  ", text); }

void sayWarning(std::string_view text) { say("warning", "kelp-bake: warning: ", text); }

std::string errorLine(Exit exit, std::string_view text) {
  return lineOf({{"kind", "error"}, {"exit", static_cast<int>(exit)}}, "kelp-bake: ", text);
}

void sayError(Exit exit, std::string_view text) { put(errorLine(exit, text)); }

double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void writeStdout(const std::string& text) {
  if (const std::string problem = console::writeOut(text); !problem.empty())
    throw ToolError(Exit::kIo,
                    "standard output cannot be written: " + problem + "; free space or choose another file");
}

void printEstimate(const Options& options, std::uint64_t bytes) {
  sayNote(fmt::format("{}: baking needs about {} of memory", options.input.filename().string(),
                      printBytes(bytes)));
}

void printSummary(const Options& options, const bake::Report& report, double seconds) {
  std::uint64_t triangles = 0, surface = 0, fog = 0, peak = 0;
  std::size_t parts = 0;
  for (const bake::Report::Part& part : report.parts) {
    triangles += part.triangles;
    surface += part.surface_voxels;
    fog += part.fog_voxels;
    parts += !part.empty;
  }
  std::string line =
      fmt::format("{}: {}, {}", options.input.filename().string(), report.format, counted(parts, "part"));
  if (triangles > 0)
    line += fmt::format(", {}, {}", counted(triangles, "triangle"), counted(report.materials, "material"));
  if (report.images > 0) line += fmt::format(", {}", counted(report.images, "picture"));
  sayNote(line + ", " +
          (triangles > 0 || options.settings.voxel_size ||
                   (options.settings.resolution_given && report.format != "MagicaVoxel")
               ? printGrain(options, report.format)
               : keptVoxels(report.format)));
  printParts(options, report);
  printClips(report);
  printFit(report);
  for (const std::string& notice : report.notices) sayWarning(notice);
  if (report.palette_error > 0) {
    sayDetail(fmt::format("{}: the palette is off by {:.4f} in the mean (OKLab)",
                          options.settings.palette_file ? options.settings.palette_file->filename().string()
                                                        : "more than 256 colors",
                          report.palette_error));
  }
  const bake::Report::Stage* longest = nullptr;
  for (const bake::Report::Stage& stage : report.stages) {
    peak = std::max(peak, stage.peak_bytes);
    if (!longest || stage.seconds > longest->seconds) longest = &stage;
  }
  std::vector<std::string> made;
  if (surface > 0 || fog == 0) made.push_back(counted(surface, "surface voxel"));
  if (fog > 0) made.push_back(counted(fog, "voxel") + " of fog");
  line = fmt::format("wrote {}: {}, {}, in {:.2f} s", options.output.string(), printBytes(report.pack_bytes),
                     fmt::join(made, ", "), seconds);
  if (longest)
    line += fmt::format(" ({} {:.2f} s) and at most {} of memory", longest->name, longest->seconds,
                        printBytes(peak));
  sayNote(line);
}

}  // namespace kelp::bake_cli
