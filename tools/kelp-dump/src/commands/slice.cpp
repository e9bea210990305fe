// SPDX-License-Identifier: MIT
#include <memory>
#include <string>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "commands/commands.h"
#include "pack/pack_file.h"
#include "slice/write_slice.h"
#include "text/checks.h"
#include "text/text.h"

namespace kelp::dump {
namespace {

constexpr int kMostScale = 64;

struct SliceCommandOptions {
  std::string path, part, output, axis = "y";
  int at = 0;
  SliceOptions slice;
};

Exit runSlice(const CLI::App& command, const SliceCommandOptions& options) {
  checkSlices();
  SliceOptions slice = options.slice;
  if (options.axis != "x" && options.axis != "y" && options.axis != "z")
    throw ToolError(Exit::kUsage,
                    "--axis " + options.axis + ": expected x, y or z; see kelp-dump slice --help");
  slice.axis = options.axis[0];
  if (command.count("--at") > 0) slice.at = options.at;
  if (slice.scale < 1 || slice.scale > kMostScale)
    throw ToolError(Exit::kUsage,
                    fmt::format("--scale {}: expected 1 to {} pixels a voxel", slice.scale, kMostScale));
  checkBinaryOutput(options.output, options.path, "a PNG");
  PackFile file(options.path);
  const std::uint32_t part = file.findVoxels(options.part);
  if (const int levels = file.pack().parts()[part].levels; slice.level < 0 || slice.level >= levels)
    throw ToolError(Exit::kUsage, fmt::format("{}: --level {}: there are levels 0 to {}; choose one of them",
                                              file.path(), slice.level, levels - 1));
  writeSlice(file, part, slice, options.output);
  return Exit::kOk;
}

}  // namespace

Command addSlice(CLI::App& app) {
  const auto options = std::make_shared<SliceCommandOptions>();
  CLI::App* const command = addCommand(
      app, "slice", "Write a picture of one layer of voxels",
      "  kelp-dump slice reed.kelp -o reed.png                       the middle layer across the spline: "
      "black "
      "where solid\n"
      "  kelp-dump slice reed.kelp -o reed.png --axis z --what clearance --scale 4\n"
      "  kelp-dump slice reed.kelp -o reed.png --what normals --at 12\n"
      "\n"
      "--what occupancy      dark at the surface, gray inside, white where empty\n"
      "       clearance      distance of empty voxels from the nearest solid one, 4 gray steps a voxel, "
      "brighter "
      "is farther; solid is orange\n"
      "       normals        (n + 1) / 2 as red, green, blue; gray inside, transparent where empty\n"
      "       colour         as in the palette; transparent where empty\n"
      "       density, heat  of fog, as stored\n"
      "Across y: x to the right, z down. Across z: x to the right, y up. Across x: z to the right, y up.\n");
  addPack(command, options->path);
  command->add_option("-o,--output", options->output, "the PNG; - is standard output")
      ->required()
      ->option_text("OUT.png REQUIRED");
  command
      ->add_option("--axis", options->axis, "across the layer, in the part's axes; y runs along the spline")
      ->option_text("x|y|z [y]");
  command->add_option("--at", options->at, "which layer, from 0")->option_text("N [the middle one]");
  addLevel(command, options->slice.level);
  addPart(command, options->part, "the first");
  command->add_option("--what", options->slice.what, "what to show")
      ->option_text("occupancy|clearance|normals|color|density|heat [occupancy; of fog, density]");
  command->add_option("--scale", options->slice.scale, "pixels along a voxel's side")
      ->option_text("N [1; up to 64]");
  return {command, [command, options] { return runSlice(*command, *options); }};
}

}  // namespace kelp::dump
