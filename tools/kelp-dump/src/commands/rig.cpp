// SPDX-License-Identifier: MIT
#include "kelp/rig/rig.h"

#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "commands/commands.h"
#include "commands/options.h"
#include "kelp/rig/raw_clips.h"
#include "pack/pack_file.h"
#include "pack/part_axis.h"
#include "rig/set_rig.h"
#include "rig/skin_rig.h"
#include "text/text.h"

namespace kelp::dump {
namespace {

struct RigOptions {
  std::string path, part, axis, new_rig, output;
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
      say("{}: what its INFO says of a skin cannot be used ({}): this is the rig of its first part",
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

Exit runRig(const CLI::App& command, const RigOptions& options) {
  const std::optional<Axis> axis = parseAxis(options.axis);
  if (!options.axis.empty() && !axis)
    throw ToolError(Exit::kUsage,
                    fmt::format("--axis {}: expected +x, -x, +y, -y, +z or -z", nameText(options.axis, 40)));
  if (command.count("--set") > 0)
    return setRig({options.path, options.part, options.new_rig, axis, options.output});
  if (command.count("-o") > 0)
    throw ToolError(
        Exit::kUsage,
        "-o: only goes with --set; without it the rig is printed to standard output, see kelp-dump "
        "rig --help");
  return printOneRig(options, axis);
}

}  // namespace

Command addRig(CLI::App& app) {
  const auto options = std::make_shared<RigOptions>();
  CLI::App* const command = addCommand(
      app, "rig",
      "Print the rig and clips of a part as rig JSON, or replace them; of a skin, how it is divided",
      "  kelp-dump rig reed.kelp > reed.rig.json\n"
      "  kelp-dump rig reed.kelp --set reed.rig.json           replaces reed.kelp, whole, once "
      "the new pack is on "
      "the disk\n"
      "  kelp-dump rig fish.kelp --part tail --set swim -o swimming.kelp\n"
      "  kelp-dump rig fox.kelp > fox.rig.json                 of a skin: which joints make which "
      "parts, for kelp-bake\n"
      "\n"
      "--set takes and refuses the same rigs as kelp-bake --rig. Voxels stay as they are, so the "
      "rig must bend "
      "along the axis that the part was baked along.\n");
  addPack(command, options->path);
  addPart(command, options->part, "of a skin, all; else the first");
  command
      ->add_option("--axis", options->axis,
                   "where the spline runs in the file that the rig is for; vectors are in that file's axes. "
                   "With --set: the axis of a preset, or of a rig that names none")
      ->option_text("+x|-x|+y|-y|+z|-z [as baked; with --set, as kelp-bake]");
  command
      ->add_option("--set", options->new_rig,
                   "give the part this rig; its clips replace those that move the part")
      ->option_text("FILE|none|sway|swim");
  command
      ->add_option("-o,--output", options->output,
                   "with --set: where to write the pack; - is standard output")
      ->option_text("OUT [PACK itself]");
  return {command, [command, options] { return runRig(*command, *options); }};
}

}  // namespace kelp::dump
