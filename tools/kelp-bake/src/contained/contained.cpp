// SPDX-License-Identifier: MIT
#include "contained/contained.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli/interrupt.h"
#include "kelp/common/console.h"

namespace kelp::bake_cli {
namespace {

using Clock = std::chrono::steady_clock;

// The parent checks for signals and timeouts this often.
constexpr std::chrono::milliseconds kTick{200};
// Time that the child gets after Ctrl-C. An import cannot be stopped in order; later stages poll, but with a
// hostile model perhaps not for hours.
constexpr std::chrono::milliseconds kImportGrace = kTick, kGrace{5000};
// Bytes of library output that are shown if the child crashes.
constexpr std::size_t kMostPrinted = 1000;

// Waits until all other threads of this process sleep, for 0.1 s at most. OpenVDB's log4cplus starts some
// before main. A child that is forked while they still run keeps their locks for ever, such as the
// allocator's.
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
    return true;  // or there is no /proc
  };
  for (int i = 0; i < 100 && !sleep(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

// The child opens its inputs by path, and more than once. It inherits no descriptors.
void checkKinds(const Options& options) {
  for (const std::filesystem::path& path : placesToRead(options)) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (std::filesystem::is_other(status))
      throw ToolError(Exit::kIo, console::nameOf(path) +
                                     ": is a pipe or a device; write it to a file first, as inputs are read "
                                     "more than once");
  }
}

struct Pipe {
  int from = -1, to = -1;
  Pipe() {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) == 0) from = ends[0], to = ends[1];
  }
  ~Pipe() {
    closeWriter();
    if (from >= 0) ::close(from);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void closeWriter() {
    if (to >= 0) ::close(std::exchange(to, -1));
  }
};

// The child process, watched by its parent.
class Child {
 public:
  Child(const Options& options, OutputFile& output, const std::function<void(const Stage&)>& show)
      : options_(options), show_(show) {
    std::fflush(nullptr);           // otherwise the child would write it too
    std::signal(SIGCHLD, SIG_DFL);  // if it were ignored, waitpid() would not return the child's status
    const pid_t self = ::getpid();
    if (words_.from >= 0 && prints_.from >= 0) {
      waitForOthers();
      process_ = ::fork();
      if (process_ == 0) runChild(self, words_.to, prints_.to, options, output);
    }
    if (process_ < 0)
      fail("no process can be started for its bake: " + std::generic_category().message(errno) +
           "; end others, or raise their limit (ulimit -u, -n)");
    words_.closeWriter();
    prints_.closeWriter();
  }
  ~Child() {
    if (process_ < 0) return;
    ::kill(process_, SIGKILL);
    int ignored = 0;
    while (::waitpid(process_, &ignored, 0) < 0 && errno == EINTR) {
    }
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  Contained watch() {
    for (auto last = Clock::now(); listen();) {
      const auto now = Clock::now();
      // The time while this program was stopped (Ctrl-Z) does not count.
      spend(std::min<Clock::duration>(now - last, 2 * kTick));
      last = now;
    }
    const int status = end();
    if (since_interrupt_) throw ToolError(Exit::kInterrupted, "interrupted");
    if (forbidden_)
      fail("its reader was stopped at " + nameOfCall(*forbidden_) + when() +
           ", which none has to do; the file is made to do harm, or this is a defect of kelp-bake: please "
           "report it");
    if (error_) throw *error_;
    if (done_ && WIFEXITED(status) && WEXITSTATUS(status) == 0) return std::move(*done_);
    failBy(status);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw ToolError(Exit::kRuntime, options_.input.string() + ": " + what);
  }

  bool importing() const { return stage_ == "import"; }

  std::string when() const {
    return stage_.empty() ? " before the file was read"
           : importing()  ? " while the file was read"
                          : " after the file was read";
  }

  // Waits for messages, for a tick at most. Returns false at their end.
  bool listen() {
    std::array<pollfd, 2> waiting{{{words_.from, POLLIN, 0}, {prints_.from, POLLIN, 0}}};
    if (::poll(waiting.data(), waiting.size(), static_cast<int>(kTick.count())) <= 0) return true;
    std::array<char, 65536> bytes;
    if (waiting[1].revents != 0) {
      const ssize_t size = ::read(prints_.from, bytes.data(), bytes.size());
      if (size > 0 && printed_.size() < kMostPrinted)
        printed_.append(bytes.data(), std::min<std::size_t>(static_cast<std::size_t>(size),
                                                            kMostPrinted - printed_.size()));
    }
    if (waiting[0].revents == 0) return true;
    const ssize_t size = ::read(words_.from, bytes.data(), bytes.size());
    if (size < 0) return errno == EINTR || errno == EAGAIN;
    messages_.add({bytes.data(), static_cast<std::size_t>(size)});
    try {
      while (const auto message = messages_.next()) hear(*message);
    } catch (const std::exception& error) {
      fail(std::string("its bake says what makes no sense (") + error.what() + ")" + when() +
           "; the file is made to do harm, or this is a defect of kelp-bake: please report it");
    }
    return size > 0;
  }

  void hear(const Messages::Message& message) {
    switch (message.word) {
      case Word::kProgress: {
        const Stage stage = unpackedStage(message.content);
        if (stage.name != stage_ || !importing()) spent_ = Clock::duration{0};
        stage_ = stage.name;
        show_(stage);
        return;
      }
      case Word::kDone:
        done_.emplace();
        return unpack(message.content, done_->report, done_->containment);
      case Word::kFailed:
        error_ = unpackedError(message.content);
        return;
      case Word::kForbidden:
        forbidden_.emplace();
        if (message.content.size() != sizeof *forbidden_) throw std::length_error("a call without a number");
        std::memcpy(&*forbidden_, message.content.data(), sizeof *forbidden_);
        return;
    }
    throw std::out_of_range("an unknown word");
  }

  void spend(Clock::duration time) {
    if (interrupted() && !since_interrupt_) {
      ::kill(process_, SIGUSR1);
      since_interrupt_ = Clock::duration{0};
    }
    if (since_interrupt_) {
      *since_interrupt_ += time;
      if (*since_interrupt_ > (importing() ? kImportGrace : kGrace))
        throw ToolError(Exit::kInterrupted, "interrupted");
      return;
    }
    spent_ += time;
    if (spent_ <= std::chrono::seconds(options_.max_import_seconds)) return;
    const std::string seconds = std::to_string(options_.max_import_seconds) + " s";
    if (importing())
      fail("reading it takes longer than " + seconds +
           "; it may be damaged, or made to do harm; if it is neither, give a larger --max-import-time");
    fail("its bake has not moved for " + seconds + when() +
         "; it may be damaged, or made to do harm; if it is neither, give a larger --max-import-time");
  }

  // The status of a child that has closed its pipe. SIGKILL if it does not end.
  int end() {
    int status = 0;
    for (auto waited = Clock::duration{0}; ::waitpid(process_, &status, WNOHANG) == 0; waited += kTick / 20) {
      if (waited > kGrace) return SIGKILL;
      std::this_thread::sleep_for(kTick / 20);
    }
    process_ = -1;
    return status;
  }

  [[noreturn]] void failBy(int status) const {
    std::string what;
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) {
      what = "the bake was killed" + when() +
             "; most likely memory gave out: lower --resolution, or give --max-memory; or a limit of the "
             "system (ulimit -t) was reached";
    } else if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) {
      what = "the bake has had the processor time that the system allows (ulimit -t)" + when() +
             "; raise that limit";
    } else {
      what = (WIFSIGNALED(status)
                  ? std::string("the bake crashed (") + strsignal(WTERMSIG(status)) + ")"
                  : "the bake ended by itself (exit code " + std::to_string(WEXITSTATUS(status)) + ")") +
             when() +
             "; the file is damaged or made to do harm, or this is a defect of kelp-bake: please report it, "
             "with the file";
    }
    if (!printed_.empty()) what += "; it said: " + console::oneLine(printed_);
    fail(what);
  }

  const Options& options_;
  const std::function<void(const Stage&)>& show_;
  Pipe words_, prints_;
  pid_t process_ = -1;
  Messages messages_;
  std::string stage_, printed_;
  std::optional<Contained> done_;
  std::optional<ToolError> error_;
  std::optional<int> forbidden_;
  Clock::duration spent_{0};  // by the import, or since the last progress of a later step
  std::optional<Clock::duration> since_interrupt_;
};

}  // namespace

Contained bakeContained(const Options& options, OutputFile& output,
                        const std::function<void(const Stage&)>& show) {
  if (interrupted()) throw ToolError(Exit::kInterrupted, "interrupted");
  checkKinds(options);
  return Child(options, output, show).watch();
}

}  // namespace kelp::bake_cli
