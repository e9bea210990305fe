// SPDX-License-Identifier: MIT
// Where programs have no threads: the web, unless asked for.
#include "worker_threads.h"

namespace kelp {

void runOnThreads(int, void (*work)(void* user), void* user) { work(user); }

}  // namespace kelp
