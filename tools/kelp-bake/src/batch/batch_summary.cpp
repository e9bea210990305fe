// SPDX-License-Identifier: MIT
#include "batch/batch_summary.h"

#include <fmt/format.h>

#include "cli/messages.h"
#include "cli/summary.h"

namespace kelp::bake_cli {

void printAsset(const Jobs& jobs, std::size_t index, const AssetResult& result) {
  std::string text;
  switch (result.status) {
    case Status::kPending:
      break;
    case Status::kBaked:
      text = fmt::format("baked, {}, in {:.2f} s", printBytes(result.pack_bytes), result.seconds);
      break;
    case Status::kCached:
      text = fmt::format("from the cache, {}, in {:.2f} s", printBytes(result.pack_bytes), result.seconds);
      break;
    case Status::kCurrent:
      text = "up to date";
      break;
    case Status::kFailed:
      text = "failed: " + result.error;
      break;
  }
  const OfBatch of{index + 1, jobs.jobs.size()};
  if (result.status != Status::kPending)
    sayAsset(of, jobs.jobs[index].options.output.string(), toString(result.status), result.exit, text);
  for (const std::string& notice : result.notices) sayWarning(notice, of);
}

void printBatch(const Jobs& jobs, const BatchResult& result) {
  const std::size_t failed = result.count(Status::kFailed), pending = result.count(Status::kPending);
  std::string line =
      fmt::format("{} of {} assets done: {} baked, {} up to date", jobs.jobs.size() - failed - pending,
                  jobs.jobs.size(), result.count(Status::kBaked), result.count(Status::kCurrent));
  if (const std::size_t cached = result.count(Status::kCached); cached > 0)
    line += fmt::format(", {} from the cache", cached);
  if (failed > 0) line += fmt::format("; {} failed", failed);
  if (pending > 0)
    line += fmt::format("; interrupted before {}", pending == 1 ? "one" : fmt::format("{} others", pending));
  sayNote(fmt::format("{}; in {:.2f} s", line, result.seconds));
  constexpr std::size_t kShown = 20;
  if (failed == 0 || jobs.jobs.size() == 1) return;
  std::size_t shown = 0;
  for (const AssetResult& asset : result.assets) {
    if (asset.status != Status::kFailed) continue;
    if (shown++ == kShown) {
      sayDetail(fmt::format("and {} more; --report FILE.json names them all", failed - kShown));
      break;
    }
    sayDetail(asset.error);
  }
}

}  // namespace kelp::bake_cli
