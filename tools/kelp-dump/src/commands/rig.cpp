// SPDX-License-Identifier: MIT
#include "kelp/rig/rig.h"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "commands/commands.h"
#include "kelp/rig/raw_clips.h"
#include "pack/pack_file.h"
#include "text/json.h"
#include "text/text.h"

namespace kelp::dump {
namespace {

using Json = nlohmann::ordered_json;

// The rig that divides a skin as the pack's parts do, by what INFO says of them.
struct SkinRig {
  std::optional<RigDescription> rig;
  std::string problem;  // why there is none although INFO speaks of a skin
};

// A part's entry in INFO. Empty if it cannot be read.
std::optional<RigDescription::SkinGroup> groupOf(const Json& part) {
  if (!part.is_object() || !part.contains("joints") || !part.at("joints").is_array()) return std::nullopt;
  RigDescription::SkinGroup group;
  for (const Json& joint : part.at("joints")) {
    if (!joint.is_string()) return std::nullopt;
    group.joints.push_back(joint.get<std::string>());
  }
  if (!part.contains("knots")) return group;
  const Json& knots = part.at("knots");
  if (!knots.is_number_integer() || knots < kMinSkinKnots || knots > kMaxSkinKnots) return std::nullopt;
  group.knots = knots.get<int>();
  return group;
}

// `parts`: how many the pack has. Safe for hostile input: parseRig() accepts the rig as printRig() writes it.
SkinRig skinRig(std::string_view info, std::size_t parts) {
  const std::optional<Json> json = parseSafely(info);
  if (!json || !json->is_object() || !json->contains("skin")) return {};
  const Json& skin = json->at("skin");
  if (!skin.is_object() || !skin.contains("parts") || !skin.at("parts").is_array())
    return {std::nullopt, "it lists no parts"};
  if (skin.at("parts").size() != parts) return {std::nullopt, "it has another number of parts"};
  RigDescription rig;
  std::map<std::vector<std::string>, std::size_t> entries;  // of rigid parts
  for (const Json& part : skin.at("parts")) {
    const std::optional<RigDescription::SkinGroup> group = groupOf(part);
    if (!group) return {std::nullopt, "a part has no joints, or knots that no rig has"};
    if (group->knots == 0) {
      const auto [at, fresh] = entries.emplace(group->joints, rig.skin.size());
      if (!fresh) {
        ++rig.skin[at->second].pieces;
        continue;
      }
    }
    rig.skin.push_back(*group);
  }
  try {
    return {parseRig(printRig(rig)), ""};
  } catch (const RigError& error) {
    return {std::nullopt, error.what()};
  }
}

struct RigOptions {
  std::string path, part, axis;
};

// The rig that divides the pack's skin, if it has one and no part is asked for; else that of a part.
Exit printOneRig(const RigOptions& options, const std::optional<Axis>& axis) {
  PackFile file(options.path);
  const Pack& pack = file.pack();
  if (options.part.empty() && !axis) {
    const SkinRig skin = skinRig(pack.infoJson(), pack.parts().size());
    if (skin.rig) {
      print(printRig(*skin.rig));
      return Exit::kOk;
    }
    if (!skin.problem.empty())
      say("{}: its INFO describes a skin that cannot be used ({}): this is the rig of its first part",
          file.path(), skin.problem);
  }
  const std::uint32_t index = file.partOrFirst(options.part);
  const Part& part = pack.parts()[index];
  try {
    print(printRig(describeRig(rawRig(part), rawClips(pack), index,
                               axis ? *axis : bakedAxis(part).value_or(Axis::kPlusY), rawSockets(pack))));
  } catch (const RigError& error) {
    throw ToolError(Exit::kInvalid, fmt::format("{}: part {} '{}': {}", file.path(), index,
                                                nameText(part.name), error.what()));
  }
  return Exit::kOk;
}

Exit runRig(const RigOptions& options) {
  const std::optional<Axis> axis = parseAxis(options.axis);
  if (!options.axis.empty() && !axis)
    throw ToolError(Exit::kUsage,
                    fmt::format("--axis {}: expected +x, -x, +y, -y, +z or -z", nameText(options.axis, 40)));
  return printOneRig(options, axis);
}

}  // namespace

Command addRig(CLI::App& app) {
  const auto options = std::make_shared<RigOptions>();
  CLI::App* const command =
      addCommand(app, "rig", "Print the rig and clips of a part as rig JSON; of a skin, how it is divided",
                 "  kelp-dump rig reed.kelp > reed.rig.json\n"
                 "  kelp-dump rig fox.kelp > fox.rig.json      of a skin: which joints make which parts, for "
                 "kelp-bake\n");
  addPack(command, options->path);
  addPart(command, options->part, "of a skin, all; else the first");
  command
      ->add_option("--axis", options->axis,
                   "where the spline runs in the file that the rig is for; vectors are in that file's axes")
      ->option_text("+x|-x|+y|-y|+z|-z [as baked]");
  return {command, [options] { return runRig(*options); }};
}

}  // namespace kelp::dump
