// SPDX-License-Identifier: MIT
#include "cli/interrupt.h"

#include <atomic>
#include <csignal>
#include <cstdint>
#include <ctime>
#include <initializer_list>

#include "cli/messages.h"
#include "kelp/common/output_file.h"

namespace kelp::bake_cli {
namespace {

// `timeout` signals a program and its group: two signals within this time count as one.
constexpr std::int64_t kOneSignal = 100'000'000;  // ns

std::atomic<std::int64_t> g_interrupted{0};  // the time of the first signal, in ns; 0: none yet
static_assert(std::atomic<std::int64_t>::is_always_lock_free, "a signal handler must not wait");

std::int64_t monotonicTime() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return time.tv_sec * std::int64_t{1'000'000'000} + time.tv_nsec;
}

void hearInterrupt(int) {
  std::int64_t first = 0;
  if (!g_interrupted.compare_exchange_strong(first, monotonicTime()) && monotonicTime() - first > kOneSignal)
    endInterrupted();
}

}  // namespace

void catchInterrupts() {
  guardOutput(errorLine(Exit::kInterrupted, "interrupted"));
  struct sigaction action {};
  action.sa_handler = hearInterrupt;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    if (before.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);  // nohup, background jobs
  }
  std::signal(SIGPIPE, SIG_IGN);  // a reader of the messages that goes away does not end the bake
  std::signal(SIGXFSZ, SIG_IGN);  // a limit on the size of files becomes an error of writing
}

void hearParentOnly() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_IGN);
  std::signal(SIGUSR1, [](int) { g_interrupted = monotonicTime(); });
  sigset_t heard;
  sigemptyset(&heard);
  sigaddset(&heard, SIGUSR1);
  sigprocmask(SIG_UNBLOCK, &heard, nullptr);  // the parent may have blocked it
}

bool interrupted() { return g_interrupted != 0; }

}  // namespace kelp::bake_cli
