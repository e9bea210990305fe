// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <string_view>
#include <utility>

#include "system.h"

namespace kelp::dump {
namespace {

constexpr int kInterrupted = 130;
constexpr std::size_t kMostOfName = 200;  // of the 255 bytes that a name may have
constexpr int kMostOthers = 100;

// The name of the NewFile that there is, for a signal. Empty if there is none.
char g_temporary[4096];

void removeAndExit(int) {
  if (g_temporary[0] != 0) ::unlink(g_temporary);
  constexpr std::string_view kMessage = "kelp-dump: interrupted\n";
  static_cast<void>(!::write(STDERR_FILENO, kMessage.data(), kMessage.size()));
  ::_exit(kInterrupted);
}

void guard(const std::string& name) {
  if (name.size() >= sizeof g_temporary) return;
  std::memcpy(g_temporary + 1, name.c_str() + 1, name.size());
  std::atomic_signal_fence(std::memory_order_seq_cst);
  g_temporary[0] = name[0];  // the name is there, whole
}

void unguard() { g_temporary[0] = 0; }

// Signals wait until the file that is being made is guarded.
class SignalsWait {
 public:
  SignalsWait() {
    sigset_t waiting;
    ::sigemptyset(&waiting);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) ::sigaddset(&waiting, signal);
    ::pthread_sigmask(SIG_BLOCK, &waiting, &before_);
  }
  SignalsWait(const SignalsWait&) = delete;
  SignalsWait& operator=(const SignalsWait&) = delete;
  ~SignalsWait() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

 private:
  sigset_t before_;
};

}  // namespace

void catchInterrupts() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    ::sigaction(signal, nullptr, &action);
    if (action.sa_handler == SIG_IGN) continue;  // nohup, and shells for jobs in the background, have them ignored
    action = {};
    action.sa_handler = &removeAndExit;
    ::sigaction(signal, &action, nullptr);
  }
  std::signal(SIGXFSZ, SIG_IGN);  // a limit on the size of files is an error of writing, not the end with half a file left behind
}

NewFile::~NewFile() {
  if (name_.empty()) return;
  if (file_ >= 0) ::close(file_);
  ::unlink(name_.c_str());
  unguard();
}

std::string NewFile::create(const std::string& path) {
  struct stat status {};
  const bool replaces = ::stat(path.c_str(), &status) == 0;
  if (!replaces && errno == ENAMETOOLONG) return std::strerror(errno);  // the file beside it has a shorter one
  const std::size_t name_at = path.rfind('/') + 1;
  const std::string stem = path.substr(0, name_at) + "." + path.substr(name_at, kMostOfName) + "." + std::to_string(::getpid());
  std::string name = stem + ".tmp";
  const SignalsWait wait;
  // A killed program of this number, as in every container, may have left its own.
  for (int others = 0; (file_ = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666)) < 0 && errno == EEXIST && others < kMostOthers;)
    name = stem + "-" + std::to_string(++others) + ".tmp";
  if (file_ < 0) return std::strerror(errno);
  path_ = path;
  name_ = name;
  guard(name_);
  if (replaces) static_cast<void>(::fchmod(file_, status.st_mode & 0777));
  return {};
}

std::string NewFile::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t some = ::write(file_, bytes.data(), bytes.size());
    if (some < 0 && errno == EINTR) continue;
    if (some <= 0) return std::strerror(some < 0 ? errno : ENOSPC);
    bytes = bytes.subspan(static_cast<std::size_t>(some));
  }
  return {};
}

std::string NewFile::commit() {
  if (::fsync(file_) != 0 || ::close(std::exchange(file_, -1)) != 0 || std::rename(name_.c_str(), path_.c_str()) != 0) return std::strerror(errno);
  name_.clear();
  unguard();
  return {};
}

}  // namespace kelp::dump
