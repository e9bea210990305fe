// SPDX-License-Identifier: MIT
// What a process of Linux gives up before it reads a stranger's file: Landlock takes its files, seccomp what
// it may ask of the system. Both are final, and threads that it starts inherit them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace kelp::bake_cli {

// What the kernel has of them, or what holds for a process.
struct Containment {
  int landlock = 0;  // version of its interface; 0: none
  bool seccomp = false;
};

Containment containmentOfKernel();
// "contained by Landlock 7 and seccomp", or what this kernel lacks.
std::string describe(const Containment& containment);

// From now on this thread and those that it starts may open only `readable` (files, or folders with all
// below), the system's libraries and what the system tells of itself; nothing for writing. What is open stays
// so. Names that are not there are left out. Programs, processes, sockets, and calls that change files, other
// processes or the system end in `forbidden`, on the thread that made them, with the call's number. It must
// not return, and may only do what a signal handler may. Call it while there is one thread. What the kernel
// lacks, or does not grant, is missing in the answer.
Containment giveUpAllBut(const std::vector<std::filesystem::path>& readable, void (*forbidden)(int call));

// "execve (starting a program)", for a call that ended in `forbidden`.
std::string nameOfCall(int call);

}  // namespace kelp::bake_cli
