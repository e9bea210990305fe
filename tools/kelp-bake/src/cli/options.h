// SPDX-License-Identifier: MIT
// The options of one bake, checked.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "cli/faults.h"
#include "cli/values.h"
#include "kelp/bake/bake.h"

namespace kelp::bake_cli {

enum class ProgressStyle { kAuto, kBar, kJson, kNone };

struct Options {
  std::filesystem::path input, output;
  bake::Settings settings;
  bool unit_given = false;  // then lengths are metres, whatever the format
  std::optional<std::filesystem::path> cache_folder;
  std::uint64_t cache_bytes = std::uint64_t{10} << 30;
  int max_import_seconds = 1800;
  ProgressStyle progress = ProgressStyle::kAuto;
  std::vector<std::filesystem::path> option_files;  // the configuration and manifests that set options
  std::optional<std::filesystem::path> report_file;
  std::optional<std::filesystem::path> dependency_file;  // a rule for make and ninja
  std::optional<std::string> deps_target;                // the rule's target, unescaped; default: the output
  bool phony_deps = false;                               // add an empty rule for each file
};

// Converts and checks values. Throws ToolError or SeveralFaults with their places (faultAt) for invalid or
// contradictory options.
Options readOptions(const Values& values);
// The same, but invalid options go to `faults` and keep their defaults.
Options readOptions(const Values& values, Faults& faults);

// Bytes of "4G", "512M", "1.5 GiB" or "1000000". nullopt for other text.
std::optional<std::uint64_t> parseBytes(const std::string& text);

}  // namespace kelp::bake_cli
