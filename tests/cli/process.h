// SPDX-License-Identifier: MIT
// Runs a program as a user would and keeps what it says.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "support/scratch.h"

namespace kelp::test {

struct ProcessResult {
  int exit = -1;  // 128 + signal if it was killed
  std::string out, err;
};

inline std::string readWhole(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
}

// arguments[0] is the program. stdout and stderr are files, no terminal.
inline ProcessResult runProcess(const std::vector<std::string>& arguments) {
  const Scratch scratch;
  const std::string out = scratch / "out", err = scratch / "err";
  std::string command;
  for (const std::string& argument : arguments) {
    command += "'";
    for (const char c : argument) command += c == '\'' ? std::string("'\\''") : std::string(1, c);
    command += "' ";
  }
  command += "> '" + out + "' 2> '" + err + "' < /dev/null";
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), readWhole(out), readWhole(err)};
}

}  // namespace kelp::test
