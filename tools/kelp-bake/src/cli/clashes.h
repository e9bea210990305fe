// SPDX-License-Identifier: MIT
// Keeps a bake, or a batch of them, from writing over what it reads, or over its own output.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "cli/options.h"

namespace kelp::bake_cli {

// Every file that is read or written, and by whom. Two names are one file by the way they lead to it, through
// links of either kind or by different ways to one folder, whether it is there yet or not. What is no regular
// file (/dev/null) holds nothing that could be lost, and may be named twice.
class FileRoles {
 public:
  // ToolError, with both names, if the file is written too.
  void addRead(const std::filesystem::path& path);
  // ToolError if the file is read, or written by somebody else. `option`: "-o", "--report"; the error is one
  // of its place.
  void addWritten(const std::filesystem::path& path, const std::string& option, const Place& place);
  // A folder that is made if need be, and those above it: ToolError if one of them is to be a file that is
  // written.
  void addFolder(const std::filesystem::path& path, const std::string& option);

 private:
  struct Writer {
    std::string name;  // "-o reed.kelp"
    Place place;
  };
  std::unordered_map<std::string, Writer> written_;  // by each of a file's keys
  std::unordered_map<std::string, std::filesystem::path> read_;
  std::unordered_map<std::string, std::string> folders_;  // by their places: "--cache packs"
};

// Adds all that `options` write and, beside `read`, all that they name to be read; `place` is where they were
// written.
void addRoles(FileRoles& roles, const Options& options, const std::vector<std::filesystem::path>& read,
              const Place& place);

}  // namespace kelp::bake_cli
