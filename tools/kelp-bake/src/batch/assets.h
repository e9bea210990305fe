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
  // in the files' order; assets of included manifests come first
  std::vector<Asset> assets;
  std::vector<std::filesystem::path> files;  // the manifests that were read
};

// A file with more is taken for an error.
inline constexpr std::size_t kMaxAssets = 100000;

// Reads a manifest and the manifests it includes. `folder`, if not empty, replaces every manifest's "output".
// Adds faults with file, line and column to `faults` (kIo for a manifest that cannot be read), and reads the
// rest. Safe for hostile files.
AssetList readManifest(const std::filesystem::path& file, const std::filesystem::path& folder,
                       Faults& faults);

// Reads a list: on each line an input and its options, with words and quotes as in a shell; # starts a
// comment. File names are relative to the working folder. The same errors.
AssetList readList(const std::filesystem::path& file, const std::filesystem::path& folder, Faults& faults);

// The pack's default name.
std::string packName(const std::string& input);

}  // namespace kelp::bake_cli
