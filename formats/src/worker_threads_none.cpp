// SPDX-License-Identifier: MIT
// For systems without threads: the web, unless asked for.
#include "worker_threads.h"

namespace kelp {

void runOnThreads(int, void (*work)(void* user), void* user) { work(user); }

}  // namespace kelp
