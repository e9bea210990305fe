// SPDX-License-Identifier: MIT
#include "cli/bake_one.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <memory>
#include <span>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cli/clashes.h"
#include "cli/interrupt.h"
#include "cli/report_json.h"
#include "cli/summary.h"
#include "contained/contained.h"
#include "kelp/common/hash.h"
#include "kelp/common/memory.h"
#include "kelp/common/output_file.h"
#include "kelp/common/pack_error.h"
#include "kelp/common/parallel.h"
#include "kelp/formats/pack.h"
#include "kelp/formats/source.h"
#include "kelp/formats/verify.h"

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

// XXH3-128 of all its bytes; nothing if they cannot be read.
std::optional<std::string> hashOf(const Source& source) {
  std::vector<std::byte> block(std::size_t{1} << 20);
  Hash hash;
  for (std::uint64_t at = 0; at < source.size; at += block.size()) {
    const std::span<std::byte> part(block.data(), std::min<std::uint64_t>(block.size(), source.size - at));
    if (source.read(source.user, at, part) != Read::kDone) return std::nullopt;
    hash.add(part);
  }
  return hash.text();
}

// By its descriptor: its permissions may be such that nobody may open it for reading.
Read readOutput(void* user, std::uint64_t offset, std::span<std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t got = ::pread(static_cast<const OutputFile*>(user)->descriptor(), bytes.data(),
                                bytes.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return Read::kFailed;
    bytes = bytes.subspan(static_cast<std::size_t>(got));
    offset += static_cast<std::uint64_t>(got);
  }
  return Read::kDone;
}

// Reads the child's pack before it takes its place: of its size and hash nobody believes the child. Returns
// its INFO. Throws ToolError if it is not sound.
std::string checkFinished(const Options& options, OutputFile& output, bake::Report& report) {
  const auto start = Clock::now();
  const std::string name = options.output.string();
  struct stat status {};
  if (::fstat(output.descriptor(), &status) != 0)
    throw ToolError(Exit::kIo, name + ": cannot be read again; check the disk");
  const Source source{&readOutput, &output, static_cast<std::uint64_t>(status.st_size), nullptr, nullptr};
  std::optional<Issue> issue;
  verify(
      source, Limits(),
      [](void* first, const Issue& found) {
        auto& kept = *static_cast<std::optional<Issue>*>(first);
        if (found.severity == Severity::kError && !kept) kept = found;
      },
      &issue, {}, threadCount(options.settings.threads));
  if (issue && exitOf(issue->error.code) != Exit::kInvalid) failPack(name, issue->error);
  if (issue)
    throw ToolError(Exit::kRuntime, options.input.string() + ": the pack that its bake wrote is not sound (" +
                                        toString(issue->id) +
                                        "); please report this as a defect, with the file");
  const std::optional<std::string> hash = hashOf(source);
  if (!hash) throw ToolError(Exit::kIo, name + ": cannot be read again; check the disk");
  report.pack_bytes = source.size;
  report.pack_hash = *hash;
  // What the contained process took counts on: this one's peak is often less.
  const std::uint64_t before = report.stages.empty() ? 0 : report.stages.back().peak_bytes;
  report.stages.push_back({"check", secondsSince(start), std::max(before, peakMemory())});
  return std::string(checkPack(name, Pack::open(source)).infoJson());
}

// The files that the pack was made of: those that its INFO names, as they are now. Of their names and hashes,
// too, nobody believes the child: the cache would give this pack out for another input.
bake::FilesUsed checkRecipe(const Options& options, const std::string& info, const bake::FilesUsed& told) {
  std::optional<bake::Recipe> recipe = bake::recipeNow(info, options.input, options.settings, told);
  if (!recipe || recipe->info != info)
    throw ToolError(Exit::kRuntime, options.input.string() +
                                        ": its pack says that it was made of something else; if a file "
                                        "that it reads was changed meanwhile, bake again; else please "
                                        "report this as a defect, with the file");
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
  OutputFile output(options.output);
  const auto show = [&](const Stage& stage) {
    if (announce && stage.estimated_bytes > 0) {
      display.clear();
      printEstimate(options, stage.estimated_bytes);
      announce = false;
    }
    display.show(stage.name, stage.done);
  };
  auto [report, containment] = bakeContained(options, output, show);
  const std::string info = checkFinished(options, output, report);
  report.files = checkRecipe(options, info, report.files);
  checkRoles(options, report.files, place);
  if (interrupted()) throw ToolError(Exit::kInterrupted, "interrupted");
  output.commit();
  display.clear();
  Baked baked;
  baked.seconds = secondsSince(start);
  const std::string report_text = reportJson(options, report, containment, baked.seconds);
  if (cache && !cache->store(options, info, report_text, report.pack_hash))
    report.notices.push_back(
        "--cache " + options.cache_folder->string() +
        ": the pack could not be kept there; see that there is space, and that you may write to it");
  if (options.report_file) writeTextFile(*options.report_file, report_text);
  if (options.dependency_file) writeDependencies(*options.dependency_file, options, report.files);
  baked.notices = report.notices;
  baked.pack_bytes = report.pack_bytes;
  baked.report = std::move(report);
  return baked;
}

}  // namespace kelp::bake_cli
