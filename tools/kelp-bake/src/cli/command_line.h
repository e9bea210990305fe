// SPDX-License-Identifier: MIT
// The command line of kelp-bake.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/values.h"

namespace kelp::bake_cli {

// One of several runs that share a batch; the first is 1.
struct Shard {
  unsigned index = 1, count = 1;
};

struct Command {
  // as given; "input" is of a single bake alone, "output" then its pack, else a folder
  Values options;
  Values config;                                    // of --config
  std::vector<std::filesystem::path> option_files;  // that it came from
  std::optional<std::filesystem::path> manifest;
  std::optional<std::filesystem::path> list;  // of @LIST
  std::optional<Shard> shard;
  bool print_config = false;  // say what the options are, and bake nothing
  bool plan = false;          // say what would be baked, and bake nothing
  bool force = false;         // bake what is up to date too

  bool isBatch() const { return manifest || list; }
};

// words[0] is the program. nullopt when --help or --version was all that was asked; they are on stdout then.
// ToolError kUsage for what cannot be understood.
std::optional<Command> parseCommandLine(const std::vector<std::string>& words);

// A line of a list: an input and the options of its pack. Errors have the place.
Values parseAssetLine(const std::vector<std::string>& words, const Place& place);

}  // namespace kelp::bake_cli
