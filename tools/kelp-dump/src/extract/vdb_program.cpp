// SPDX-License-Identifier: MIT
// OpenVDB and its libraries take longer to load than most packs to verify. So they are in a program of their
// own: kelp-dump-vdb, which is kelp-dump with OpenVDB.
#include "extract/extract.h"

#ifdef _WIN32
namespace kelp::dump {

constinit const Writer kVdbWriter{.needs = "OpenVDB"};
constinit const Writer kNanoVdbWriter{.needs = "OpenVDB and NanoVDB"};

}  // namespace kelp::dump
#else
#include <cerrno>
#include <filesystem>
#include <system_error>

#include <unistd.h>

#include "kelp/common/error.h"

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

// Replaces this process by kelp-dump-vdb with these arguments; standard input and output stay. ToolError:
// kUnsupported if the program is not installed, kRuntime if it cannot be run.
void becomeVdbProgram(std::vector<std::string> arguments) {
  std::vector<char*> argv{const_cast<char*>("kelp-dump")};
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const fs::path folder = ownFolder();
  for (const char* place : kPlaces) {
    ::execv((folder / place).c_str(), argv.data());  // comes back only if it fails
    if (errno == ENOENT) continue;
    throw ToolError(Exit::kRuntime, (folder / place).string() +
                                        ": cannot be run: " + std::generic_category().message(errno) +
                                        "; install kelp's programs again");
  }
  throw ToolError(Exit::kUnsupported,
                  "--vdb and --nvdb need the program kelp-dump-vdb, which is neither in " + folder.string() +
                      " nor in libexec/kelp beside it; install kelp's programs again, or build "
                      "them where OpenVDB is installed");
}

}  // namespace

constinit const Writer kVdbWriter{.handOver = becomeVdbProgram, .isThere = isThere};
constinit const Writer kNanoVdbWriter{.handOver = becomeVdbProgram, .isThere = isThere};

}  // namespace kelp::dump
#endif
