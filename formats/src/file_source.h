// SPDX-License-Identifier: MIT
// The open file behind a FileSource. Each system has its own openFile, readFile and closeFile.
#pragma once

#include <atomic>

#include "kelp/formats/source.h"

namespace kelp {

// The system's handle of an open file, and its size.
struct OpenFile {
  std::intptr_t handle = -1;
  std::uint64_t size = 0;
};

struct FileSource::File {
  OpenFile open;
  std::atomic<std::uint32_t> uses{1};
};

// Errors as FileSource::open.
Result<OpenFile> openFile(const char* path);
// Reads all of `bytes`, or returns false: an error, or the file became shorter.
bool readFile(const OpenFile& file, std::uint64_t offset, std::span<std::byte> bytes);
void closeFile(const OpenFile& file);

}  // namespace kelp
