// SPDX-License-Identifier: MIT
#include "cli/report_json.h"

#include <algorithm>
#include <set>
#include <system_error>

#include <nlohmann/json.hpp>

#include "kelp/common/console.h"
#include "kelp/common/output_file.h"

namespace kelp::bake_cli {
namespace {

using OrderedJson = nlohmann::ordered_json;

// Make reads spaces as separators, $ as variables, # as comments and : as the end of targets; ninja reads the
// same syntax. A backslash needs no escape, except before an escaped character, where it is doubled.
std::string escapeForMake(const std::filesystem::path& path) {
  std::string escaped;
  std::size_t backslashes = 0;
  for (const char c : path.string()) {
    if (c == ' ' || c == '\t') escaped += std::string(backslashes + 1, '\\');
    if (c == '#' || c == ':') escaped += '\\';
    if (c == '$') escaped += '$';
    escaped += c;
    backslashes = c == '\\' ? backslashes + 1 : 0;
  }
  return escaped;
}

OrderedJson diagnosisJson(const bake::EdgeCounts& diagnosis) {
  return {{"open_edges", diagnosis.open_edges},
          {"split_edges", diagnosis.split_edges},
          {"split_vertices", diagnosis.split_vertices},
          {"cut_edges", diagnosis.cut_edges},
          {"holes", diagnosis.holes}};
}

OrderedJson fitJson(const bake::Report::Fit& fit) {
  if (fit.joint.empty()) return {};
  return {{"mean", fit.mean}, {"p95", fit.p95}, {"max", fit.max}, {"joint", fit.joint}};
}

OrderedJson partJson(const bake::Report::Part& part) {
  OrderedJson json{{"name", part.name},
                   {"parent", part.parent.empty() ? OrderedJson() : OrderedJson(part.parent)},
                   {"parent_at", part.parent_at < 0 ? OrderedJson() : OrderedJson(part.parent_at)},
                   {"empty", part.empty},
                   {"size", {part.size.x, part.size.y, part.size.z}},
                   {"voxel_size", part.voxel_size},
                   {"rig", part.rig_origin},
                   {"bend", toString(part.swept ? Bend::kSweep : Bend::kShear, part.caged)},
                   {"cell", part.cell > 0 ? OrderedJson(part.cell) : OrderedJson()},
                   {"roll", rollInDegrees(part.roll)},
                   {"sockets", part.sockets},
                   {"fill", part.fill},
                   {"closed", part.closed},
                   {"triangles", part.triangles},
                   {"solid_voxels", part.solid_voxels},
                   {"surface_voxels", part.surface_voxels},
                   {"fog", part.fog},
                   {"fog_voxels", part.fog_voxels},
                   {"bricks", part.bricks}};
  json["mesh"] = {{"vertices", part.mesh.vertices},
                  {"triangles", part.mesh.triangles},
                  {"boundary_edges", part.mesh.boundary_edges},
                  {"boundaries", part.mesh.boundaries},
                  {"non_manifold_edges", part.mesh.non_manifold_edges},
                  {"dropped_triangles", part.mesh.dropped}};
  json["repairs"] = {{"components", part.repairs.components},
                     {"closed_components", part.repairs.closed},
                     {"capped_components", part.repairs.capped},
                     {"sheets", part.repairs.sheets},
                     {"walls", part.repairs.walls},
                     {"doubled_triangles", part.repairs.doubled},
                     {"turned_triangles", part.repairs.turned},
                     {"cap_triangles", part.repairs.cap_triangles},
                     {"kept_voxels", part.repairs.kept_voxels}};
  json["repairs"].update(diagnosisJson(part.repairs.diagnosis));
  json["components"] = OrderedJson::array();
  for (const bake::ComponentReport& c : part.components) {
    json["components"].push_back(
        {{"triangles", c.triangles}, {"surface_share", c.surface_share}, {"solid", c.solid}, {"why", c.why}});
    json["components"].back().update(diagnosisJson(c.diagnosis));
  }
  json["fit"] = fitJson(part.fit);
  return json;
}

OrderedJson filesJson(const bake::FilesUsed& used) {
  OrderedJson files = OrderedJson::array();
  for (const bake::FilesUsed::File& file : used.read) {
    std::error_code error;
    const std::uintmax_t bytes = std::filesystem::file_size(file.path, error);
    files.push_back({{"name", file.path.string()}, {"bytes", error ? OrderedJson() : OrderedJson(bytes)}});
  }
  return files;
}

}  // namespace

std::string reportJson(const Options& options, const bake::Report& report, const Containment& containment,
                       double seconds) {
  OrderedJson json;
  json["schema"] = "kelp-bake-report/1";
  json["kelp-bake"] = KELP_VERSION;
  json["input"] = options.input.string();
  json["output"] = options.output.string();
  json["format"] = report.format;
  json["files"] = filesJson(report.files);
  json["materials"] = report.materials;
  json["images"] = report.images;
  json["parts"] = OrderedJson::array();
  for (const bake::Report::Part& part : report.parts) json["parts"].push_back(partJson(part));
  json["clips"] = OrderedJson::array();
  for (const bake::Report::Clip& clip : report.clips)
    json["clips"].push_back({{"name", clip.name},
                             {"part", clip.part},
                             {"duration", clip.duration},
                             {"leaves_box", clip.leaves_box},
                             {"bends", clip.bends},
                             {"moves", clip.moves},
                             {"fit", fitJson(clip.fit)}});
  json["stages"] = OrderedJson::array();
  for (const bake::Report::Stage& stage : report.stages)
    json["stages"].push_back(
        {{"name", stage.name}, {"seconds", stage.seconds}, {"peak_bytes", stage.peak_bytes}});
  json["notices"] = report.notices;
  json["palette_entries"] = report.palette_entries;
  if (!report.palette_materials.empty()) json["palette_materials"] = report.palette_materials;
  json["palette_error"] = report.palette_error;
  json["estimated_bytes"] = report.estimated_bytes;
  json["pack_bytes"] = report.pack_bytes;
  json["pack_xxh128"] = report.pack_hash;
  json["containment"] = {{"landlock", containment.landlock}, {"seccomp", containment.seccomp}};
  json["seconds"] = seconds;
  return console::escapeControls(json.dump(2, ' ', false, OrderedJson::error_handler_t::replace) + "\n");
}

void checkDependencies(const Options& options, const bake::FilesUsed& files) {
  const auto check = [](const std::filesystem::path& path) {
    if (path.string().find_first_of("\n\r") != std::string::npos)
      throw ToolError(Exit::kIo, console::oneLine(path.string()) +
                                     ": has a line break in its name, and no make rule can name "
                                     "it; rename it, or leave -MD and -MF out");
  };
  check(options.input);
  check(options.output);
  for (const bake::FilesUsed::File& file : files.read) check(file.path);
}

void writeDependencies(const std::filesystem::path& path, const Options& options,
                       const bake::FilesUsed& files) {
  std::set<std::filesystem::path> others;  // in one order, whether they were read or looked up
  for (const bake::FilesUsed::File& file : files.read)
    if (file.path != options.input) others.insert(file.path);
  std::vector<std::string> names;
  names.reserve(others.size());
  for (const std::filesystem::path& file : others) names.push_back(escapeForMake(file));
  const std::string input = escapeForMake(options.input);
  std::string rule = options.deps_target.value_or(escapeForMake(options.output)) + ": \\\n  " + input;
  for (const std::string& name : names) rule += " \\\n  " + name;
  rule += "\n";
  // As compilers write them: all but the input, whose absence is an error.
  if (options.phony_deps)
    for (const std::string& name : names) rule += "\n" + name + ":\n";
  writeTextFile(path, rule);
}

}  // namespace kelp::bake_cli
