// SPDX-License-Identifier: MIT
// Which files an import read.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace kelp::bake {

// The files that a pack was made of.
struct FilesUsed {
  struct File {
    std::filesystem::path path;
    // XXH3-64 of the bytes that were read, 16 hexadecimal digits
    std::string xxh3;
  };
  std::vector<File> read;  // each once
  // files that were looked for and not found, or could not be read
  std::vector<std::filesystem::path> missing;
};

}  // namespace kelp::bake
