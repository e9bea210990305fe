// SPDX-License-Identifier: MIT
#include "bake_job.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include <nlohmann/json.hpp>

extern char** environ;

namespace kelp::view {
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
  if (!running()) return;
  interrupt();
  char bytes[4096];  // of no interest any more
  for (ssize_t count = 0; (count = ::read(pipe_, bytes, sizeof bytes)) > 0 ||
                          (count < 0 && (errno == EAGAIN || errno == EINTR));) {
    if (count < 0) ::usleep(2000);
  }
  reap();
}

std::string BakeJob::start(const std::vector<std::string>& words) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0)
    return std::string("kelp-bake: cannot be started: ") + std::strerror(errno);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
  std::vector<std::string> copies = words;
  std::vector<char*> arguments;
  arguments.reserve(copies.size() + 1);
  for (std::string& word : copies) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const int wrong = posix_spawn(&process_, copies[0].c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  if (wrong != 0) {
    ::close(ends[0]);
    process_ = 0;
    return words[0] + ": cannot be started: " + std::strerror(wrong);
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
    for (std::size_t end; (end = pending_.find('\n')) != std::string::npos; pending_.erase(0, end + 1))
      take(pending_.substr(0, end));
    if (pending_.size() > kMostText) pending_.clear();
  }
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return false;
  if (!pending_.empty()) take(pending_);
  reap();
  return true;
}

void BakeJob::reap() {
  ::close(pipe_);
  pipe_ = -1;
  int status = 0;
  while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = 0;
  exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

// Lines are JSON (kelp-bake-progress.schema.json): {"kind": "progress", "stage": "voxelize", "done": 0.25,
// ...}, or with a text for people.
void BakeJob::take(const std::string& line) {
  if (line.empty()) return;
  const nlohmann::json json = nlohmann::json::parse(line, nullptr, false);
  const auto text = [&](const char* member) {
    return json.is_object() && json.contains(member) && json[member].is_string()
               ? json[member].get<std::string>()
               : std::string();
  };
  const std::string kind = text("kind");
  if (kind == "progress") {
    stage_ = text("stage");
    done_ = json.contains("done") && json["done"].is_number() ? json["done"].get<float>() : 0;
    return;
  }
  last_line_ = kind.empty() ? line
                            : (kind == "detail"    ? "  "
                               : kind == "warning" ? "kelp-bake: warning: "
                                                   : "kelp-bake: ") +
                                  text("text");
  if (text_.size() + last_line_.size() < kMostText) text_ += last_line_ + "\n";
}

void BakeJob::interrupt() {
  if (running()) ::kill(process_, SIGTERM);
}

}  // namespace kelp::view
