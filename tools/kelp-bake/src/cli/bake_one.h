// SPDX-License-Identifier: MIT
// One asset, from its input to its pack and what is written beside it: the same by itself and in a batch.
#pragma once

#include <optional>

#include "cache/cache.h"
#include "cli/options.h"
#include "cli/progress_display.h"

namespace kelp::bake_cli {

struct Baked {
  bool cached = false;  // taken from the cache; `report` is empty then
  bake::Report report;
  std::vector<std::string> notices;  // warnings, of a bake before if it is cached
  std::uint64_t pack_bytes = 0;
  double seconds = 0;
};

// Whether the pack, the report and the rule could be written, asked before the work: ToolError kIo that says
// why not. Leaves nothing behind.
void checkDestinations(const Options& options);

// The pack that is there, if it is what a bake would write (bake::isCurrent). Where a rule is asked for it is
// written, as others may have asked for this pack before, and the pack's time is renewed: a build asks again
// for as long as its target is older than what the rule names. No byte of the pack changes, and no report is
// written. ToolError if the rule cannot be written.
std::optional<Baked> takeCurrent(const Options& options, const Place& place);

// `cache` may be null. `place`: where the batch names the asset, or nothing. `announce`: say before the work
// what memory it will take. ToolError; kInterrupted as soon as interrupted() says so.
Baked bakeOne(const Options& options, const Place& place, const Cache* cache, ProgressDisplay& display,
              bool announce);

}  // namespace kelp::bake_cli
