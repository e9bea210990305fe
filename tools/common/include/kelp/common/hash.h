// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace kelp {

// XXH3-128 of bytes that come in pieces. It tells contents apart, but an attacker can make two contents with
// one hash.
class Hash {
 public:
  Hash();
  ~Hash();
  Hash(const Hash&) = delete;
  Hash& operator=(const Hash&) = delete;

  void add(std::span<const std::byte> bytes);
  void add(const std::string& text) { add(std::as_bytes(std::span(text.data(), text.size()))); }
  std::string text() const;  // 32 hexadecimal digits

 private:
  void* state_;
};

// XXH3-64 of a file's bytes as 16 hexadecimal digits. ToolError kIo if it cannot be read.
std::string hashFile(const std::filesystem::path& path);
// The same for bytes in memory.
std::string hashBytes(std::span<const std::uint8_t> bytes);

}  // namespace kelp
