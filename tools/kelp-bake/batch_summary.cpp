// SPDX-License-Identifier: MIT
#include "batch_summary.h"

#include <cstdio>

#include <fmt/format.h>

#include "summary.h"

namespace kelp::bake_cli {

void printAsset(const Jobs& jobs, std::size_t index, const AssetResult& result) {
  const std::string number = fmt::format("[{}/{}]", index + 1, jobs.jobs.size());
  const std::string output = jobs.jobs[index].options.output.string();
  switch (result.status) {
    case Status::kPending: break;
    case Status::kBaked: fmt::print(stderr, "kelp-bake: {} {}: baked, {}, in {:.2f} s\n", number, output, printBytes(result.pack_bytes), result.seconds); break;
    case Status::kCached: fmt::print(stderr, "kelp-bake: {} {}: from the cache, {}, in {:.2f} s\n", number, output, printBytes(result.pack_bytes), result.seconds); break;
    case Status::kCurrent: fmt::print(stderr, "kelp-bake: {} {}: up to date\n", number, output); break;
    case Status::kFailed: fmt::print(stderr, "kelp-bake: {} {}: failed: {}\n", number, output, result.error); break;
  }
  for (const std::string& notice : result.notices) fmt::print(stderr, "kelp-bake: {} warning: {}\n", number, oneLine(notice));
  std::fflush(stderr);
}

void printBatch(const Jobs& jobs, const BatchResult& result) {
  const std::size_t failed = result.count(Status::kFailed), pending = result.count(Status::kPending);
  std::string line = fmt::format("kelp-bake: {} of {} assets done: {} baked, {} up to date", jobs.jobs.size() - failed - pending, jobs.jobs.size(), result.count(Status::kBaked), result.count(Status::kCurrent));
  if (const std::size_t cached = result.count(Status::kCached); cached > 0) line += fmt::format(", {} from the cache", cached);
  if (failed > 0) line += fmt::format("; {} failed", failed);
  if (pending > 0) line += fmt::format("; interrupted before {}", pending == 1 ? "one" : fmt::format("{} others", pending));
  fmt::print(stderr, "{}; in {:.2f} s\n", line, result.seconds);
  constexpr std::size_t kShown = 20;
  if (failed == 0 || jobs.jobs.size() == 1) return;
  std::size_t shown = 0;
  for (const AssetResult& asset : result.assets) {
    if (asset.status != Status::kFailed) continue;
    if (shown++ == kShown) {
      fmt::print(stderr, "  and {} more; --report FILE.json names them all\n", failed - kShown);
      break;
    }
    fmt::print(stderr, "  {}\n", asset.error);
  }
}

}  // namespace kelp::bake_cli
