// SPDX-License-Identifier: MIT
// The command line of kelp-bake.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/values.h"

namespace kelp::bake_cli {

// One of `count` shares of a batch; the first is 1.
struct Shard {
  unsigned index = 1, count = 1;
};

struct Command {
  // as given; "input" only for a single bake; "output" is its pack, or a batch's folder
  Values options;
  Values config;                                    // of --config
  std::vector<std::filesystem::path> option_files;  // that it came from
  std::optional<std::filesystem::path> manifest;
  std::optional<std::filesystem::path> list;  // of @LIST
  std::optional<Shard> shard;
  bool print_config = false;  // print all options, bake nothing
  bool plan = false;          // print what would be baked, bake nothing
  bool force = false;         // also bake packs that are up to date

  bool isBatch() const { return manifest || list; }
};

// Parses the command line; words[0] is the program. nullopt after --help or --version, which it prints on
// stdout. Throws ToolError kUsage for unknown or invalid options.
std::optional<Command> parseCommandLine(const std::vector<std::string>& words);

// Parses a line of a list: an input and its options. Errors have the line's place.
Values parseAssetLine(const std::vector<std::string>& words, const Place& place);

}  // namespace kelp::bake_cli
