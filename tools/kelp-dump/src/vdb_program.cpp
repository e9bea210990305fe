// SPDX-License-Identifier: MIT
#include "vdb_program.h"

#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>

#include <unistd.h>

#include "commands.h"

namespace kelp::dump {

void becomeVdbProgram(std::vector<std::string> arguments) {
  std::vector<char*> argv{const_cast<char*>("kelp-dump")};
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  std::error_code unknown;
  const std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path();
  for (const char* place : {"kelp-dump-vdb", "../libexec/kelp/kelp-dump-vdb"}) {
    execv((folder / place).c_str(), argv.data());  // comes back only if it fails
    if (errno == ENOENT) continue;
    throw DumpError(kFailure, (folder / place).string() + ": can not be run: " + std::generic_category().message(errno) + "; install kelp's programs anew");
  }
  throw DumpError(kUnsupported, "--vdb and --nvdb are the work of kelp-dump-vdb, which is neither in " + folder.string() + " nor in libexec/kelp beside it; install kelp's programs anew");
}

}  // namespace kelp::dump
