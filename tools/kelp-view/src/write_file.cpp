// SPDX-License-Identifier: MIT
#include "write_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

namespace kelp::view {
namespace {

bool writeAll(int file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(file, text.data(), text.size());
    if (written < 0 && errno != EINTR) return false;
    if (written > 0) text.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace

std::string writeFile(const std::string& path, std::string_view text) {
  std::error_code error;
  std::filesystem::path target = std::filesystem::is_symlink(path, error)
                                     ? std::filesystem::canonical(path, error)
                                     : std::filesystem::path(path);
  if (error) target = path;
  struct stat there {};
  const bool exists = ::stat(target.c_str(), &there) == 0;
  if (exists && !S_ISREG(there.st_mode)) return path + ": is not a file; choose another name";
  std::string temporary = target.string() + ".XXXXXX";
  const int file = ::mkostemp(temporary.data(), O_CLOEXEC);
  if (file < 0) return path + ": can not be written: " + std::strerror(errno) + "; choose another place";
  ::fchmod(file, exists ? there.st_mode & 07777 : 0644);
  const bool written = writeAll(file, text) && ::fsync(file) == 0;
  const int wrong = errno;
  const bool closed = ::close(file) == 0;
  if (written && closed && std::rename(temporary.c_str(), target.c_str()) == 0) return {};
  const int why = written && closed ? errno : wrong;
  ::unlink(temporary.c_str());
  return path + ": can not be written: " + std::strerror(why) + "; choose another place";
}

}  // namespace kelp::view
