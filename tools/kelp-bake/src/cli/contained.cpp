// SPDX-License-Identifier: MIT
#include "cli/contained.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli/interrupt.h"
#include "kelp/common/output_file.h"

namespace kelp::bake_cli {
namespace {

using Clock = std::chrono::steady_clock;

// What the child tells: a byte each; after kOutcome the exit code in a byte, and the text to the end.
constexpr char kImportBegins = 'i', kImportEnds = 'e', kOutcome = 'o';
// Memory that the program itself may use, beyond the model's.
constexpr std::uint64_t kOwnBytes = std::uint64_t{64} << 20;
// Stacks count as data: of the bake's own threads and of TBB's.
constexpr std::uint64_t kThreadsOfEach = 2;
// How often the parent looks up.
constexpr std::chrono::milliseconds kTick{200};
// How long the child may go on after Ctrl-C: while it imports, no one can stop it in order; else it looks up
// itself, but in a model made to do harm perhaps not for hours.
constexpr std::chrono::milliseconds kImportGrace = kTick, kGrace{5000};

// Of the child.
struct Child {
  int pipe = -1;  // to the parent; -1: this is none
  std::uint64_t import_bytes = 0;
  bool importing = false;
  rlimit before{};
} g_child;

void tell(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(g_child.pipe, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) std::_Exit(static_cast<int>(Exit::kRuntime));  // no parent
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

std::uint64_t importBytes(const Options& options) {
  const std::uint64_t memory = options.settings.max_memory > 0
                                   ? options.settings.max_memory
                                   : static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) *
                                         static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  const unsigned threads = options.settings.threads > 0 ? static_cast<unsigned>(options.settings.threads)
                                                        : std::thread::hardware_concurrency();
  pthread_attr_t attributes;
  std::size_t stack = 0;
  if (pthread_getattr_default_np(&attributes) == 0) {
    pthread_attr_getstacksize(&attributes, &stack);
    pthread_attr_destroy(&attributes);
  }
  return memory + kOwnBytes + kThreadsOfEach * threads * stack;
}

// What the system counts against RLIMIT_DATA; 0 if it does not say.
std::uint64_t dataBytes() {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word) {
    std::uint64_t kilobytes = 0;
    if (word == "VmData:" && status >> kilobytes) return kilobytes * 1024;
  }
  return 0;
}

// Waits until all other threads of this process sleep, for a moment at most. log4cplus, which comes with
// OpenVDB, has started some before main, which may still be on their way to sleep: forked off just then, the
// child would have their locks for ever, such as an allocator's.
void waitForOthers() {
  const std::string self = std::to_string(gettid());
  const auto sleep = [&self] {
    std::error_code error;
    for (std::filesystem::directory_iterator task("/proc/self/task", error), end; !error && task != end;
         task.increment(error)) {
      if (task->path().filename() == self) continue;
      std::string stat;
      std::getline(std::ifstream(task->path() / "stat"), stat);
      const std::size_t name_end = stat.rfind(')');
      if (name_end != std::string::npos && stat.compare(name_end, 3, ") S") != 0) return false;
    }
    return true;  // or this system does not say
  };
  for (int i = 0; i < 100 && !sleep(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

[[noreturn]] void runChild(pid_t parent, int pipe, const Options& options,
                           const std::function<Outcome()>& work) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  // it has ended before it could be watched
  if (getppid() != parent) std::_Exit(static_cast<int>(Exit::kRuntime));
  hearParentOnly();
  g_child.pipe = pipe;
  g_child.import_bytes = importBytes(options);
  try {
    const Outcome outcome = work();
    tell(std::string{kOutcome, static_cast<char>(outcome.exit)} + outcome.text);
  } catch (...) {  // such as no memory for the outcome
    std::_Exit(static_cast<int>(Exit::kRuntime));
  }
  ::close(pipe);
  std::fflush(nullptr);
  std::_Exit(0);  // at an orderly exit log4cplus would wait for its threads, and here they are not
}

// What has come from the child.
class Messages {
 public:
  explicit Messages(int pipe) : pipe_(pipe) {}
  ~Messages() { ::close(pipe_); }
  Messages(const Messages&) = delete;
  Messages& operator=(const Messages&) = delete;

  // Waits for some, for a tick at most. false: there will be no more.
  bool read() {
    pollfd waiting{pipe_, POLLIN, 0};
    if (::poll(&waiting, 1, static_cast<int>(kTick.count())) <= 0) return true;
    char bytes[4096];
    const ssize_t size = ::read(pipe_, bytes, sizeof bytes);
    if (size < 0) return errno == EINTR || errno == EAGAIN;
    for (const char byte : std::string_view(bytes, static_cast<std::size_t>(size))) take(byte);
    return size > 0;
  }
  bool importing() const { return importing_; }
  bool imported() const { return imported_; }
  std::optional<Outcome> outcome() const {
    if (outcome_.empty()) return std::nullopt;
    return Outcome{static_cast<Exit>(static_cast<unsigned char>(outcome_[0])), outcome_.substr(1)};
  }

 private:
  void take(char byte) {
    if (in_outcome_) {
      outcome_ += byte;
    } else if (byte == kOutcome) {
      in_outcome_ = true;
      importing_ = false;
    } else {
      importing_ = byte == kImportBegins;
      imported_ |= byte == kImportEnds;
    }
  }

  int pipe_;
  bool importing_ = false, imported_ = false, in_outcome_ = false;
  std::string outcome_;
};

int wait(pid_t child) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

[[noreturn]] void failedBy(int status, const Options& options, const Messages& messages) {
  const std::string when = messages.imported()    ? " after the file was read"
                           : messages.importing() ? " while the file was read"
                                                  : " before the file was read";
  std::string what;
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) {
    what = "the bake was killed" + when +
           "; most likely memory gave out: lower --resolution, or give --max-memory; or a limit of the "
           "system (ulimit -t) was reached";
  } else if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) {
    what = "the bake has had the processor time that the system allows (ulimit -t)" + when +
           "; raise that limit";
  } else {
    what = (WIFSIGNALED(status)
                ? std::string("the bake crashed (") + strsignal(WTERMSIG(status)) + ")"
                : "the bake ended by itself (exit code " + std::to_string(WEXITSTATUS(status)) + ")") +
           when + "; please report this as a defect, with the file; it may be damaged, or made to do harm";
  }
  throw ToolError(Exit::kRuntime, options.input.string() + ": " + what);
}

}  // namespace

Outcome contained(const Options& options, ProgressDisplay& display, const std::function<Outcome()>& work) {
  if (interrupted()) throw ToolError(Exit::kInterrupted, "interrupted");
  int ends[2];
  const pid_t self = getpid();
  std::fflush(nullptr);           // or the child would write it, too
  std::signal(SIGCHLD, SIG_DFL);  // if it were ignored, waitpid() would not return the child's status
  pid_t child = -1;
  if (::pipe2(ends, O_CLOEXEC) == 0) {
    waitForOthers();
    child = ::fork();
    if (child == 0) {
      ::close(ends[0]);
      runChild(self, ends[1], options, work);
    }
    const int error = errno;
    ::close(ends[1]);
    if (child < 0) ::close(ends[0]);
    errno = error;
  }
  if (child < 0)
    throw ToolError(Exit::kRuntime, options.input.string() + ": no process can be started for its bake: " +
                                        std::generic_category().message(errno) +
                                        "; end others, or raise their limit (ulimit -u, -n)");

  Messages messages(ends[0]);
  Clock::duration importing{0};
  std::optional<Clock::duration> since_interrupt;
  bool overdue = false;
  for (auto last = Clock::now(); messages.read();) {
    const auto now = Clock::now();
    // a program that was stopped (Ctrl-Z) has not spent the time
    const auto tick = std::min<Clock::duration>(now - last, 2 * kTick);
    last = now;
    if (since_interrupt) *since_interrupt += tick;
    if (interrupted() && !since_interrupt) {
      ::kill(child, SIGUSR1);
      since_interrupt = Clock::duration{0};
    }
    if (messages.importing()) importing += tick;
    overdue = !since_interrupt && messages.importing() &&
              importing > std::chrono::seconds(options.max_import_seconds);
    if (overdue || (since_interrupt && *since_interrupt > (messages.importing() ? kImportGrace : kGrace))) {
      ::kill(child, SIGKILL);
      break;
    }
  }
  const int status = wait(child);
  std::optional<Outcome> outcome = messages.outcome();
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0 && outcome) return *std::move(outcome);
  display.takeOver();
  for (const auto& file : {std::optional(options.output), options.report_file, options.dependency_file}) {
    if (file) OutputFile::removeLeftBy(child, *file);
  }
  if (overdue) {
    throw ToolError(
        Exit::kRuntime,
        options.input.string() + ": reading it takes longer than " +
            std::to_string(options.max_import_seconds) +
            " s; it may be damaged, or made to do harm; if it is neither, give a larger --max-import-time");
  }
  if (since_interrupt) throw ToolError(Exit::kInterrupted, "interrupted");
  failedBy(status, options, messages);
}

void enterStage(std::string_view stage) {
  const bool importing = stage == "import";
  if (g_child.pipe < 0 || importing == g_child.importing) return;
  g_child.importing = importing;
  tell({importing ? &kImportBegins : &kImportEnds, 1});
  if (!importing) {
    setrlimit(RLIMIT_DATA, &g_child.before);
  } else if (getrlimit(RLIMIT_DATA, &g_child.before) == 0) {
    rlimit limit = g_child.before;
    if (const std::uint64_t data = dataBytes(); data > 0)
      limit.rlim_cur = std::min<rlim_t>(limit.rlim_cur, data + g_child.import_bytes);
    setrlimit(RLIMIT_DATA, &limit);
  }
}

}  // namespace kelp::bake_cli
