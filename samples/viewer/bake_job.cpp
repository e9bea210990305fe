// SPDX-License-Identifier: MIT
#include "bake_job.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

extern char** environ;

namespace viewer {
namespace {

constexpr std::size_t kMostText = 64 << 10;  // bytes that are kept of what it says

bool isProgram(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error) && ::access(path.c_str(), X_OK) == 0;
}

}  // namespace

std::string BakeJob::findProgram() {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  if (!error && isProgram(self.parent_path() / "kelp-bake")) return self.parent_path() / "kelp-bake";
  const char* const path = std::getenv("PATH");
  std::string folders = path ? path : "";
  for (std::size_t at = 0; at < folders.size();) {
    const std::size_t end = std::min(folders.find(':', at), folders.size());
    const std::filesystem::path program = std::filesystem::path(folders.substr(at, end - at)) / "kelp-bake";
    if (isProgram(program)) return program;
    at = end + 1;
  }
  return {};
}

BakeJob::~BakeJob() {
  interrupt();
  while (running() && !poll()) ::usleep(2000);
}

std::string BakeJob::start(const std::vector<std::string>& words) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return std::string("kelp-bake: can not be started: ") + std::strerror(errno);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
  std::vector<std::string> copies = words;
  std::vector<char*> arguments;
  for (std::string& word : copies) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const int wrong = posix_spawn(&process_, copies[0].c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  if (wrong != 0) {
    ::close(ends[0]);
    process_ = 0;
    return words[0] + ": can not be started: " + std::strerror(wrong);
  }
  pipe_ = ends[0];
  ::fcntl(pipe_, F_SETFL, O_NONBLOCK);
  pending_.clear();
  text_.clear();
  last_line_.clear();
  stage_ = "starting";
  done_ = 0;
  return {};
}

bool BakeJob::poll() {
  if (!running()) return false;
  char bytes[4096];
  ssize_t count = 0;
  while ((count = ::read(pipe_, bytes, sizeof bytes)) > 0) {
    pending_.append(bytes, static_cast<std::size_t>(count));
    for (std::size_t end; (end = pending_.find('\n')) != std::string::npos; pending_.erase(0, end + 1)) take(pending_.substr(0, end));
    if (pending_.size() > kMostText) pending_.clear();
  }
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return false;
  if (!pending_.empty()) take(pending_);
  ::close(pipe_);
  pipe_ = -1;
  int status = 0;
  while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = 0;
  exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return true;
}

// {"stage":"voxelize","done":0.25}, or a line for people.
void BakeJob::take(const std::string& line) {
  char stage[64];
  float done = 0;
  if (std::sscanf(line.c_str(), "{\"stage\":\"%63[^\"]\",\"done\":%f}", stage, &done) == 2) {
    stage_ = stage;
    done_ = done;
    return;
  }
  if (line.empty()) return;
  if (text_.size() + line.size() < kMostText) text_ += line + "\n";
  last_line_ = line;
}

void BakeJob::interrupt() {
  if (running()) ::kill(process_, SIGTERM);
}

}  // namespace viewer
