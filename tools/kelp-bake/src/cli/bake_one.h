// SPDX-License-Identifier: MIT
// Bakes one asset: pack, report and rule. Used for a single bake and in a batch.
#pragma once

#include <optional>

#include "cache/cache.h"
#include "cli/options.h"
#include "cli/progress_display.h"

namespace kelp::bake_cli {

struct Baked {
  bool cached = false;  // taken from the cache; `report` is empty then
  bake::Report report;
  std::vector<std::string> notices;  // warnings; if cached, those of the bake that made the pack
  std::uint64_t pack_bytes = 0;
  double seconds = 0;
};

// Checks before the work that the pack, the report and the rule can be written. Throws ToolError kIo. Leaves
// no file behind.
void checkDestinations(const Options& options);

// The existing pack, if a bake would write the same (bake::isCurrent). If the options ask for a rule, writes
// it and renews the pack file's time, because make rebuilds a target that is older than the files of its
// rule. The pack's bytes stay, and no report is written. Throws ToolError if the rule cannot be written.
std::optional<Baked> takeCurrent(const Options& options, const Place& place);

// Bakes. `cache` may be null. `place`: where the batch lists the asset, empty outside a batch. `announce`:
// print the memory estimate before the work. Throws ToolError, kInterrupted soon after interrupted() is true.
Baked bakeOne(const Options& options, const Place& place, const Cache* cache, ProgressDisplay& display,
              bool announce);

}  // namespace kelp::bake_cli
