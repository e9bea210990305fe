// SPDX-License-Identifier: MIT
// The results of a batch, as lines on stderr.
#pragma once

#include "batch/batch_report.h"

namespace kelp::bake_cli {

// Prints the result of one asset, when it is known; nothing if it was interrupted.
void printAsset(const Jobs& jobs, std::size_t index, const AssetResult& result);
// Prints the totals, and the failed assets again.
void printBatch(const Jobs& jobs, const BatchResult& result);

}  // namespace kelp::bake_cli
