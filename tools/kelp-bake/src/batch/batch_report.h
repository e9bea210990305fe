// SPDX-License-Identifier: MIT
// What a batch would do, and what became of it, for programs.
#pragma once

#include <string>
#include <vector>

#include "batch/batch_jobs.h"

namespace kelp::bake_cli {

enum class Status { kPending, kBaked, kCached, kCurrent, kFailed };
const char* toString(Status status);

struct AssetResult {
  Status status = Status::kPending;
  Exit exit = Exit::kOk;
  std::string error;  // of a failed one: the line
  double seconds = 0;
  std::uint64_t pack_bytes = 0;
  std::vector<std::string> notices;
};

struct BatchResult {
  std::vector<AssetResult> assets;  // as Jobs::jobs
  double seconds = 0;
  Exit exit = Exit::kOk;

  std::size_t count(Status status) const;
};

// JSON for stdout, as kelp-bake-plan.schema.json describes it.
std::string planJson(const Command& command, const Jobs& jobs);
// Writes --report of a batch, as kelp-bake-batch.schema.json describes it. ToolError kIo.
void writeBatchReport(const std::filesystem::path& path, const Command& command, const Jobs& jobs,
                      const BatchResult& result);

}  // namespace kelp::bake_cli
