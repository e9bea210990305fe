// SPDX-License-Identifier: MIT
#include "kelp/import/core/outer_rig.h"

#include <system_error>

namespace kelp::bake {
namespace {

RigFile readRigFile(const InputFiles& files, const std::filesystem::path& path) {
  const std::vector<std::uint8_t> bytes = files.readFile(path);
  try {
    return parseRigFile({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  } catch (const RigError& error) {
    refuse(Exit::kInvalid, path, "", error.what());
  }
}

std::string nameList() {
  std::string names;
  for (const std::string& name : rigNames()) names += (names.empty() ? "" : ", ") + name;
  return names;
}

std::optional<OuterRig> readOuterRig(const InputFiles& files, const ImportSettings& settings) {
  std::filesystem::path beside = files.input();
  beside.replace_extension(".rig.json");
  std::error_code error;
  if (settings.rig_file) {
    if (!std::filesystem::exists(*settings.rig_file, error))
      refuse(Exit::kIo, *settings.rig_file, "",
             "there is no such rig file, nor a preset of that name (" + nameList() + "); check the path");
    return OuterRig{readRigFile(files, *settings.rig_file),
                    "rig file " + settings.rig_file->filename().string()};
  }
  if (settings.rig_preset == kSkinRig) return std::nullopt;
  if (settings.rig_preset) {
    std::optional<RigDescription> preset = presetRig(*settings.rig_preset, settings.axis, settings.up);
    if (!preset) {
      throw ToolError(Exit::kUsage, "there is no rig preset '" + oneLine(*settings.rig_preset, 60) +
                                        "'; choose one of " + nameList());
    }
    const std::string unread = std::filesystem::is_regular_file(beside, error)
                                   ? ", not " + beside.filename().string() + " beside the input"
                                   : "";
    return OuterRig{{*std::move(preset), {}}, "preset '" + *settings.rig_preset + "'" + unread};
  }
  if (!files.isThere(beside)) return std::nullopt;
  return OuterRig{readRigFile(files, beside), beside.filename().string() + " beside the input"};
}

}  // namespace

std::vector<std::string> rigNames() {
  std::vector<std::string> names = presetNames();
  names.emplace_back(kSkinRig);
  return names;
}

std::string PartNames::take(const std::string& wanted) {
  std::string name = wanted;
  while (!taken_.insert(name).second)
    name = wanted + "." + std::to_string(++suffix_.try_emplace(wanted, 1).first->second);
  return name;
}

std::string stemOf(const InputFiles& files) { return oneLine(files.input().stem().string(), 80); }

std::optional<OuterRig> findOuterRig(const InputFiles& files, const ImportSettings& settings) {
  std::optional<OuterRig> outer = readOuterRig(files, settings);
  if (outer && outer->isWhole() && settings.parts == Parts::kNodes)
    throw ToolError(Exit::kUsage, "--parts nodes: the rig (" + outer->origin +
                                      ") is one for the whole file; leave --parts out, or give each part its "
                                      "own by name: {\"kelp\": 1, \"parts\": {\"NAME\": {...}}}");
  return outer;
}

void giveRig(SourcePart& part, const std::optional<OuterRig>& outer, const ImportSettings& settings) {
  const RigDescription* const rig = !outer             ? nullptr
                                    : outer->isWhole() ? &outer->file.whole
                                                       : outer->file.find(part.name);
  if (rig) {
    part.rig = *rig;
    part.rig_origin = outer->origin;
  } else if (part.rig_origin.empty()) {
    part.rig_origin = "straight (no rig found)";
  }
  if (!settings.axis) {
    if (!part.rig.axis) part.rig.axis = settings.up;  // models that stand bend along their height
    return;
  }
  // The rig's offsets and tangents are at right angles to its own axis: about another axis they would mean
  // something else.
  if (part.rig.axis && *part.rig.axis != *settings.axis)
    throw ToolError(Exit::kUsage, std::string("--axis ") + toString(*settings.axis) + ": the rig (" +
                                      part.rig_origin + ") names the axis " + toString(*part.rig.axis) +
                                      " itself; leave --axis out, or take \"axis\" out of the rig");
  part.rig.axis = settings.axis;
}

}  // namespace kelp::bake
