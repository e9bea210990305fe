// SPDX-License-Identifier: MIT
#include "contained/contained.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <new>
#include <string>
#include <thread>

#include <fcntl.h>
#include <pthread.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "cli/interrupt.h"
#include "contained/sandbox.h"
#include "contained/wire.h"
#include "kelp/common/memory.h"
#include "kelp/import/core/input_files.h"

namespace kelp::bake_cli {
namespace {

using Clock = std::chrono::steady_clock;

// Memory that the program itself may use, beyond the model's.
constexpr std::uint64_t kOwnBytes = std::uint64_t{64} << 20;
// Stacks count as data: of the bake's own threads and of TBB's.
constexpr std::uint64_t kThreadsOfEach = 2;
// Data of the program before the bake, if /proc does not tell.
constexpr std::uint64_t kUnknownBytes = std::uint64_t{256} << 20;
// The shortest time between two progress messages of a stage.
constexpr std::chrono::milliseconds kTellEvery{20};

int g_pipe = -1;  // for the handler of forbidden calls

[[noreturn]] void endWith(Exit exit) { std::_Exit(static_cast<int>(exit)); }

[[noreturn]] void endForbidden(int call) {
  tell(g_pipe, Word::kForbidden, {reinterpret_cast<const char*>(&call), sizeof call});
  endWith(Exit::kRuntime);
}

// The bytes that the system counts against RLIMIT_DATA. Without /proc, an upper bound.
std::uint64_t dataBytes() {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word) {
    std::uint64_t kilobytes = 0;
    if (word == "VmData:" && status >> kilobytes) return kilobytes * 1024;
  }
  return peakMemory() + kUnknownBytes;
}

std::uint64_t stackBytes(int threads) {
  pthread_attr_t attributes;
  std::size_t stack = 0;
  if (pthread_getattr_default_np(&attributes) == 0) {
    pthread_attr_getstacksize(&attributes, &stack);
    pthread_attr_destroy(&attributes);
  }
  const unsigned count = threads > 0 ? static_cast<unsigned>(threads) : std::thread::hardware_concurrency();
  return kThreadsOfEach * count * stack;
}

// Limits this process for good, not beyond what held for it.
void limit(__rlimit_resource kind, std::uint64_t bytes) {
  rlimit now{};
  if (getrlimit(kind, &now) != 0) return;
  now.rlim_cur = std::min<rlim_t>(now.rlim_cur, bytes);
  now.rlim_max = std::min<rlim_t>(now.rlim_max, bytes);
  setrlimit(kind, &now);
}

// The memory of the model and the program, and the size of the output. No core: it would hold as much again.
void limitChild(const bake::Settings& settings) {
  const std::uint64_t model = settings.max_memory > 0 ? settings.max_memory : physicalMemory(),
                      memory = model + dataBytes() + kOwnBytes + stackBytes(settings.threads);
  limit(RLIMIT_DATA, memory);
  limit(RLIMIT_FSIZE, physicalMemory());
  limit(RLIMIT_CORE, 0);
  // should memory give out, this is the process to end
  std::ofstream("/proc/self/oom_score_adj") << 1000;
}

// Closes all but the output and the two pipes. One pipe becomes stdout and stderr, for libraries.
void keepOpen(int pipe, int prints, int output) {
  const int nothing = ::open("/dev/null", O_RDONLY);
  ::dup2(nothing, STDIN_FILENO);
  ::dup2(prints, STDOUT_FILENO);
  ::dup2(prints, STDERR_FILENO);
  unsigned first = STDERR_FILENO + 1;
  for (const int kept : {std::min(pipe, output), std::max(pipe, output)}) {
    const auto open = static_cast<unsigned>(kept);
    if (open > first) ::close_range(first, open - 1, 0);
    first = std::max(first, open + 1);
  }
  ::close_range(first, ~0U, 0);
}

std::string bakeInto(const Options& options, OutputFile& output, int pipe, const Containment& containment) {
  bake::Report report;
  std::string shown;
  Clock::time_point told{};
  const auto progress = [&](std::string_view stage, double done) {
    const auto now = Clock::now();
    if (stage != shown || done >= 1 || now - told >= kTellEvery) {
      shown = stage;
      told = now;
      if (!tell(pipe, Word::kProgress, packed(Stage{shown, done, report.estimated_bytes})))
        endWith(Exit::kRuntime);  // no parent
    }
    return !interrupted();
  };
  const RawPack pack = bake::bake(options.input, options.settings, report, progress);
  bake::writePackInto(pack, output, options.settings.threads, report, progress, options.settings.effort);
  return packed(report, containment);
}

}  // namespace

std::vector<std::filesystem::path> placesToRead(const Options& options) {
  const std::filesystem::path& input = options.input;
  const bake::Settings& settings = options.settings;
  std::vector<std::filesystem::path> places{input, input.has_parent_path() ? input.parent_path() : "."};
  const auto add_beside = [&](const char* extension) {
    places.push_back(std::filesystem::path(input).replace_extension(extension));
  };
  if (!settings.rig_file && !settings.rig_preset) add_beside(".rig.json");
  if (bake::lowerExtension(input) == ".raw") {
    add_beside(".raw.json");
    add_beside(".json");
  }
  for (const auto& file : {settings.rig_file, settings.palette_file, settings.ramp_file})
    if (file) places.push_back(*file);
  return places;
}

void runChild(pid_t parent, int pipe, int prints, const Options& options, OutputFile& output) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) endWith(Exit::kRuntime);  // the parent ended before the line above
  hearParentOnly();
  g_pipe = pipe;
  const auto fail = [&](Exit exit, const std::string& what) {
    tell(pipe, Word::kFailed, packed(ToolError(exit, what)));
  };
  const std::string input = options.input.string();
  try {
    keepOpen(pipe, prints, output.descriptor());
    limitChild(options.settings);
    const Containment containment = giveUpAllBut(placesToRead(options), endForbidden);
    tell(pipe, Word::kDone, bakeInto(options, output, pipe, containment));
  } catch (const ToolError& error) {
    fail(error.exit, error.what());
  } catch (const std::bad_alloc&) {
    fail(Exit::kRuntime, input + ": out of memory; lower --resolution, or raise --max-memory");
  } catch (const std::exception& error) {
    fail(Exit::kRuntime, input + ": unexpected: " + error.what() + "; please report this as a defect");
  }
  endWith(Exit::kOk);  // exit() would wait for log4cplus's threads, which this process does not have
}

}  // namespace kelp::bake_cli
