// SPDX-License-Identifier: MIT
#pragma once

namespace kelp {

// Calls work(user) on `threads` threads at once, the caller's among them, and comes back when all have ended. Where the system
// refuses more threads, fewer do it: work must therefore share its jobs out by itself.
void runOnThreads(int threads, void (*work)(void* user), void* user);

}  // namespace kelp
