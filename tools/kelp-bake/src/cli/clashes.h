// SPDX-License-Identifier: MIT
// Prevents a bake or a batch from overwriting a file that it reads or another of its outputs.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "cli/options.h"

namespace kelp::bake_cli {

// All files that are read or written, and by which option. Two names are the same file if they lead to it by
// symbolic links, hard links or different paths to a folder, even before the file exists. Files that are not
// regular (/dev/null) may be named several times.
class FileRoles {
 public:
  // Throws ToolError with both names if the file is also written.
  void addRead(const std::filesystem::path& path);
  // Throws ToolError, with the place of `option` ("-o", "--report"), if the file is also read, or written by
  // another option.
  void addWritten(const std::filesystem::path& path, const std::string& option, const Place& place);
  // A folder that may be created. Throws ToolError if it, or a folder above it, is a file that is written.
  void addFolder(const std::filesystem::path& path, const std::string& option);

 private:
  struct Writer {
    std::string name;  // "-o reed.kelp"
    Place place;
  };
  std::unordered_map<std::string, Writer> written_;  // by each key of a file
  std::unordered_map<std::string, std::filesystem::path> read_;
  std::unordered_map<std::string, std::string> folders_;  // path to option: "--cache packs"
};

// Adds the files that `options` write, the files they read, and `read`. `place`: where the options were
// written.
void addRoles(FileRoles& roles, const Options& options, const std::vector<std::filesystem::path>& read,
              const Place& place);

}  // namespace kelp::bake_cli
