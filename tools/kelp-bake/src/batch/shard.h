// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "cli/command_line.h"
#include "cli/options.h"

namespace kelp::bake_cli {

// The estimated cost of an asset, from its resolution (default: 128) alone.
double voxelsOf(const Options& options);

// The indices of the assets in a share, ascending. Each asset is in exactly one share. The result depends
// only on the options, not on files, so runs on different machines agree. The largest asset is assigned
// first, each to the share with the fewest voxels.
std::vector<std::size_t> chooseShard(const std::vector<Options>& assets, const Shard& shard);

}  // namespace kelp::bake_cli
