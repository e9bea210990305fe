// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "kelp/console/console.h"

namespace kelp::console {
namespace {

constexpr int kMostWaitForWriter = 2000;  // milliseconds

}  // namespace

void prepareStreams() {
  // open() gives the lowest number that is free. The streams of data are open the wrong way round, so that their use still fails.
  for (const int number : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(number, F_GETFD) < 0) static_cast<void>(::open("/dev/null", number == STDOUT_FILENO ? O_RDONLY : O_WRONLY));
}

std::vector<std::string> arguments(int argc, char** argv) { return {argv, argv + argc}; }

bool isTerminal(Stream stream) { return ::isatty(stream == Stream::kIn ? STDIN_FILENO : stream == Stream::kOut ? STDOUT_FILENO : STDERR_FILENO) == 1; }

std::string writeOut(std::string_view text) {
  while (!text.empty()) {
    const ssize_t some = ::write(STDOUT_FILENO, text.data(), text.size());
    if (some < 0 && errno == EINTR) continue;
    if (some <= 0) return std::strerror(some < 0 ? errno : ENOSPC);
    text.remove_prefix(static_cast<std::size_t>(some));
  }
  return {};
}

Reading::Reading(const std::string& path) {
  if (path == "-") {
    file_ = STDIN_FILENO;
    return;
  }
  // O_NONBLOCK: opening a named pipe that nobody writes to would wait for ever.
  file_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file_ < 0) problem_ = std::strerror(errno);
  own_ = file_ >= 0;
}

Reading::~Reading() {
  if (own_) ::close(static_cast<int>(file_));
}

std::size_t Reading::read(std::span<std::byte> bytes) {
  const int file = static_cast<int>(file_);
  pollfd wanted{file, POLLIN, 0};
  bool waited = false;
  while (problem_.empty()) {
    const ssize_t got = ::read(file, bytes.data(), bytes.size());
    if (got > 0) {
      begun_ = true;
      return static_cast<std::size_t>(got);
    }
    if (got == 0) {
      struct stat status {};
      if (begun_ || !own_ || ::fstat(file, &status) != 0 || !S_ISFIFO(status.st_mode)) return 0;
      // The end of a pipe; or nobody has opened it for writing yet, which reads alike, but to poll() is not the end.
      const int events = ::poll(&wanted, 1, waited ? 0 : kMostWaitForWriter);
      if (events > 0 && !(wanted.revents & POLLIN)) return 0;
      if (events == 0 && waited) problem_ = "nobody writes to this pipe";
      waited = true;
    } else if (errno == EAGAIN) {  // somebody does, but nothing yet
      ::poll(&wanted, 1, -1);
    } else if (errno != EINTR) {
      problem_ = std::strerror(errno);
    }
  }
  return 0;
}

std::uint64_t physicalMemory() {
  const long pages = ::sysconf(_SC_PHYS_PAGES), bytes = ::sysconf(_SC_PAGE_SIZE);
  return pages > 0 && bytes > 0 ? static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(bytes) : ~std::uint64_t{0};
}

bool isPipe(const std::string& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 && S_ISFIFO(status.st_mode);
}

}  // namespace kelp::console
