// SPDX-License-Identifier: MIT
#include "kelp/formats/source.h"

#include <cstring>
#include <utility>

namespace kelp {

bool MemorySource::read(void* user, std::uint64_t offset, std::span<std::byte> bytes) {
  const std::span<const std::byte> all = static_cast<const MemorySource*>(user)->bytes_;
  if (offset > all.size() || bytes.size() > all.size() - offset) return false;
  if (!bytes.empty()) std::memcpy(bytes.data(), all.data() + offset, bytes.size());
  return true;
}

FileSource::FileSource(FileSource&& other) noexcept
    : file_(std::exchange(other.file_, -1)), size_(std::exchange(other.size_, 0)) {}

FileSource& FileSource::operator=(FileSource&& other) noexcept {
  if (this != &other) {
    FileSource gone(std::move(*this));
    file_ = std::exchange(other.file_, -1);
    size_ = std::exchange(other.size_, 0);
  }
  return *this;
}

}  // namespace kelp
