// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "kelp/formats/source.h"

namespace kelp::dump {

// Standard input, or a pipe by its name, in memory: a pipe can not be read from its end, where the fine levels are.
class PipedSource {
 public:
  static constexpr std::uint64_t kMost = std::uint64_t{512} << 20;

  // Reads it to its end ("-" is standard input); what does not begin as a pack, no further than that takes. DumpError: kIo; kUnsupported beyond kMost bytes.
  explicit PipedSource(const std::string& path);

  Source source() { return {&PipedSource::read, this, size_}; }

 private:
  static constexpr std::size_t kBlock = std::size_t{1} << 20;

  static bool read(void* user, std::uint64_t offset, std::span<std::byte> bytes);

  std::vector<std::unique_ptr<std::byte[]>> blocks_;  // never moved: the size is known at the end alone
  std::uint64_t size_ = 0;
};

}  // namespace kelp::dump
