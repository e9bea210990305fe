// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace kelp::bake {

// XXH3-128 of bytes that come in pieces. Tells contents apart; it is no protection against somebody who means to deceive.
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

}  // namespace kelp::bake
