// SPDX-License-Identifier: MIT
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "commands/commands.h"
#include "info/summary.h"
#include "pack/pack_file.h"
#include "text/text.h"

namespace kelp::dump {
namespace {

struct InfoOptions {
  std::string path, format = "text";
  bool count = false;
};

Exit runInfo(const InfoOptions& options) {
  const bool json = isJson(options.format);
  PackFile file(options.path);
  const Summary summary = summarize(file, options.count);
  print(json ? infoJson(summary) : infoText(summary));
  return Exit::kOk;
}

}  // namespace

Command addInfo(CLI::App& app) {
  const auto options = std::make_shared<InfoOptions>();
  CLI::App* const command =
      addCommand(app, "info", "Print what is in a pack, on one screen; reads only its header and tables",
                 "  kelp-dump info reed.kelp\n"
                 "  kelp-dump info reed.kelp --count              how many voxels are solid, how much each "
                 "color is used\n"
                 "  kelp-dump info reed.kelp --format json | jq '.parts[].name'\n");
  addPack(command, options->path);
  command->add_flag("--count", options->count,
                    "also read all voxels and count them: bricks, solid and surface voxels, the use of each "
                    "color, the size of decoded pages");
  addFormat(command, options->format);
  return {command, [options] { return runInfo(*options); }};
}

}  // namespace kelp::dump
