// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "batch/assets.h"
#include "cli/command_line.h"
#include "cli/options.h"

namespace kelp::bake_cli {

// One asset of a batch, understood and checked.
struct Job {
  Asset asset;  // with what the command line says
  Options options;
};

struct Jobs {
  std::vector<Job> jobs;                             // those of the shard
  std::vector<std::size_t> indices;                  // of each in the whole batch, from 0
  std::size_t all = 0;                               // in the whole batch
  std::optional<std::filesystem::path> report_file;  // of the batch
};

// Reads the manifest or list, and checks every asset of it, of other shards too: options, files that are not
// there, files that would be overwritten. ToolError or SeveralFaults: all that is wrong.
Jobs prepareJobs(const Command& command);

}  // namespace kelp::bake_cli
