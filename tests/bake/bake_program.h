// SPDX-License-Identifier: MIT
// Files made to do harm go through the program, whose child process holds what a library does with them.
#pragma once

#include <cstdio>
#include <filesystem>
#include <string>

#include <sys/wait.h>

#include <gtest/gtest.h>

namespace kelp::bake::test {

struct Baked {
  int exit = -1;  // -1: by a signal
  std::string text;
};

inline Baked bakeByProgram(const std::filesystem::path& path, const std::string& options = "") {
  Baked baked;
  std::FILE* const pipe = ::popen(("'" KELP_BAKE "' '" + path.string() + "' -o '" + path.string() +
                                   ".kelp' --progress none " + options + " 2>&1 >/dev/null")
                                      .c_str(),
                                  "r");
  char bytes[4096];
  for (std::size_t size = 0; (size = std::fread(bytes, 1, sizeof(bytes), pipe)) > 0;)
    baked.text.append(bytes, size);
  const int status = ::pclose(pipe);
  if (WIFEXITED(status)) baked.exit = WEXITSTATUS(status);
  return baked;
}

// Either a pack, or a refusal of one clamped line.
inline Baked bakeHostile(const std::filesystem::path& path, const std::string& options) {
  const Baked baked = bakeByProgram(path, options);
  EXPECT_TRUE(baked.exit == 0 || baked.exit == 3 || baked.exit == 4 || baked.exit == 5 || baked.exit == 1)
      << baked.exit << baked.text;
  if (baked.exit != 0) {
    EXPECT_LT(baked.text.size(), 6000u);
    EXPECT_EQ(baked.text.find('\n'), baked.text.size() - 1) << baked.text;
  }
  return baked;
}

}  // namespace kelp::bake::test
