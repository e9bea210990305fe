// SPDX-License-Identifier: MIT
// Files of POSIX.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <limits>

#include "file_source.h"

namespace kelp {

void closeFile(const OpenFile& file) { ::close(static_cast<int>(file.handle)); }

Result<OpenFile> openFile(const char* path) {
  // O_NONBLOCK: opening a named pipe must not block for ever. It is refused below.
  const int file = ::open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) return Error{ErrorCode::kIo, "the file cannot be opened"};
  const auto refuse = [file](int reason, const char* detail) {
    ::close(file);
    errno = reason;
    return Error{ErrorCode::kIo, detail};
  };
  struct stat status {};
  if (::fstat(file, &status) != 0) return refuse(errno, "the file's size cannot be read");
  if (!S_ISREG(status.st_mode))
    return refuse(S_ISDIR(status.st_mode) ? EISDIR : EINVAL, "not a regular file");
  return OpenFile{file, static_cast<std::uint64_t>(status.st_size)};
}

bool readFile(const OpenFile& file, std::uint64_t offset, std::span<std::byte> bytes) {
  // Not every system refuses an offset that is negative as off_t: node reads from where it is.
  if (offset > std::uint64_t{std::numeric_limits<off_t>::max()}) return bytes.empty();
  while (!bytes.empty()) {
    const ssize_t got =
        ::pread(static_cast<int>(file.handle), bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(got));
    offset += static_cast<std::uint64_t>(got);
  }
  return true;
}

}  // namespace kelp
