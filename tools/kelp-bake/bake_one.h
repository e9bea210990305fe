// SPDX-License-Identifier: MIT
// One asset, from its input to its pack and what is written beside it: the same by itself and in a batch.
#pragma once

#include "cache.h"
#include "options.h"
#include "progress_display.h"

namespace kelp::bake_cli {

struct Baked {
  bool cached = false;                // taken from the cache; `report` is empty then
  bake::Report report;
  std::vector<std::string> notices;   // warnings, of a bake before if it is cached
  std::uint64_t pack_bytes = 0;
  double seconds = 0;
};

// Whether the pack, the report and the rule could be written, asked before the work: BakeError kIo that says why not. Leaves nothing behind.
void checkDestinations(const Options& options);
// The same of a report or a rule alone. What is no regular file (/dev/null) is written as it is.
void checkTextFile(const std::filesystem::path& file);

// `cache` may be null. `place`: where the batch names the asset, or nothing. `announce`: say before the work what memory it will take.
// BakeError; kInterrupted as soon as interrupted() says so.
Baked bakeOne(const Options& options, const Place& place, const Cache* cache, ProgressDisplay& display, bool announce);

}  // namespace kelp::bake_cli
