// SPDX-License-Identifier: MIT
#include "report_json.h"

#include <system_error>

#include <nlohmann/json.hpp>

namespace kelp::bake_cli {
namespace {

using Json = nlohmann::ordered_json;

// Make reads spaces as separators, $ as variables and # as comments.
std::string escapeForMake(const std::filesystem::path& path) {
  std::string escaped;
  for (const char c : path.string()) {
    if (c == ' ' || c == '#' || c == '\\') escaped += '\\';
    if (c == '$') escaped += '$';
    escaped += c;
  }
  return escaped;
}

Json partJson(const bake::Report::Part& part) {
  Json json{{"name", part.name},
            {"parent", part.parent.empty() ? Json() : Json(part.parent)},
            {"carrier", part.carrier},
            {"size", {part.size.x, part.size.y, part.size.z}},
            {"voxel_size", part.voxel_size},
            {"rig", part.rig_origin},
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
  json["components"] = Json::array();
  for (const bake::Report::Component& c : part.components) {
    json["components"].push_back({{"triangles", c.triangles}, {"surface_share", c.surface_share}, {"solid", c.solid}, {"why", c.why}});
  }
  return json;
}

Json filesJson(const bake::Report& report) {
  Json files = Json::array();
  for (const bake::FilesUsed::File& file : report.files.read) {
    std::error_code error;
    const std::uintmax_t bytes = std::filesystem::file_size(file.path, error);
    files.push_back({{"name", file.path.string()}, {"bytes", error ? Json() : Json(bytes)}});
  }
  return files;
}

}  // namespace

void writeReport(const std::filesystem::path& path, const Options& options, const bake::Report& report, double seconds) {
  Json json;
  json["schema"] = "kelp-bake-report/1";
  json["kelp-bake"] = KELP_VERSION;
  json["input"] = options.input.string();
  json["output"] = options.output.string();
  json["format"] = report.format;
  json["files"] = filesJson(report);
  json["materials"] = report.materials;
  json["images"] = report.images;
  json["parts"] = Json::array();
  for (const bake::Report::Part& part : report.parts) json["parts"].push_back(partJson(part));
  json["clips"] = Json::array();
  for (const bake::Report::Clip& clip : report.clips)
    json["clips"].push_back({{"name", clip.name}, {"part", clip.part}, {"duration", clip.duration}, {"leaves_box", clip.leaves_box}, {"bends", clip.bends}, {"moves", clip.moves}});
  json["stages"] = Json::array();
  for (const bake::Report::Stage& stage : report.stages) json["stages"].push_back({{"name", stage.name}, {"seconds", stage.seconds}, {"peak_bytes", stage.peak_bytes}});
  json["notices"] = report.notices;
  json["palette_entries"] = report.palette_entries;
  if (!report.palette_materials.empty()) json["palette_materials"] = report.palette_materials;
  json["palette_error"] = report.palette_error;
  json["estimated_bytes"] = report.estimated_bytes;
  json["pack_bytes"] = report.pack_bytes;
  json["seconds"] = seconds;
  bake::writeTextFile(path, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

void writeDependencies(const std::filesystem::path& path, const Options& options, const bake::Report& report) {
  std::string rule = escapeForMake(options.output) + ":";
  for (const bake::FilesUsed::File& file : report.files.read) rule += " \\\n  " + escapeForMake(file.path);
  for (const std::filesystem::path& file : options.option_files) rule += " \\\n  " + escapeForMake(file);
  bake::writeTextFile(path, rule + "\n");
}

}  // namespace kelp::bake_cli
