// SPDX-License-Identifier: MIT
#include "kelp/formats/source.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <new>
#include <utility>

#include "file_source.h"

namespace kelp {
namespace {

// "PATH: DETAIL: the system's reason". The thread's own text, because nobody else would keep it; errno stays.
Error nameFile(const char* path, const Error& error) {
  constexpr std::size_t kMostBytes = 512, kMostOfPath = 384;
  static thread_local char text[kMostBytes];
  const int reason = errno;
  // Of a long path the end says more.
  const std::size_t length = std::strlen(path);
  std::size_t cut = length > kMostOfPath ? length - kMostOfPath : 0;
  while ((static_cast<unsigned char>(path[cut]) & 0xC0) == 0x80) ++cut;  // not amid a character
  std::snprintf(text, sizeof text, "%s%s: %s: %s", cut > 0 ? "..." : "", path + cut, error.detail,
                std::strerror(reason));
  errno = reason;
  return {error.code, text};
}

}  // namespace

// Whoever calls it stays within the source's size.
Read MemorySource::read(void* user, std::uint64_t offset, std::span<std::byte> bytes) {
  if (!bytes.empty()) std::memcpy(bytes.data(), static_cast<const std::byte*>(user) + offset, bytes.size());
  return Read::kDone;
}

Result<FileSource> FileSource::open(const char* path) {
  if (!path) return Error{ErrorCode::kMisuse, "the path is null"};
  const Result<OpenFile> opened = openFile(path);
  if (!opened) return opened.error().code == ErrorCode::kIo ? nameFile(path, opened.error()) : opened.error();
  FileSource source;
  source.file_ = new (std::nothrow) File;
  if (!source.file_) {
    closeFile(*opened);
    return Error{ErrorCode::kOutOfMemory, "no memory for the file"};
  }
  source.file_->open = *opened;
  return Result<FileSource>(std::move(source));
}

Source FileSource::source() const {
  if (!file_) return {};
  Source source;
  source.user = file_;
  source.size = file_->open.size;
  source.read = [](void* user, std::uint64_t offset, std::span<std::byte> bytes) {
    return readFile(static_cast<const File*>(user)->open, offset, bytes) ? Read::kDone : Read::kFailed;
  };
  source.acquire = [](void* user) { static_cast<File*>(user)->uses.fetch_add(1, std::memory_order_relaxed); };
  source.release = [](void* user) {
    File* const file = static_cast<File*>(user);
    if (file->uses.fetch_sub(1, std::memory_order_acq_rel) > 1) return;
    closeFile(file->open);
    delete file;
  };
  return source;
}

FileSource& FileSource::operator=(FileSource&& other) noexcept {
  std::swap(file_, other.file_);
  return *this;
}

FileSource::~FileSource() {
  if (file_) source().release(file_);
}

}  // namespace kelp
