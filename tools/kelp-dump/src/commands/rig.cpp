// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "commands/commands.h"
#include "kelp/rig/rig_file.h"
#include "pack/pack_file.h"
#include "text/text.h"

namespace kelp::dump {
namespace {

struct RigOptions {
  std::string path, part, axis;
};

std::string partRig(PackFile& file, RiggedPack rigged, std::uint32_t index, Axis axis) {
  const Part& part = file.pack().parts()[index];
  rigged.given.assign(rigged.given.size(), false);
  rigged.given[index] = true;
  rigged.axes[index] = axis;
  try {
    return printRig(describeParts(file.pack(), rigged).parts.front().rig);
  } catch (const RigError& error) {
    throw ToolError(Exit::kInvalid, fmt::format("{}: part {} '{}': {}", file.path(), index,
                                                nameText(part.name), error.what()));
  }
}

// A pack of another program may have names that no rig file has.
std::string partRigs(PackFile& file, const RiggedPack& rigged) {
  try {
    std::string text = printRigFile(describeParts(file.pack(), rigged));
    (void)parseRigFile(text);
    return text;
  } catch (const RigError& error) {
    throw ToolError(Exit::kInvalid, fmt::format("{}: its rigs cannot be in one file: {}; print the rig of "
                                                "one part with --part INDEX",
                                                file.path(), error.what()));
  }
}

Exit runRig(const RigOptions& options) {
  const std::optional<Axis> axis = parseAxis(options.axis);
  if (!options.axis.empty() && !axis)
    throw ToolError(Exit::kUsage,
                    fmt::format("--axis {}: expected +x, -x, +y, -y, +z or -z", nameText(options.axis, 40)));
  PackFile file(options.path);
  const RiggedPack rigged(file.pack());
  if (options.part.empty() && !axis && rigged.by_part) {
    if (std::find(rigged.given.begin(), rigged.given.end(), true) == rigged.given.end())
      throw ToolError(Exit::kInvalid,
                      fmt::format("{}: a skin moves its parts, and none has a rig of its own; "
                                  "print how one moves with --part NAME",
                                  file.path()));
    print(partRigs(file, rigged));
  } else {
    // If the rest are its sides, nobody need choose.
    const std::uint32_t index = options.part.empty() && !rigged.by_part ? 0 : file.partOrFirst(options.part);
    print(partRig(file, rigged, index, axis.value_or(rigged.axes[index])));
  }
  return Exit::kOk;
}

}  // namespace

Command addRig(CLI::App& app) {
  const auto options = std::make_shared<RigOptions>();
  CLI::App* const command = addCommand(
      app, "rig", "Print rigs and clips as rig JSON: of several parts by name, but those that a skin moves",
      "  kelp-dump rig reed.kelp > reed.rig.json    beside reed.glb, kelp-bake takes it\n"
      "  kelp-dump rig hero.kelp --part arm_r       the rig of one part alone\n");
  addPack(command, options->path);
  addPart(command, options->part, "all; with --axis, the first");
  command
      ->add_option("--axis", options->axis,
                   "where the spline runs in the file that the rig is for; vectors are in that file's axes")
      ->option_text("+x|-x|+y|-y|+z|-z [as baked]");
  return {command, [options] { return runRig(*options); }};
}

}  // namespace kelp::dump
