// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "kelp/formats/source.h"

namespace kelp::dump {

// Standard input or a named pipe, held in memory: a pack is not read from front to back.
class PipedSource {
 public:
  static constexpr std::uint64_t kMost = std::uint64_t{512} << 20;

  // Reads to the end; "-" is standard input. Stops early if the data do not begin as a pack. ToolError kIo;
  // kUnsupported beyond kMost bytes.
  explicit PipedSource(const std::string& path);

  Source source() { return {&PipedSource::read, this, size_}; }

 private:
  static constexpr std::size_t kBlock = std::size_t{1} << 20;

  static Read read(void* user, std::uint64_t offset, std::span<std::byte> bytes);

  std::vector<std::unique_ptr<std::byte[]>> blocks_;  // never moved: the size is known at the end alone
  std::uint64_t size_ = 0;
};

}  // namespace kelp::dump
