// SPDX-License-Identifier: MIT
// The command line of kelp-bake.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "kelp/bake/bake.h"

namespace kelp::bake_cli {

enum class ProgressStyle { kAuto, kBar, kJson, kNone };

struct Options {
  std::filesystem::path input, output;
  bake::Settings settings;
  bool unit_given = false;  // then lengths are meters, whatever the format
  int max_import_seconds = 1800;
  ProgressStyle progress = ProgressStyle::kAuto;
  std::optional<std::filesystem::path> report_file;
  std::optional<std::filesystem::path> dependency_file;  // a rule for make and ninja
  std::optional<std::string> deps_target;                // the rule's target, unescaped; default: the output
  bool phony_deps = false;                               // add an empty rule for each file
};

// Parses the command line; words[0] is the program. nullopt after --help or --version, which it prints on
// stdout. Throws ToolError kUsage.
std::optional<Options> parseCommandLine(const std::vector<std::string>& words);

// Throws ToolError kUsage if the bake would overwrite a file that it reads (the input, what the options name,
// and `read`), or write two outputs to one file. Links of both kinds are followed. Only regular files count:
// /dev/null may be named twice.
void checkClashes(const Options& options, const std::vector<std::filesystem::path>& read = {});

}  // namespace kelp::bake_cli
