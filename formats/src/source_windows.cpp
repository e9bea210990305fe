// SPDX-License-Identifier: MIT
// Files of Windows.
#define WIN32_LEAN_AND_MEAN
#ifndef NOMINMAX  // libstdc++ defines it, too
#define NOMINMAX
#endif
#include <windows.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "file_source.h"
#include "kelp/formats/buffer.h"

namespace kelp {
namespace {

HANDLE handleOf(std::intptr_t file) { return reinterpret_cast<HANDLE>(file); }

// Sets errno as the C library would.
void setErrno(DWORD error) {
  switch (error) {
    case ERROR_FILE_NOT_FOUND:
    case ERROR_PATH_NOT_FOUND:
    case ERROR_INVALID_DRIVE:
    case ERROR_BAD_NETPATH:
      errno = ENOENT;
      break;
    case ERROR_ACCESS_DENIED:
    case ERROR_SHARING_VIOLATION:
    case ERROR_LOCK_VIOLATION:
      errno = EACCES;
      break;
    case ERROR_TOO_MANY_OPEN_FILES:
      errno = EMFILE;
      break;
    case ERROR_NOT_ENOUGH_MEMORY:
    case ERROR_OUTOFMEMORY:
      errno = ENOMEM;
      break;
    case ERROR_FILENAME_EXCED_RANGE:
      errno = ENAMETOOLONG;
      break;
    default:
      errno = EINVAL;
      break;
  }
}

}  // namespace

void closeFile(const OpenFile& file) { ::CloseHandle(handleOf(file.handle)); }

Result<OpenFile> openFile(const char* path) {
  // UTF-8 has at least as many bytes as UTF-16 has units.
  const std::size_t length = std::strlen(path) + 1;
  constexpr std::size_t kLongest = 1 << 15;  // the longest path that the system accepts
  if (length > 3 * kLongest) {
    errno = ENAMETOOLONG;
    return Error{ErrorCode::kIo, "the path is too long"};
  }
  Buffer<wchar_t> wide;
  if (!wide.reset(length)) return Error{ErrorCode::kOutOfMemory, "no memory for the path"};
  if (::MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, path, static_cast<int>(length), wide.data(),
                            static_cast<int>(length)) == 0) {
    errno = EILSEQ;
    return Error{ErrorCode::kIo, "the path is not UTF-8"};
  }
  const DWORD attributes = ::GetFileAttributesW(wide.data());
  if (attributes != INVALID_FILE_ATTRIBUTES && (attributes & FILE_ATTRIBUTE_DIRECTORY)) {
    errno = EISDIR;
    return Error{ErrorCode::kIo, "not a regular file"};
  }
  // Other processes may replace, rename and remove the file meanwhile, as on POSIX.
  const HANDLE file =
      ::CreateFileW(wide.data(), GENERIC_READ, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE,
                    nullptr, OPEN_EXISTING, FILE_ATTRIBUTE_NORMAL | FILE_FLAG_RANDOM_ACCESS, nullptr);
  if (file == INVALID_HANDLE_VALUE) {
    setErrno(::GetLastError());
    return Error{ErrorCode::kIo, "the file cannot be opened"};
  }
  const auto refuse = [file](const char* detail) {
    ::CloseHandle(file);
    return Error{ErrorCode::kIo, detail};
  };
  if (::GetFileType(file) != FILE_TYPE_DISK) {
    errno = EINVAL;
    return refuse("not a regular file");
  }
  LARGE_INTEGER size{};
  if (!::GetFileSizeEx(file, &size)) {
    setErrno(::GetLastError());
    return refuse("the file's size cannot be read");
  }
  return OpenFile{reinterpret_cast<std::intptr_t>(file), static_cast<std::uint64_t>(size.QuadPart)};
}

bool readFile(const OpenFile& file, std::uint64_t offset, std::span<std::byte> bytes) {
  while (!bytes.empty()) {
    OVERLAPPED place{};  // reads at an offset, so threads share no file position
    place.Offset = static_cast<DWORD>(offset);
    place.OffsetHigh = static_cast<DWORD>(offset >> 32);
    const DWORD most = static_cast<DWORD>(std::min<std::size_t>(bytes.size(), std::size_t{1} << 30));
    DWORD got = 0;
    // 0 bytes: the file became shorter
    if (!::ReadFile(handleOf(file.handle), bytes.data(), most, &got, &place) || got == 0) return false;
    bytes = bytes.subspan(got);
    offset += got;
  }
  return true;
}

}  // namespace kelp
