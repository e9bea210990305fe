// SPDX-License-Identifier: MIT
// kelp-bake: a thin main over kelp::bake. Every exception ends here, as a line and an exit code.
#include <algorithm>
#include <cerrno>
#include <exception>
#include <new>
#include <span>
#include <string>
#include <system_error>
#include <vector>

#include <sys/stat.h>
#include <unistd.h>

#include "cli/interrupt.h"
#include "cli/messages.h"
#include "cli/options.h"
#include "cli/progress_display.h"
#include "cli/report_json.h"
#include "contained/contained.h"
#include "kelp/common/console.h"
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

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// XXH3-128 of all bytes; nullopt if they cannot be read.
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

// Reads by the descriptor, because permissions may forbid opening the file for reading.
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

// Verifies the child's pack before it takes its place, and counts and hashes its bytes: the child's word for
// them is not trusted.
void checkPackOfChild(const Options& options, OutputFile& output, bake::Report& report) {
  const auto start = Clock::now();
  const std::string name = options.output.string(), input = options.input.string();
  struct stat status {};
  if (::fstat(output.descriptor(), &status) != 0)
    throw ToolError(Exit::kIo, name + ": cannot be read again; check the disk");
  const Source source{&readOutput, &output, static_cast<std::uint64_t>(status.st_size), nullptr, nullptr};
  std::optional<Issue> issue;
  verify(
      source, PackLimits(),
      [](void* first, const Issue& found) {
        auto& kept = *static_cast<std::optional<Issue>*>(first);
        if (found.severity == Severity::kError && !kept) kept = found;
      },
      &issue, {}, threadCount(options.settings.threads));
  if (issue && exitOf(issue->error.code) != Exit::kInvalid) failPack(name, issue->error);
  if (issue)
    throw ToolError(Exit::kRuntime, input + ": the pack that its bake wrote is not sound (" +
                                        toString(issue->id) +
                                        "); please report this as a defect, with the file");
  const Pack pack = checkPack(name, Pack::open(source));
  if (!pack.infoJson().starts_with(bake::sourceInfo(options.input, report.format, hashFile(options.input))))
    throw ToolError(Exit::kRuntime, input +
                                        ": its pack says that it was made of something else; if the "
                                        "file was changed meanwhile, bake again; else please report "
                                        "this as a defect, with the file");
  const std::optional<std::string> hash = hashOf(source);
  if (!hash) throw ToolError(Exit::kIo, name + ": cannot be read again; check the disk");
  report.pack_bytes = source.size;
  report.pack_hash = *hash;
  const std::uint64_t before = report.stages.empty() ? 0 : report.stages.back().peak_bytes;  // of the child
  report.stages.push_back({"check", secondsSince(start), std::max(before, peakMemory())});
}

// Report and rule name the files that were read. The child may only name those that it was allowed to read.
void checkFiles(const Options& options, const bake::FilesUsed& files) {
  std::vector<fs::path> places;
  for (const fs::path& place : placesToRead(options)) places.push_back(place.lexically_normal());
  std::vector<fs::path> read;
  for (const bake::FilesUsed::File& file : files.read) {
    const bool allowed = std::any_of(places.begin(), places.end(), [&](const fs::path& place) {
      const fs::path below = file.path.lexically_normal().lexically_relative(place);
      return !below.empty() && *below.begin() != "..";
    });
    if (!allowed)
      throw ToolError(Exit::kRuntime, options.input.string() +
                                          ": its bake says that it read a file of another folder; please "
                                          "report this as a defect, with the file");
    read.push_back(file.path);
  }
  checkClashes(options, read);
  if (options.dependency_file) checkDependencies(options, files);
}

// Pack, report and rule. On an error, existing files stay as they were and no others are left.
void bakeFile(const Options& options) {
  std::error_code error;
  if (!fs::exists(options.input, error))
    throw ToolError(Exit::kIo, options.input.string() + ": no such file; check the name");
  checkClashes(options);
  catchInterrupts();
  checkOutput(options.output);
  if (options.report_file) checkTextOutput(*options.report_file);
  if (options.dependency_file) checkTextOutput(*options.dependency_file);

  const auto start = Clock::now();
  OutputFile output(options.output);
  ProgressDisplay display(options.progress);
  bool announced = false;
  auto [report, containment] = bakeContained(options, output, [&](const Stage& stage) {
    if (!announced && stage.estimated_bytes > 0) {
      display.clear();
      printEstimate(options, stage.estimated_bytes);
      announced = true;
    }
    display.show(stage.name, stage.done);
  });
  checkPackOfChild(options, output, report);
  checkFiles(options, report.files);
  if (interrupted()) throw ToolError(Exit::kInterrupted, "interrupted");
  output.commit();
  display.clear();
  const double seconds = secondsSince(start);
  if (options.report_file)
    writeTextFile(*options.report_file, reportJson(options, report, containment, seconds));
  if (options.dependency_file) writeDependencies(*options.dependency_file, options, report.files);
  printSummary(options, report, seconds);
}

// Before parsing, so that usage errors are JSON too.
bool asksForJson(const std::vector<std::string>& words) {
  for (std::size_t i = 1; i < words.size(); ++i)
    if (words[i] == "--progress=json" || (words[i] == "json" && words[i - 1] == "--progress")) return true;
  return false;
}

Exit run(const std::vector<std::string>& words) {
  try {
    if (asksForJson(words)) speakJson();
    if (const std::optional<Options> options = parseCommandLine(words)) bakeFile(*options);
    return Exit::kOk;
  } catch (const ToolError& error) {
    sayError(error.exit, error.what());
    return error.exit;
  } catch (const std::bad_alloc&) {
    sayError(Exit::kRuntime, "out of memory; lower --resolution");
  } catch (const std::exception& error) {
    sayError(Exit::kRuntime, std::string("unexpected: ") + error.what() + "; please report this as a defect");
  }
  return Exit::kRuntime;
}

}  // namespace
}  // namespace kelp::bake_cli

int main(int argc, char** argv) {
  kelp::console::prepareStreams();
  return static_cast<int>(kelp::bake_cli::run(kelp::console::arguments(argc, argv)));
}
