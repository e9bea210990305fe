// SPDX-License-Identifier: MIT
#include "output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <bit>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "commands.h"

namespace kelp::dump {
namespace {

static_assert(std::endian::native == std::endian::little, "OutputFile::number writes numbers as they are in memory");

constexpr std::size_t kBuffer = std::size_t{1} << 18;

// The temporary file, for a signal: Ctrl-C leaves none behind. Empty if there is none.
char g_temporary[4096];

void removeAndExit(int signal) {
  if (g_temporary[0] != 0) ::unlink(g_temporary);
  ::_exit(128 + signal);
}

void guard(const std::string& path) {
  if (path.size() >= sizeof g_temporary) return;
  std::memcpy(g_temporary + 1, path.c_str() + 1, path.size());
  std::atomic_signal_fence(std::memory_order_seq_cst);
  g_temporary[0] = path[0];  // the name is there, whole
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    ::sigaction(signal, nullptr, &action);
    if (action.sa_handler != SIG_DFL) continue;  // nohup, and shells for jobs in the background, have them ignored
    action.sa_handler = &removeAndExit;
    ::sigaction(signal, &action, nullptr);
  }
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

// Through symbolic links, so that a link stays one.
std::string target(const std::string& path) {
  std::filesystem::path real = path;
  std::error_code error;
  for (int hops = 0; hops < 40 && std::filesystem::is_symlink(real, error); ++hops) real = real.parent_path() / std::filesystem::read_symlink(real, error);
  return real.string();
}

}  // namespace

void refuseToOverwrite(const std::string& output, const std::string& input) {
  if (output == "-" || input == "-") return;
  struct stat out {}, in {};
  if (::stat(output.c_str(), &out) != 0 || ::stat(input.c_str(), &in) != 0 || out.st_dev != in.st_dev || out.st_ino != in.st_ino) return;
  throw DumpError(kUsage, fmt::format("{}: would overwrite {}, which is read; name another file", output, input));
}

OutputFile::OutputFile(const std::string& path) : path_(path == "-" ? path : target(path)) {
  buffer_.reserve(kBuffer);
  if (path_ == "-") {
    file_ = STDOUT_FILENO;
    return;
  }
  struct stat status {};
  const bool replaces = ::stat(path_.c_str(), &status) == 0;
  if (replaces && !S_ISREG(status.st_mode)) throw DumpError(kIo, fmt::format("{}: is {}; name a file for the output", path_, S_ISDIR(status.st_mode) ? "a folder" : "no regular file"));
  temporary_ = fmt::format("{}.{}.tmp", path_, ::getpid());
  const SignalsWait wait;
  file_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file_ < 0) {
    const int reason = errno;
    temporary_.clear();  // another's
    errno = reason;
    fail("can not be written");
  }
  guard(temporary_);
  if (replaces) static_cast<void>(::fchmod(file_, status.st_mode & 0777));
}

OutputFile::~OutputFile() {
  if (temporary_.empty()) return;
  if (file_ >= 0) ::close(file_);
  ::unlink(temporary_.c_str());
  unguard();
}

void OutputFile::fail(const char* what) const {
  throw DumpError(kIo, fmt::format("{}: {}: {}; check that the folder exists, is writable and has room", path_ == "-" ? "standard output" : path_, what, std::strerror(errno)));
}

void OutputFile::write(std::span<const std::byte> bytes) {
  if (buffer_.size() + bytes.size() > kBuffer) flush();
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
}

void OutputFile::flush() {
  std::span<const std::byte> left(buffer_);
  while (!left.empty()) {
    const ssize_t count = ::write(file_, left.data(), left.size());
    if (count < 0 && errno == EINTR) continue;
    if (count == 0) errno = ENOSPC;
    if (count <= 0) fail("can not be written");
    left = left.subspan(static_cast<std::size_t>(count));
  }
  buffer_.clear();
}

void OutputFile::commit() {
  flush();
  if (path_ == "-") return;
  if (::fsync(file_) != 0) fail("can not be flushed to disk");
  if (::close(std::exchange(file_, -1)) != 0) fail("can not be written");
  if (::rename(temporary_.c_str(), path_.c_str()) != 0) fail("can not be replaced");
  temporary_.clear();
  unguard();
}

}  // namespace kelp::dump
