// SPDX-License-Identifier: MIT
// Where the bytes of a pack come from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "kelp/formats/error.h"

namespace kelp {

enum class Read : std::uint8_t {
  kDone,  // all of the bytes are there
  // Some bytes have not arrived: a network, a slow archive, another thread. The source notes the request,
  // fetches the bytes, and keeps them until they are read. The caller asks again later.
  kNotYet,
  kFailed,  // these bytes cannot be had
};

// The host's reader: a file, memory, an entry of an archive, HTTP ranges. `read` fills all of `bytes` from
// `offset`; unless it returns kDone, their content does not matter. It may block; or, where nothing may
// block, it returns kNotYet. Every thread that calls functions of Pack or Asset calls it, several at the same
// time. kelp never reads past `size` and trusts neither the size nor the bytes.
//
// Lifetime: a Pack or Asset that is opened from the source calls `acquire` once, and `release` when it is
// destroyed; `user` must live from the one to the other. Null: the host keeps `user` alive for as long.
struct Source {
  Read (*read)(void* user, std::uint64_t offset, std::span<std::byte> bytes) = nullptr;
  void* user = nullptr;
  std::uint64_t size = 0;
  void (*acquire)(void* user) = nullptr;
  void (*release)(void* user) = nullptr;
};

// A pack in memory. The bytes must outlive every object opened from the source; this object need not.
class MemorySource {
 public:
  explicit MemorySource(std::span<const std::byte> bytes) : bytes_(bytes) {}
  Source source() const {
    return {&MemorySource::read, const_cast<std::byte*>(bytes_.data()), bytes_.size(), nullptr, nullptr};
  }

 private:
  static Read read(void* user, std::uint64_t offset, std::span<std::byte> bytes);
  std::span<const std::byte> bytes_;
};

// A file. Any number of threads may read at the same time (pread; ReadFile on Windows). Movable. The file
// stays open until this object and every object opened from its sources are destroyed.
class FileSource {
 public:
  FileSource() = default;
  FileSource(FileSource&& other) noexcept : file_(std::exchange(other.file_, nullptr)) {}
  FileSource& operator=(FileSource&& other) noexcept;
  ~FileSource();

  // path: in the system's encoding; UTF-8 on Windows. kIo if the file cannot be opened or is not a regular
  // file; the text names it, has the system's reason, and is valid until the thread's next such error or its
  // end; errno is set. kMisuse if `path` is null. kOutOfMemory.
  static Result<FileSource> open(const char* path);
  Source source() const;

 private:
  struct File;  // counts what uses it
  File* file_ = nullptr;
};

}  // namespace kelp
