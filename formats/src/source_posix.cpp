// SPDX-License-Identifier: MIT
// FileSource for POSIX.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "kelp/formats/source.h"

namespace kelp {

FileSource::~FileSource() {
  if (file_ >= 0) ::close(static_cast<int>(file_));
}

Result<FileSource> FileSource::open(const char* path) {
  if (!path) return Error{ErrorCode::kMisuse, "the path is null"};
  // O_NONBLOCK: opening a named pipe must not block for ever. It is refused below.
  const int file = ::open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) return Error{ErrorCode::kIo, "the file cannot be opened"};
  FileSource source;
  source.file_ = file;
  struct stat status {};
  if (::fstat(file, &status) != 0) return Error{ErrorCode::kIo, "the file's size cannot be read"};
  if (!S_ISREG(status.st_mode)) {
    errno = S_ISDIR(status.st_mode) ? EISDIR : EINVAL;
    return Error{ErrorCode::kIo, "not a regular file"};
  }
  source.size_ = static_cast<std::uint64_t>(status.st_size);
  return Result<FileSource>(std::move(source));
}

bool FileSource::read(void* user, std::uint64_t offset, std::span<std::byte> bytes) {
  const FileSource& self = *static_cast<const FileSource*>(user);
  if (offset > self.size_ || bytes.size() > self.size_ - offset) return false;
  while (!bytes.empty()) {
    const ssize_t got =
        ::pread(static_cast<int>(self.file_), bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;  // an error, or the file became shorter
    bytes = bytes.subspan(static_cast<std::size_t>(got));
    offset += static_cast<std::uint64_t>(got);
  }
  return true;
}

}  // namespace kelp
