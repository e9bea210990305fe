// SPDX-License-Identifier: MIT
#include "pack/piped_source.h"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include "kelp/common/console.h"
#include "kelp/common/error.h"
#include "kelp/formats/pack.h"
#include "text/text.h"

namespace kelp::dump {

PipedSource::PipedSource(const std::string& path) {
  const std::string name = path == "-" ? "standard input" : path;
  if (path == "-" && console::isTerminal(console::Stream::kIn))
    throw ToolError(Exit::kUsage, "-: standard input is a terminal; pipe a .kelp file into it");
  console::Reading pipe(path);
  for (;;) {
    const std::size_t at = size_ % kBlock;
    if (at == 0) {
      // A file of another kind may be endless: it is not read to its end.
      if (blocks_.size() == 1) {
        const Result<Pack> opened = Pack::open(source());
        if (!opened && opened.error().code == ErrorCode::kNotAPack) return;
      }
      blocks_.push_back(std::make_unique<std::byte[]>(kBlock));
    }
    const std::size_t got = pipe.read({blocks_.back().get() + at, kBlock - at});
    if (!pipe.problem().empty())
      throw ToolError(Exit::kIo,
                      fmt::format("{}: cannot be read: {}; name a file instead", name, pipe.problem()));
    if (got == 0) return;
    size_ += got;
    if (size_ > kMost)
      throw ToolError(
          Exit::kUnsupported,
          fmt::format("{}: is larger than {}, the most that is read from a pipe; name the file instead", name,
                      bytesText(kMost)));
  }
}

Read PipedSource::read(void* user, std::uint64_t offset, std::span<std::byte> bytes) {
  const PipedSource& self = *static_cast<const PipedSource*>(user);
  if (offset > self.size_ || bytes.size() > self.size_ - offset) return Read::kFailed;
  while (!bytes.empty()) {
    const std::size_t at = static_cast<std::size_t>(offset % kBlock),
                      some = std::min(bytes.size(), kBlock - at);
    std::memcpy(bytes.data(), self.blocks_[static_cast<std::size_t>(offset / kBlock)].get() + at, some);
    bytes = bytes.subspan(some);
    offset += some;
  }
  return Read::kDone;
}

}  // namespace kelp::dump
