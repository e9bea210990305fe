// SPDX-License-Identifier: MIT
// One asset, from its input to its pack and what is written beside it: the same by itself and in a batch.
#pragma once

#include "options.h"
#include "progress_display.h"

namespace kelp::bake_cli {

struct Baked {
  bake::Report report;
  double seconds = 0;
};

// `place`: where the batch names the asset, or nothing. `announce`: say before the work what memory it will take.
// BakeError; kInterrupted as soon as interrupted() says so.
Baked bakeOne(const Options& options, const Place& place, ProgressDisplay& display, bool announce);

}  // namespace kelp::bake_cli
