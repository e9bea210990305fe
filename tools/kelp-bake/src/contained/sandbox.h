// SPDX-License-Identifier: MIT
// The sandbox of a Linux process that reads a stranger's file: Landlock restricts files, seccomp system
// calls. Both are final. New threads inherit them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace kelp::bake_cli {

// The sandboxes of a kernel or a process.
struct Containment {
  int landlock = 0;  // version of its interface; 0: none
  bool seccomp = false;
};

Containment containmentOfKernel();
// "contained by Landlock 7 and seccomp", or the part that this kernel lacks.
std::string describe(const Containment& containment);

// From now on this thread and those that it starts may only open `readable` (files, or folders with all
// below), the system's libraries and its description in /proc and /sys, and nothing for writing. Open files
// stay open. Missing names are skipped. Calls that start programs, processes or sockets, or change files,
// other processes or the system, end in `forbidden` with the call's number, on the thread that made them.
// `forbidden` must not return and must be safe in a signal handler. Call this while there is one thread.
// Returns the sandboxes that the kernel granted.
Containment giveUpAllBut(const std::vector<std::filesystem::path>& readable, void (*forbidden)(int call));

// "execve (starting a program)", for a call that ended in `forbidden`.
std::string nameOfCall(int call);

}  // namespace kelp::bake_cli
