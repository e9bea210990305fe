// SPDX-License-Identifier: MIT
#include "cli/interrupt.h"

#include <csignal>
#include <initializer_list>

namespace kelp::bake_cli {
namespace {

volatile std::sig_atomic_t g_interrupted = 0;

}  // namespace

void catchInterrupts() {
  struct sigaction action {};
  action.sa_handler = [](int) { g_interrupted = 1; };
  action.sa_flags = SA_RESETHAND;
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
  std::signal(SIGUSR1, [](int) { g_interrupted = 1; });
  sigset_t heard;
  sigemptyset(&heard);
  sigaddset(&heard, SIGUSR1);
  sigprocmask(SIG_UNBLOCK, &heard, nullptr);  // the parent may have blocked it
}

bool interrupted() { return g_interrupted != 0; }

}  // namespace kelp::bake_cli
