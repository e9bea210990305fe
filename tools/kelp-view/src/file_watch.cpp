// SPDX-License-Identifier: MIT
#include "file_watch.h"

#include <sys/stat.h>

#include <ctime>

namespace kelp::view {
namespace {

std::int64_t nanoseconds(const timespec& time) {
  return std::int64_t{time.tv_sec} * 1000000000 + time.tv_nsec;
}

}  // namespace

std::int64_t FileWatch::clock() {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return nanoseconds(now);
}

FileWatch::Stamp FileWatch::look(const std::string& path) {
  struct stat found {};
  if (::stat(path.c_str(), &found) != 0) return {};
  return {true, found.st_dev, found.st_ino, found.st_size, nanoseconds(found.st_mtim)};
}

void FileWatch::watch(const std::vector<std::string>& paths, std::int64_t since) {
  std::map<std::string, File> files;
  for (const std::string& path : paths) {
    if (const auto known = files_.find(path); known != files_.end()) {
      files[path] = known->second;
      continue;
    }
    const Stamp now = look(path);
    files[path] = {now.there && now.time > since ? Stamp{} : now, now};
  }
  files_ = std::move(files);
}

bool FileWatch::changed(double now) {
  if (now < next_look_) return false;
  next_look_ = now + kInterval;
  bool other = false, still = true;
  for (auto& [path, file] : files_) {
    const Stamp stamp = look(path);
    other = other || stamp != file.known;
    still = still && stamp == file.seen;
    file.seen = stamp;
  }
  if (!other || !still) return false;
  for (auto& [path, file] : files_) file.known = file.seen;
  return true;
}

void FileWatch::accept() {
  for (auto& [path, file] : files_) file.known = file.seen = look(path);
}

}  // namespace kelp::view
