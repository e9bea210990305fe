// SPDX-License-Identifier: MIT
#include <algorithm>
#include <map>
#include <optional>

#include <nlohmann/json.hpp>

#include "kelp/common/hash.h"
#include "steps.h"

namespace kelp::bake {

namespace {

using OrderedJson = nlohmann::ordered_json;

const std::string* findHash(const FilesUsed& used, const std::filesystem::path& path) {
  const auto file = std::find_if(used.read.begin(), used.read.end(),
                                 [&](const FilesUsed::File& f) { return f.path == path; });
  return file == used.read.end() ? nullptr : &file->xxh3;
}

std::string hashOf(const FilesUsed& used, const std::filesystem::path& path) {
  const std::string* hash = findHash(used, path);
  return hash ? *hash : hashFile(path);
}

OrderedJson fileJson(const FilesUsed& used, const std::filesystem::path& path) {
  return {{"name", path.filename().string()}, {"xxh3", hashOf(used, path)}};
}

// The rig from outside the input, if it came from a file.
std::optional<std::filesystem::path> rigFile(const std::filesystem::path& input, const Settings& settings,
                                             const FilesUsed& used) {
  if (settings.rig_file) return settings.rig_file;
  const std::filesystem::path beside = rigBeside(input);
  if (!findHash(used, beside)) return std::nullopt;
  return beside;
}

// Files that neither the source nor the options name: pictures, buffers, materials. Sorted by name.
std::map<std::string, OrderedJson> otherFiles(const std::filesystem::path& input, const Settings& settings,
                                              const FilesUsed& used) {
  std::map<std::string, OrderedJson> files;
  const auto add = [&](const std::filesystem::path& path, const OrderedJson& value) {
    if (path == input || path == settings.rig_file || path == settings.palette_file ||
        path == settings.ramp_file || path == rigBeside(input))
      return;
    files[path.lexically_relative(input.parent_path()).generic_string()] = value;
  };
  for (const std::filesystem::path& path : used.missing) add(path, nullptr);
  for (const FilesUsed::File& file : used.read) add(file.path, file.xxh3);
  return files;
}

// The axes of rigs in their nodes, of parts whose places tell another one (RiggedPack).
void noteAxes(const SourceModel& model, const RawPack& pack, OrderedJson& info) {
  for (std::size_t i = 0; i < pack.parts.size(); ++i) {
    const RawPart& part = pack.parts[i];
    const Axis axis = model.parts[i].rig.axis.value_or(Axis::kPlusY);
    if (axis != axisByPlace(part.to_object, part.pivot).value_or(Axis::kPlusY))
      info["axes"][part.name] = toString(axis);
  }
}

OrderedJson sourceJson(const std::filesystem::path& input, const std::string& format,
                       const std::string& xxh3) {
  return {{"tool", "kelp-bake " KELP_VERSION},
          {"source", {{"name", input.filename().string()}, {"format", format}, {"xxh3", xxh3}}}};
}

// A name that is not UTF-8 must not stop the bake.
std::string print(const OrderedJson& json) {
  return json.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
}

}  // namespace

std::string sourceInfo(const std::filesystem::path& input, const std::string& format,
                       const std::string& xxh3) {
  std::string text = print(sourceJson(input, format, xxh3));
  text.back() = ',';
  return text;
}

std::filesystem::path rigBeside(const std::filesystem::path& input) {
  std::filesystem::path beside = input;
  return beside.replace_extension(".rig.json");
}

std::string makeInfo(const std::filesystem::path& input, const SourceModel& model, const RawPack& pack,
                     bool volume, const Settings& settings, const FilesUsed& used) {
  OrderedJson options;
  if (settings.voxel_size) {
    options["voxel_size"] = *settings.voxel_size;
  } else if (!volume || (settings.resolution_given && model.format != "MagicaVoxel")) {
    // a volume keeps its own voxels unless told otherwise; a MagicaVoxel model in any case
    options["resolution"] = settings.resolution;
  }
  if (settings.axis) options["axis"] = toString(*settings.axis);
  if (settings.up) options["up"] = toString(*settings.up);
  if (settings.unit != 1) options["unit"] = settings.unit;
  if (settings.pad > 0) options["pad"] = settings.pad;
  if (const auto rig = rigFile(input, settings, used)) options["rig"] = fileJson(used, *rig);
  if (settings.rig_preset) options["rig"] = *settings.rig_preset;
  if (settings.bend) options["bend"] = toString(*settings.bend, settings.caged);
  if (settings.cell) options["cell"] = *settings.cell;
  if (settings.scene) options["scene"] = *settings.scene;
  options["fill"] = settings.fill == Fill::kAuto    ? "auto"
                    : settings.fill == Fill::kSolid ? "solid"
                                                    : "surface";
  if (settings.parts == Parts::kNodes) options["parts"] = "nodes";
  if (settings.keep_culled) options["keep_culled"] = true;
  if (settings.frame) options["frame"] = *settings.frame;
  if (settings.at) options["at"] = {{"clip", settings.at->clip}, {"seconds", settings.at->seconds}};
  if (settings.palette_file) options["palette"] = fileJson(used, *settings.palette_file);
  if (settings.keep_materials) options["keep_materials"] = true;
  if (settings.grid) options["grid"] = *settings.grid;
  if (settings.volume != VolumeKind::kAuto)
    options["volume"] = settings.volume == VolumeKind::kSolid ? "solid" : "fog";
  if (settings.isovalue) options["isovalue"] = *settings.isovalue;
  if (settings.color_grid) options["color_grid"] = *settings.color_grid;
  if (settings.heat_grid) options["heat_grid"] = *settings.heat_grid;
  if (settings.density != 1) options["density"] = settings.density;
  if (settings.ramp_file) options["ramp"] = fileJson(used, *settings.ramp_file);
  if (settings.levels > 0) options["levels"] = settings.levels;
  options["distance"] = settings.distance;
  if (settings.effort == Effort::kBest) options["effort"] = "best";
  OrderedJson info = sourceJson(input, model.format, hashOf(used, input));
  info["options"] = options;
  for (const auto& [name, hash] : otherFiles(input, settings, used)) info["files"][name] = hash;
  if (pack.parts.size() > 1 || settings.parts == Parts::kNodes) noteAxes(model, pack, info);
  if (!pack.parts.front().influences.empty() && model.parts.front().rig.sides.empty()) {
    // The parts that move by the rig file and not by the skin.
    OrderedJson& rigs = info["skin"]["rigs"] = OrderedJson::array();
    for (const SourcePart& part : model.parts)
      if (model.outer && model.outer->file.find(part.name)) rigs.push_back(part.name);
  }
  return print(info);
}

}  // namespace kelp::bake
