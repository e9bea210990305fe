// SPDX-License-Identifier: MIT
// Where the bytes of a pack come from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "kelp/formats/error.h"

namespace kelp {

// The host's reader: a file, memory, an entry of an archive, HTTP ranges. `read` fills all of `bytes` from
// `offset` and returns whether it succeeded. Every thread that calls functions of Pack or Asset calls it,
// several at the same time. kelp never reads past `size` and trusts neither the size nor the bytes. kelp does
// not own `user`, which must outlive every object opened from the source.
struct Source {
  bool (*read)(void* user, std::uint64_t offset, std::span<std::byte> bytes) = nullptr;
  void* user = nullptr;
  std::uint64_t size = 0;
};

// A pack in memory. The bytes and this object must outlive every object opened from the source; the span
// itself is copied.
class MemorySource {
 public:
  explicit MemorySource(std::span<const std::byte> bytes) : bytes_(bytes) {}
  // The Source points to this object, so this cannot be called on a temporary.
  Source source() & { return {&MemorySource::read, this, bytes_.size()}; }

 private:
  static bool read(void* user, std::uint64_t offset, std::span<std::byte> bytes);
  std::span<const std::byte> bytes_;
};

// A file. Any number of threads may read at the same time (pread; ReadFile on Windows). Movable, but it must
// stay in place while one of its Sources is in use.
class FileSource {
 public:
  FileSource() = default;
  FileSource(FileSource&& other) noexcept;
  FileSource& operator=(FileSource&& other) noexcept;
  ~FileSource();

  // path: in the system's encoding; UTF-8 on Windows. kIo if the file cannot be opened or is not a regular
  // file; errno says why. kMisuse if `path` is null.
  static Result<FileSource> open(const char* path);
  Source source() { return {&FileSource::read, this, size_}; }

 private:
  static bool read(void* user, std::uint64_t offset, std::span<std::byte> bytes);
  std::intptr_t file_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace kelp
