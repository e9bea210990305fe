// SPDX-License-Identifier: MIT
// OpenVDB and the libraries beneath it take longer to load than most packs to verify: what needs them is in a program of its own, kelp-dump-vdb, which is this one with OpenVDB.
#include <cerrno>
#include <filesystem>
#include <system_error>

#include <unistd.h>

#include "commands.h"
#include "extract.h"

namespace kelp::dump {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPlaces[] = {"kelp-dump-vdb", "../libexec/kelp/kelp-dump-vdb"};

fs::path ownFolder() {
  std::error_code unknown;
  return fs::read_symlink("/proc/self/exe", unknown).parent_path();
}

bool isThere() {
  const fs::path folder = ownFolder();
  for (const char* place : kPlaces)
    if (::access((folder / place).c_str(), X_OK) == 0) return true;
  return false;
}

// The same process, standard input and output, and these arguments. DumpError: kUnsupported if the program is not there, kFailure if it can not be run.
void becomeVdbProgram(std::vector<std::string> arguments) {
  std::vector<char*> argv{const_cast<char*>("kelp-dump")};
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const fs::path folder = ownFolder();
  for (const char* place : kPlaces) {
    ::execv((folder / place).c_str(), argv.data());  // comes back only if it fails
    if (errno == ENOENT) continue;
    throw DumpError(kFailure, (folder / place).string() + ": can not be run: " + std::generic_category().message(errno) + "; install kelp's programs anew");
  }
  throw DumpError(kUnsupported, "--vdb and --nvdb are the work of kelp-dump-vdb, which is neither in " + folder.string() + " nor in libexec/kelp beside it; install kelp's programs anew, or build them where OpenVDB is installed");
}

}  // namespace

constinit const Writer kVdbWriter{.name = "vdb", .needs = "", .handOver = becomeVdbProgram, .isThere = isThere};
constinit const Writer kNanoVdbWriter{.name = "nvdb", .needs = "", .handOver = becomeVdbProgram, .isThere = isThere};

}  // namespace kelp::dump
