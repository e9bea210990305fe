// SPDX-License-Identifier: MIT
// Where the bytes of a pack come from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "kelp/formats/error.h"

namespace kelp {

// The host's reader: a file, memory, an entry of an archive, HTTP ranges. `read` fills all of `bytes` from `offset` and answers whether it
// could; it is called from every thread that calls Pack or Asset functions, at the same time. kelp never reads past `size`, trusts neither
// size nor bytes, and does not own `user`, which must outlive every object opened from the source.
struct Source {
  bool (*read)(void* user, std::uint64_t offset, std::span<std::byte> bytes) = nullptr;
  void* user = nullptr;
  std::uint64_t size = 0;
};

// A pack in memory, which must outlive the objects opened from it (and the span object itself need not).
class MemorySource {
 public:
  explicit MemorySource(std::span<const std::byte> bytes) : bytes_(bytes) {}
  Source source() & { return {&MemorySource::read, this, bytes_.size()}; }  // not on a temporary: the Source points to this object

 private:
  static bool read(void* user, std::uint64_t offset, std::span<std::byte> bytes);
  std::span<const std::byte> bytes_;
};

// A file, read at places (pread, on Windows ReadFile): any number of threads. Movable; must stay where it is while a Source of it is in use.
class FileSource {
 public:
  FileSource() = default;
  FileSource(FileSource&& other) noexcept;
  FileSource& operator=(FileSource&& other) noexcept;
  ~FileSource();

  // The path is as the system has it, on Windows UTF-8. kIo if the file can not be opened or is not a regular file (errno says why).
  static Result<FileSource> open(const char* path);
  Source source() { return {&FileSource::read, this, size_}; }

 private:
  static bool read(void* user, std::uint64_t offset, std::span<std::byte> bytes);
  std::intptr_t file_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace kelp
