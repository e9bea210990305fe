// SPDX-License-Identifier: MIT
#include "info_json.h"

#include <algorithm>
#include <optional>

#include <nlohmann/json.hpp>

#include "hash_file.h"

namespace kelp::bake {

namespace {

// The rig from outside the input, if it came from a file.
std::optional<std::filesystem::path> rigFile(const std::filesystem::path& input, const Settings& settings, const std::vector<std::filesystem::path>& files_read) {
  if (settings.rig_file) return settings.rig_file;
  std::filesystem::path beside = input;
  beside.replace_extension(".rig.json");
  if (std::find(files_read.begin(), files_read.end(), beside) == files_read.end()) return std::nullopt;
  return beside;
}

}  // namespace

std::string makeInfo(const std::filesystem::path& input, const std::string& format, bool volume, const Settings& settings, const std::vector<std::filesystem::path>& files_read) {
  nlohmann::ordered_json options;
  if (settings.voxel_size) {
    options["voxel_size"] = *settings.voxel_size;
  } else if (settings.resolution_given || !volume) {  // a volume keeps its own voxels unless told otherwise
    options["resolution"] = settings.resolution;
  }
  if (settings.axis) options["axis"] = toString(*settings.axis);
  if (settings.up) options["up"] = toString(*settings.up);
  if (settings.unit != 1) options["unit"] = settings.unit;
  if (settings.pad > 0) options["pad"] = settings.pad;
  if (const auto rig = rigFile(input, settings, files_read)) options["rig"] = {{"name", rig->filename().string()}, {"xxh3", hashFile(*rig)}};
  if (settings.rig_preset) options["rig"] = *settings.rig_preset;
  if (settings.scene) options["scene"] = *settings.scene;
  options["fill"] = settings.fill == Fill::kAuto ? "auto" : settings.fill == Fill::kSolid ? "solid" : "surface";
  if (settings.parts == Parts::kNodes) options["parts"] = "nodes";
  if (settings.frame) options["frame"] = *settings.frame;
  if (settings.at) options["at"] = {{"clip", settings.at->clip}, {"seconds", settings.at->seconds}};
  if (settings.palette_file) options["palette"] = {{"name", settings.palette_file->filename().string()}, {"xxh3", hashFile(*settings.palette_file)}};
  if (settings.keep_materials) options["keep_materials"] = true;
  if (settings.grid) options["grid"] = *settings.grid;
  if (settings.volume != VolumeKind::kAuto) options["volume"] = settings.volume == VolumeKind::kSolid ? "solid" : "fog";
  if (settings.isovalue) options["isovalue"] = *settings.isovalue;
  if (settings.color_grid) options["color_grid"] = *settings.color_grid;
  if (settings.heat_grid) options["heat_grid"] = *settings.heat_grid;
  if (settings.density != 1) options["density"] = settings.density;
  if (settings.ramp_file) options["ramp"] = {{"name", settings.ramp_file->filename().string()}, {"xxh3", hashFile(*settings.ramp_file)}};
  if (settings.levels > 0) options["levels"] = settings.levels;
  const nlohmann::ordered_json info = {{"tool", "kelp-bake " KELP_VERSION},
                                       {"source", {{"name", input.filename().string()}, {"format", format}, {"xxh3", hashFile(input)}}},
                                       {"options", options}};
  // A name that is not UTF-8 must not stop the bake.
  return info.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace kelp::bake
