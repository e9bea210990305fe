// SPDX-License-Identifier: MIT
// What became of a batch, for people: lines on stderr.
#pragma once

#include "batch/batch_report.h"

namespace kelp::bake_cli {

// What became of one asset, as soon as it is known. Nothing of one that was interrupted.
void printAsset(const Jobs& jobs, std::size_t index, const AssetResult& result);
// All of it, and what failed once more.
void printBatch(const Jobs& jobs, const BatchResult& result);

}  // namespace kelp::bake_cli
