// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace kelp::bake {

// XXH3-64 of a file's bytes as 16 hexadecimal digits. BakeError kIo if it can not be read.
std::string hashFile(const std::filesystem::path& path);
// The same of bytes in memory.
std::string hashBytes(std::span<const std::uint8_t> bytes);

// XXH3-64 of bytes that come in pieces.
class HashStream {
 public:
  HashStream();
  ~HashStream();
  HashStream(const HashStream&) = delete;
  HashStream& operator=(const HashStream&) = delete;
  void add(std::span<const std::byte> bytes);
  std::uint64_t value() const;

 private:
  void* state_;  // of xxHash
};

}  // namespace kelp::bake
