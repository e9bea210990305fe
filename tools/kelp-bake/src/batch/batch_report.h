// SPDX-License-Identifier: MIT
// A batch's plan and report, as JSON.
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
  std::string error;  // the error line, if it failed
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

// The JSON of --plan (kelp-bake-plan.schema.json).
std::string planJson(const Command& command, const Jobs& jobs);
// Writes a batch's --report (kelp-bake-batch.schema.json). Throws ToolError kIo.
void writeBatchReport(const std::filesystem::path& path, const Command& command, const Jobs& jobs,
                      const BatchResult& result);

}  // namespace kelp::bake_cli
