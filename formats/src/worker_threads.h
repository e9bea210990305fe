// SPDX-License-Identifier: MIT
#pragma once

namespace kelp {

// Calls work(user) on `threads` threads at the same time, including the calling one, and returns when all
// have ended. If the system refuses a thread, fewer run. So work() must distribute its jobs itself.
void runOnThreads(int threads, void (*work)(void* user), void* user);

}  // namespace kelp
