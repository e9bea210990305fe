// SPDX-License-Identifier: MIT
// What one bake is told to do.
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
  bool unit_given = false;  // so that lengths are known to be metres whatever the file's format
  std::optional<std::filesystem::path> cache_folder;
  std::uint64_t cache_bytes = std::uint64_t{10} << 30;
  int max_import_seconds = 1800;
  ProgressStyle progress = ProgressStyle::kAuto;
  std::vector<std::filesystem::path> option_files;  // that all this came from: configuration, manifest
  std::optional<std::filesystem::path> report_file;
  std::optional<std::filesystem::path> dependency_file;  // a rule for make and ninja
  std::optional<std::string> deps_target;                // of that rule, as it stands; else the output
  bool phony_deps = false;                               // and an empty rule for every file that it names
};

// ToolError, SeveralFaults for what cannot be understood or contradicts itself, with the place where it was
// written (see faultAt).
Options readOptions(const Values& values);
// The same, with what is wrong as faults: the rest is as it was understood.
Options readOptions(const Values& values, Faults& faults);

// "4G", "512M", "1.5 GiB", "1000000": bytes. nullopt if it is none of these.
std::optional<std::uint64_t> parseBytes(const std::string& text);

}  // namespace kelp::bake_cli
