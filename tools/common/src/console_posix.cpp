// SPDX-License-Identifier: MIT
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include "file_system.h"
#include "kelp/common/console.h"

namespace kelp::console {
namespace {

constexpr int kMostWaitForWriter = 2000;  // milliseconds

}  // namespace

void prepareStreams() {
  // open() returns the lowest free number. Standard input is opened for writing and standard output for
  // reading, so that using them still fails.
  for (const int number : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(number, F_GETFD) < 0)
      static_cast<void>(::open("/dev/null", number == STDOUT_FILENO ? O_RDONLY : O_WRONLY));
}

std::vector<std::string> arguments(int argc, char** argv) { return {argv, argv + argc}; }

bool isTerminal(Stream stream) {
  return ::isatty(stream == Stream::kIn    ? STDIN_FILENO
                  : stream == Stream::kOut ? STDOUT_FILENO
                                           : STDERR_FILENO) == 1;
}

std::string writeOut(std::string_view text) {
  const std::error_code problem = writeAll(STDOUT_FILENO, std::as_bytes(std::span(text.data(), text.size())));
  return problem ? problem.message() : "";
}

Reading::Reading(const std::string& path) {
  if (path == "-") {
    file_ = STDIN_FILENO;
    return;
  }
  // Without O_NONBLOCK, opening a named pipe that nobody writes to would wait forever.
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
      // Either the pipe has ended, or nobody has opened it for writing yet. poll() tells which.
      const int events = ::poll(&wanted, 1, waited ? 0 : kMostWaitForWriter);
      if (events > 0 && !(wanted.revents & POLLIN)) return 0;
      if (events == 0 && waited) problem_ = "nobody writes to this pipe";
      waited = true;
    } else if (errno == EAGAIN) {  // somebody writes, but nothing has come yet
      ::poll(&wanted, 1, -1);
    } else if (errno != EINTR) {
      problem_ = std::strerror(errno);
    }
  }
  return 0;
}

bool isPipe(const std::string& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 && S_ISFIFO(status.st_mode);
}

}  // namespace kelp::console
