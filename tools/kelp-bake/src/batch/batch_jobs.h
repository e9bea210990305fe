// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "batch/assets.h"
#include "cli/command_line.h"
#include "cli/options.h"

namespace kelp::bake_cli {

// One asset of a batch, parsed and checked.
struct Job {
  Asset asset;  // with the command line's options
  Options options;
};

struct Jobs {
  std::vector<Job> jobs;                             // those of the shard
  std::vector<std::size_t> indices;                  // each one's index in the whole batch
  std::size_t all = 0;                               // in the whole batch
  std::optional<std::filesystem::path> report_file;  // of the batch
};

// Reads the manifest or list and checks all its assets, also those of other shards: options, missing files,
// files that would be overwritten. Throws ToolError or SeveralFaults with all faults.
Jobs prepareJobs(const Command& command);

}  // namespace kelp::bake_cli
