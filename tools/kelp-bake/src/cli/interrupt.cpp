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

// `timeout` signals a program and its group: a second signal so soon is no second wish.
constexpr std::int64_t kSameWish = 100'000'000;  // ns

std::atomic<std::int64_t> g_interrupted{0};  // when, in ns; 0: not yet
static_assert(std::atomic<std::int64_t>::is_always_lock_free, "a signal handler must not wait");

std::int64_t monotonicTime() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return time.tv_sec * std::int64_t{1'000'000'000} + time.tv_nsec;
}

void hearInterrupt(int) {
  std::int64_t first = 0;
  if (!g_interrupted.compare_exchange_strong(first, monotonicTime()) && monotonicTime() - first > kSameWish)
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
    // nohup, and shells for jobs in the background, ask for that
    if (before.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
  }
  std::signal(SIGPIPE, SIG_IGN);  // a reader of our messages that goes away is no reason to stop
  // a limit on the size of files is an error of writing, not the end with half a file left behind
  std::signal(SIGXFSZ, SIG_IGN);
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
