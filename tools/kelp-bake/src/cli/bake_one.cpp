// SPDX-License-Identifier: MIT
#include "cli/bake_one.h"

#include <cerrno>
#include <chrono>
#include <memory>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>

#include "cli/clashes.h"
#include "cli/contained.h"
#include "cli/interrupt.h"
#include "cli/report_json.h"
#include "cli/summary.h"
#include "kelp/common/output_file.h"
#include "kelp/formats/pack.h"
#include "kelp/formats/source.h"

namespace kelp::bake_cli {

namespace {

using Clock = std::chrono::steady_clock;

// What is read may have been found only by reading it.
void checkRoles(const Options& options, const bake::FilesUsed& files, const Place& place) {
  std::vector<std::filesystem::path> read;
  for (const bake::FilesUsed::File& file : files.read) read.push_back(file.path);
  FileRoles roles;
  addRoles(roles, options, read, place);
  if (options.dependency_file) checkDependencies(options, files);
}

std::optional<Baked> takeFromCache(const Options& options, const Place& place, const Cache& cache) {
  const auto start = Clock::now();
  const std::optional<Cache::Hit> hit =
      cache.fetch(options, [&](const bake::FilesUsed& files) { checkRoles(options, files, place); });
  if (!hit) return std::nullopt;
  Baked baked;
  baked.cached = true;
  baked.pack_bytes = hit->pack_bytes;
  baked.notices = noticesOf(hit->report);
  baked.seconds = secondsSince(start);
  if (options.report_file)
    writeTextFile(*options.report_file, cachedReport(hit->report, options, hit->files, baked.seconds));
  if (options.dependency_file) writeDependencies(*options.dependency_file, options, hit->files);
  return baked;
}

// What the pack was made of, by its own words. Nothing if another has taken its place meanwhile.
std::optional<bake::FilesUsed> filesOfPack(const Options& options) {
  Result<FileSource> file = FileSource::open(options.output.c_str());
  if (!file) return std::nullopt;
  FileSource opened = *std::move(file);
  const Result<Pack> pack = Pack::open(opened.source());
  if (!pack) return std::nullopt;
  std::optional<bake::Recipe> recipe =
      bake::recipeNow(std::string(pack->infoJson()), options.input, options.settings);
  if (!recipe) return std::nullopt;
  return std::move(recipe->files);
}

}  // namespace

void checkDestinations(const Options& options) {
  checkOutput(options.output);
  if (options.report_file) checkTextOutput(*options.report_file);
  if (options.dependency_file) checkTextOutput(*options.dependency_file);
}

std::optional<Baked> takeCurrent(const Options& options, const Place& place) {
  if (!bake::isCurrent(options.output, options.input, options.settings)) return std::nullopt;
  Baked baked;
  baked.pack_bytes = std::filesystem::file_size(options.output);
  if (!options.dependency_file) return baked;
  const std::optional<bake::FilesUsed> files = filesOfPack(options);
  if (!files) return std::nullopt;
  checkRoles(options, *files, place);
  writeDependencies(*options.dependency_file, options, *files);
  if (::utimensat(AT_FDCWD, options.output.c_str(), nullptr, 0) != 0) {
    const int error = errno;
    baked.notices.push_back(options.output.string() +
                            ": its time cannot be renewed: " + std::generic_category().message(error) +
                            "; builds will ask for it again; see that you may write to it");
  }
  return baked;
}

Baked bakeOne(const Options& options, const Place& place, const Cache* cache, ProgressDisplay& display,
              bool announce) {
  const std::unique_ptr<ProgressDisplay, void (*)(ProgressDisplay*)> no_bar_stays(
      &display, [](ProgressDisplay* shown) { shown->clear(); });
  if (cache) {
    if (std::optional<Baked> cached = takeFromCache(options, place, *cache)) return *std::move(cached);
  }
  const auto start = Clock::now();
  Baked baked;
  bake::Report& report = baked.report;
  const auto progress = [&](std::string_view stage, double done) {
    if (announce && report.estimated_bytes > 0) {
      display.clear();
      printEstimate(options, report);
      announce = false;
    }
    enterStage(stage);
    display.show(stage, done);
    return !interrupted();
  };
  const RawPack pack = bake::bake(options.input, options.settings, report, progress);
  checkRoles(options, report.files, place);
  bake::writePackFile(pack, options.output, options.settings.threads, report, progress);
  display.clear();
  baked.seconds = secondsSince(start);
  const std::string report_text = reportJson(options, report, baked.seconds);
  if (cache && !cache->store(options, pack.info_json, report_text, report.pack_hash))
    report.notices.push_back(
        "--cache " + options.cache_folder->string() +
        ": the pack could not be kept there; see that there is space, and that you may write to it");
  if (options.report_file) writeTextFile(*options.report_file, report_text);
  if (options.dependency_file) writeDependencies(*options.dependency_file, options, report.files);
  baked.notices = report.notices;
  baked.pack_bytes = report.pack_bytes;
  return baked;
}

}  // namespace kelp::bake_cli
