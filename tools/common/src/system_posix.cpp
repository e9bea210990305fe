// SPDX-License-Identifier: MIT
// The calls of the operating system behind console.h and memory.h.
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "file_system.h"
#include "kelp/common/console.h"
#include "kelp/common/memory.h"

namespace kelp::console {

void prepareStreams() {
  // open() returns the lowest free number. Standard input is opened for writing and standard output for
  // reading, so that using them still fails.
  for (const int number : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(number, F_GETFD) < 0)
      static_cast<void>(::open("/dev/null", number == STDOUT_FILENO ? O_RDONLY : O_WRONLY));
}

std::vector<std::string> arguments(int argc, char** argv) { return {argv, argv + argc}; }

bool printsToTerminal() { return ::isatty(STDOUT_FILENO) == 1; }

std::string writeOut(std::string_view text) {
  const std::error_code problem = writeAll(STDOUT_FILENO, std::as_bytes(std::span(text.data(), text.size())));
  return problem ? problem.message() : "";
}

bool isPipe(const std::string& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 && S_ISFIFO(status.st_mode);
}

}  // namespace kelp::console

namespace kelp {

std::uint64_t physicalMemory() {
  const long pages = ::sysconf(_SC_PHYS_PAGES), bytes = ::sysconf(_SC_PAGE_SIZE);
  return pages > 0 && bytes > 0 ? static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(bytes)
                                : ~std::uint64_t{0};
}

std::uint64_t peakMemory() {
  rusage usage{};
  // Linux counts KiB
  return ::getrusage(RUSAGE_SELF, &usage) == 0 ? static_cast<std::uint64_t>(usage.ru_maxrss) * 1024 : 0;
}

void returnFreedMemory() {
#ifdef __GLIBC__
  ::malloc_trim(0);
#endif
}

}  // namespace kelp
