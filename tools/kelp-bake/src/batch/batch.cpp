// SPDX-License-Identifier: MIT
#include "batch/batch.h"

#include <algorithm>
#include <chrono>
#include <new>
#include <system_error>

#include "batch/batch_report.h"
#include "batch/batch_summary.h"
#include "batch/shard.h"
#include "cli/bake_one.h"
#include "cli/faults.h"
#include "cli/interrupt.h"
#include "cli/messages.h"
#include "cli/summary.h"
#include "kelp/common/console.h"
#include "kelp/common/output_file.h"

namespace kelp::bake_cli {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

void makeFolderOf(const fs::path& file, const Place& place) {
  std::error_code error;
  if (file.has_parent_path()) fs::create_directories(file.parent_path(), error);
  if (error)
    throw ToolError(Exit::kIo, place.prefix() + file.parent_path().string() +
                                   ": the folder cannot be made: " + error.message() +
                                   "; choose another, or mend its permissions");
}

// An error says where the batch names the asset, unless it does already.
std::string withPlace(const Place& place, const std::string& what) {
  const std::string prefix = place.prefix();
  return what.rfind(place.file.string() + ":", 0) == 0 ? what : prefix + what;
}

// The folders of packs, reports and rules; and whether anything could be written there.
void prepareOutputs(const Jobs& jobs) {
  Faults faults;
  faults.keep([&] {
    if (!jobs.report_file) return;
    makeFolderOf(*jobs.report_file, {});
    checkTextOutput(*jobs.report_file);
  });
  for (const Job& job : jobs.jobs) {
    faults.keep([&] {
      const Options& options = job.options;
      for (const fs::path& file :
           {options.output, options.report_file.value_or(""), options.dependency_file.value_or("")})
        makeFolderOf(file, job.asset.place);
      try {
        checkDestinations(options);
      } catch (const ToolError& error) {
        throw ToolError(error.exit, withPlace(job.asset.place, error.what()));
      }
    });
  }
  faults.throwIfAny();
}

// After all the work a report that cannot be written is one more failure, and hides none of the others.
void tryToReport(const Command& command, const Jobs& jobs, BatchResult& result) {
  try {
    writeBatchReport(*jobs.report_file, command, jobs, result);
  } catch (const ToolError& error) {
    sayError(error.exit, std::string("--report ") + error.what());
    result.exit = std::max(result.exit, error.exit);
  }
}

bool isThere(const std::optional<fs::path>& file) {
  std::error_code error;
  return !file || fs::exists(*file, error);
}

// Estimates the time left from the assets baked so far. Assets with a resolution count by its voxels. The
// size of others is known only after import, so each of them counts as one. The two kinds are estimated
// apart.
class TimeLeft {
 public:
  explicit TimeLeft(const Jobs& jobs) {
    for (const Job& job : jobs.jobs) {
      Kind& kind = kindOf(job);
      kind.left += weightOf(job);
      ++kind.assets_left;
    }
  }
  void add(const Job& job, const AssetResult& result) {
    Kind& kind = kindOf(job);
    kind.left -= weightOf(job);
    --kind.assets_left;
    if (result.status != Status::kBaked) return;
    kind.baked += weightOf(job);
    kind.seconds += result.seconds;
  }
  // Less than 0 while too little is known.
  double seconds() const {
    double sum = 0;
    for (const Kind& kind : kinds_) {
      if (kind.assets_left == 0) continue;
      if (kind.baked == 0) return -1;
      sum += kind.seconds / kind.baked * kind.left;
    }
    return sum;
  }

 private:
  struct Kind {
    double left = 0, baked = 0, seconds = 0;
    std::size_t assets_left = 0;
  };
  // Time goes with the surface's voxels, and with reading the model, which is worth some 64 x 64 of them.
  static double weightOf(const Job& job) {
    const double side = job.options.settings.resolution;
    return job.options.settings.resolution_given ? side * side + 64.0 * 64.0 : 1;
  }
  Kind& kindOf(const Job& job) { return kinds_[job.options.settings.resolution_given ? 0 : 1]; }

  Kind kinds_[2];
};

void setFailed(AssetResult& result, const Job& job, Exit exit, const std::string& what) {
  result.status = Status::kFailed;
  result.exit = exit;
  result.error = console::oneLine(withPlace(job.asset.place, what));
}

AssetResult runOne(const Job& job, bool force, const Cache* cache, ProgressDisplay& display) {
  const auto start = Clock::now();
  AssetResult result;
  const auto fail = [&](Exit exit, const std::string& what) { setFailed(result, job, exit, what); };
  const Options& options = job.options;
  try {
    std::optional<Baked> done;
    if (!force && isThere(options.report_file)) done = takeCurrent(options, job.asset.place);
    if (done) {
      result.status = Status::kCurrent;
    } else {
      done = bakeOne(options, job.asset.place, cache, display, false);
      result.status = done->cached ? Status::kCached : Status::kBaked;
    }
    result.pack_bytes = done->pack_bytes;
    result.notices = done->notices;
  } catch (const ToolError& error) {
    if (error.exit != Exit::kInterrupted) fail(error.exit, error.what());
  } catch (const std::bad_alloc&) {
    fail(Exit::kRuntime, options.input.string() + ": out of memory; lower --resolution");
  } catch (const std::exception& error) {
    fail(Exit::kRuntime,
         options.input.string() + ": unexpected: " + error.what() + "; please report this as a defect");
  }
  result.seconds = secondsSince(start);
  return result;
}

}  // namespace

Exit runBatch(const Command& command) {
  const auto start = Clock::now();
  const Jobs jobs = prepareJobs(command);
  if (command.plan) {
    writeStdout(planJson(command, jobs));
    return Exit::kOk;
  }
  catchInterrupts();
  prepareOutputs(jobs);
  const std::optional<Cache> cache = jobs.jobs.empty() ? std::nullopt : openCache(jobs.jobs.front().options);
  ProgressDisplay display(jobs.jobs.empty() ? ProgressStyle::kNone : jobs.jobs.front().options.progress);
  BatchResult result;
  result.assets.resize(jobs.jobs.size());
  TimeLeft time_left(jobs);
  for (std::size_t i = 0; i < jobs.jobs.size() && !interrupted(); ++i) {
    AssetResult& asset = result.assets[i];
    display.beginAsset(i + 1, jobs.jobs.size(), jobs.jobs[i].options.output.string(), time_left.seconds());
    asset = runOne(jobs.jobs[i], command.force, cache ? &*cache : nullptr, display);
    display.clear();
    result.exit = std::max(result.exit, asset.exit);
    printAsset(jobs, i, asset);
    time_left.add(jobs.jobs[i], asset);
  }
  if (result.count(Status::kPending) > 0) result.exit = Exit::kInterrupted;
  result.seconds = secondsSince(start);
  printBatch(jobs, result);
  if (jobs.report_file) tryToReport(command, jobs, result);
  return result.exit;
}

}  // namespace kelp::bake_cli
