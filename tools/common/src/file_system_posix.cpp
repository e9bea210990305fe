// SPDX-License-Identifier: MIT
#include "file_system.h"

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "kelp/common/error.h"
#include "kelp/common/output_file.h"

namespace kelp {
namespace {

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};

// For the signal handler, which may use no more than plain memory. g_guarded: the file to remove; empty:
// none.
char g_guarded[4096];
char g_message[64];  // empty: nothing is to be guarded

// The signals as they were before they had to wait. Of each thread, as the mask is.
thread_local sigset_t t_before;

std::error_code lastError() { return {errno, std::generic_category()}; }

}  // namespace

void guardOutput(const std::string& message) {
  std::snprintf(g_message, sizeof g_message, "%s\n", message.c_str());
}

void endInterrupted() {
  if (g_guarded[0] != 0) ::unlink(g_guarded);
  static_cast<void>(!::write(STDERR_FILENO, g_message, std::strlen(g_message)));
  ::_exit(static_cast<int>(Exit::kInterrupted));
}

void endOnInterrupt(const char* program) {
  guardOutput(program + std::string(": interrupted"));
  for (const int signal : kSignals) {
    struct sigaction action {};
    ::sigaction(signal, nullptr, &action);
    // nohup, and shells for jobs in the background, have them ignored.
    if (action.sa_handler == SIG_IGN) continue;
    action = {};
    action.sa_handler = [](int) { endInterrupted(); };
    ::sigaction(signal, &action, nullptr);
  }
  // At a limit on the size of files, write() fails and the output is removed. The signal would end the
  // program with half a file left behind.
  std::signal(SIGXFSZ, SIG_IGN);
}

void guardFile(const std::filesystem::path& path, int) {
  const std::string& name = path.native();
  if (g_message[0] == 0 || g_guarded[0] != 0 || name.size() >= sizeof g_guarded) return;
  std::memcpy(g_guarded + 1, name.c_str() + 1, name.size());
  std::atomic_signal_fence(std::memory_order_seq_cst);
  g_guarded[0] = name[0];  // last: the handler sees the whole name or none
}

void unguardFile(const std::filesystem::path& path) {
  if (path.native() == g_guarded) g_guarded[0] = 0;
}

InterruptsWait::InterruptsWait() {
  sigset_t waiting;
  ::sigemptyset(&waiting);
  for (const int signal : kSignals) ::sigaddset(&waiting, signal);
  ::pthread_sigmask(SIG_BLOCK, &waiting, &t_before);
}

InterruptsWait::~InterruptsWait() { ::pthread_sigmask(SIG_SETMASK, &t_before, nullptr); }

long processId() { return ::getpid(); }

std::error_code createFile(const std::filesystem::path& path, int& file) {
  file = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  return file < 0 ? lastError() : std::error_code();
}

void keepPermissions(const std::filesystem::path& from, int file) {
  struct stat status {};
  // Some file systems have no permissions: a failure means nothing.
  if (::stat(from.c_str(), &status) == 0) static_cast<void>(::fchmod(file, status.st_mode & 0777));
}

std::error_code writeAll(int file, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t some = ::write(file, bytes.data(), bytes.size());
    if (some < 0 && errno == EINTR) continue;
    if (some == 0) return std::make_error_code(std::errc::no_space_on_device);
    if (some < 0) return lastError();
    bytes = bytes.subspan(static_cast<std::size_t>(some));
  }
  return {};
}

std::error_code flushToDisk(int file) { return ::fsync(file) != 0 ? lastError() : std::error_code(); }

std::error_code closeFile(int file) { return ::close(file) != 0 ? lastError() : std::error_code(); }

std::error_code replaceFile(const std::filesystem::path& from, const std::filesystem::path& to) {
  return std::rename(from.c_str(), to.c_str()) != 0 ? lastError() : std::error_code();
}

void flushFolder(const std::filesystem::path& folder) {
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return;
  ::fsync(file);  // Some file systems cannot do this for folders. The file itself is safe.
  ::close(file);
}

}  // namespace kelp
