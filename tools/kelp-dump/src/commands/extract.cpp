// SPDX-License-Identifier: MIT
#include "extract/extract.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "commands/commands.h"
#include "kelp/common/error.h"
#include "pack/pack_file.h"
#include "text/checks.h"

namespace kelp::dump {
namespace {

struct Format {
  const char* name;
  const char* help;
  const Writer& writer;
  bool into_folder = false;
};
constexpr Format kFormats[] = {
    {"vox", "MagicaVoxel: colors by index, materials, one model a part", kVoxWriter},
    {"proxy", "few triangles around each solid part, closed: an .obj, .ply, .stl or .off file, in meters",
     kProxyWriter},
    {"npy", "a folder of NumPy arrays: occupancy, signed distance and its gradient of each solid part",
     kNpyWriter, true},
    {"vdb", "OpenVDB: solid parts as level sets with their colors, fog as densities", kVdbWriter},
    {"nvdb", "NanoVDB: the same as --vdb", kNanoVdbWriter},
};

struct ExtractOptions {
  std::string path, part;
  int level = 0;
  double error = ExtractRequest::kProxyError;
  std::map<std::string, std::string> outputs;  // by the name of the format
};

// The one format that was asked for.
const Format& formatOf(const CLI::App& command) {
  const Format* wanted = nullptr;
  for (const Format& format : kFormats) {
    if (command.count(std::string("--") + format.name) == 0) continue;
    if (wanted)
      throw ToolError(Exit::kUsage,
                      fmt::format("--{} and --{}: one format at a time; see kelp-dump extract --help",
                                  wanted->name, format.name));
    wanted = &format;
  }
  if (!wanted)
    throw ToolError(
        Exit::kUsage,
        "extract: no format; name one with --vox, --vdb, --nvdb, --proxy or --npy, see kelp-dump extract "
        "--help");
  if (!wanted->writer.write && !wanted->writer.handOver)
    throw ToolError(
        Exit::kUnsupported,
        fmt::format("--{}: this kelp-dump was built without {}; it has {} (see --version), or build it "
                    "where {} is installed",
                    wanted->name, wanted->writer.needs, extractFormats(), wanted->writer.needs));
  return *wanted;
}

ExtractRequest requestOf(PackFile& file, const ExtractOptions& options, const std::string& output,
                         bool with_distances) {
  const std::span<const Part> parts = file.pack().parts();
  ExtractRequest request{file, {}, options.level, output, options.error};
  if (options.part.empty()) {
    for (std::uint32_t part = 0; part < parts.size(); ++part)
      if (parts[part].kind != PartKind::kEmpty) request.parts.push_back(part);
  } else {
    request.parts.push_back(file.findVoxels(options.part));
  }
  int levels = 0;
  for (const std::uint32_t part : request.parts) {
    levels = std::max(levels, parts[part].levels);
    if (with_distances) levels = std::max(levels, file.pack().distanceLevels(static_cast<int>(part)));
  }
  if (options.level < 0 || options.level >= levels)
    throw ToolError(Exit::kUsage, fmt::format("{}: --level {}: there are levels 0 to {}; choose one of them",
                                              options.path, options.level, levels - 1));
  return request;
}

Exit runExtract(const CLI::App& command, const ExtractOptions& options) {
  const Format& format = formatOf(command);
  const Writer& writer = format.writer;
  const std::string& output = options.outputs.at(format.name);
  if (command.count("--error") > 0 && &writer != &kProxyWriter)
    throw ToolError(Exit::kUsage, "--error: is for --proxy only; leave it out");
  if (!(options.error >= 1 && std::isfinite(options.error)))
    throw ToolError(
        Exit::kUsage,
        fmt::format("--error {}: expected a number of voxels from 1 on, such as 1.5", options.error));
  if (output == "-" && !writer.shown_as)
    throw ToolError(Exit::kUsage, fmt::format("--{} -: cannot be written to standard output; name a {}",
                                              format.name, format.into_folder ? "folder" : "file"));
  if (!format.into_folder) checkBinaryOutput(output, options.path, writer.shown_as);
  if (writer.handOver) {
    std::vector<std::string> arguments{"extract", std::string("--") + format.name, output, "--level",
                                       std::to_string(options.level)};
    if (!options.part.empty()) arguments.insert(arguments.end(), {"--part", options.part});
    arguments.insert(arguments.end(), {"--", options.path});
    writer.handOver(std::move(arguments));
  }
  PackFile file(options.path);
  writer.write(requestOf(file, options, output, &writer == &kNpyWriter));
  return Exit::kOk;
}

}  // namespace

std::string extractFormats() {
  std::string text;
  for (const Format& format : kFormats)
    if (format.writer.write || (format.writer.isThere && format.writer.isThere()))
      text += fmt::format("{}{}", text.empty() ? "" : ", ", format.name);
  return text;
}

Command addExtract(CLI::App& app) {
  const auto options = std::make_shared<ExtractOptions>();
  CLI::App* const command =
      addCommand(app, "extract", "Write the voxels of a pack in another program's format",
                 "  kelp-dump extract reed.kelp --vox reed.vox\n"
                 "  kelp-dump extract reed.kelp --vox - --level 2 > reed.vox\n"
                 "  kelp-dump extract smoke.kelp --vdb smoke.vdb\n"
                 "  kelp-dump extract reed.kelp --npy arrays\n"
                 "  kelp-dump extract reed.kelp --proxy reed.obj --error 2\n");
  addPack(command, options->path);
  for (const Format& format : kFormats)
    command->add_option(std::string("--") + format.name, options->outputs[format.name], format.help)
        ->option_text(format.into_folder ? "FOLDER" : "OUT");
  command
      ->add_option("--error", options->error,
                   "the farthest that --proxy's surface and that of the voxels may be from each other")
      ->option_text(fmt::format("VOXELS [{}]", options->error));
  addPart(command, options->part, "all");
  addLevel(command, options->level);
  return {command, [command, options] { return runExtract(*command, *options); }};
}

}  // namespace kelp::dump
