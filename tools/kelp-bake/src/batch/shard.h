// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "cli/command_line.h"
#include "cli/options.h"

namespace kelp::bake_cli {

// What an asset is taken to cost, by its options alone: where they give no resolution, that of the default
// one.
double voxelsOf(const Options& options);

// The indices of the assets in a share, ascending. Each asset is in exactly one of N shares. It depends on
// the options alone and on no file: runs that start at different times on different machines never disagree.
// Balanced by voxels: the largest first, each to the share that has the least.
std::vector<std::size_t> chooseShard(const std::vector<Options>& assets, const Shard& shard);

}  // namespace kelp::bake_cli
