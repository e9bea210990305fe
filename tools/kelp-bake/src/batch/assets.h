// SPDX-License-Identifier: MIT
// The assets of a batch: from a manifest, or from a list.
#pragma once

#include <vector>

#include "cli/command_line.h"
#include "cli/faults.h"

namespace kelp::bake_cli {

struct Asset {
  Values values;  // "input" and "output" among them
  Place place;    // where the batch names it
};

struct AssetList {
  // in the order of the files; what a manifest includes comes before its own
  std::vector<Asset> assets;
  std::vector<std::filesystem::path> files;  // that were read for it
};

// Many more are no list that somebody means.
inline constexpr std::size_t kMaxAssets = 100000;

// A manifest and all that it includes. `folder`, if it is not empty, takes the place of every manifest's
// "output". What is wrong goes to `faults`, with file, line and column (kIo for a manifest that cannot be
// read), and the rest is read all the same. Safe for hostile files.
AssetList readManifest(const std::filesystem::path& file, const std::filesystem::path& folder,
                       Faults& faults);

// A text with an input on each line, and options of its pack behind it, words and quotes as in a shell; what
// follows a # is a remark. Names are taken as on the command line, from the working folder. The same errors.
AssetList readList(const std::filesystem::path& file, const std::filesystem::path& folder, Faults& faults);

// The pack's name where none is given.
std::string packName(const std::string& input);

}  // namespace kelp::bake_cli
