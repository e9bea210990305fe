// SPDX-License-Identifier: MIT
#include "piped_source.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <fmt/format.h>

#include "commands.h"
#include "kelp/formats/pack.h"
#include "text.h"

namespace kelp::dump {

PipedSource::PipedSource() {
  if (::isatty(STDIN_FILENO) == 1) throw DumpError(kUsage, "-: standard input is a terminal; pipe a .kelp file into it");
  for (;;) {
    const std::size_t at = size_ % kBlock;
    if (at == 0) {
      // Another kind of file, an endless one perhaps, need not be read to its end.
      if (blocks_.size() == 1) {
        const Result<Pack> opened = Pack::open(source());
        if (!opened && opened.error().code == ErrorCode::kNotAPack) return;
      }
      blocks_.push_back(std::make_unique<std::byte[]>(kBlock));
    }
    const ssize_t got = ::read(STDIN_FILENO, blocks_.back().get() + at, kBlock - at);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw DumpError(kIo, fmt::format("standard input: can not be read: {}; name the file instead", std::strerror(errno)));
    if (got == 0) return;
    size_ += static_cast<std::uint64_t>(got);
    if (size_ > kMost) throw DumpError(kUnsupported, fmt::format("standard input: is larger than {}, the most that is read from a pipe; name the file instead", bytesText(kMost)));
  }
}

bool PipedSource::read(void* user, std::uint64_t offset, std::span<std::byte> bytes) {
  const PipedSource& self = *static_cast<const PipedSource*>(user);
  if (offset > self.size_ || bytes.size() > self.size_ - offset) return false;
  while (!bytes.empty()) {
    const std::size_t at = static_cast<std::size_t>(offset % kBlock), some = std::min(bytes.size(), kBlock - at);
    std::memcpy(bytes.data(), self.blocks_[static_cast<std::size_t>(offset / kBlock)].get() + at, some);
    bytes = bytes.subspan(some);
    offset += some;
  }
  return true;
}

}  // namespace kelp::dump
