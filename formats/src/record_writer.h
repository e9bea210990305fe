// SPDX-License-Identifier: MIT
// Writes values one after the other into a table of known size.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <vector>

#include "kelp/formats/buffer.h"
#include "layout.h"

namespace kelp {

class RecordWriter {
 public:
  explicit RecordWriter(Buffer<std::byte>& out) : out_(out) {}

  template <class T>
  void put(const T& value) {
    layout::store(out_.span(), at_, value);
    at_ += sizeof(T);
  }
  void count(std::size_t n) { put(static_cast<std::uint32_t>(n)); }
  void skip(std::size_t bytes) { at_ += bytes; }
  void text(std::string_view text) {
    if (!text.empty()) std::memcpy(out_.data() + at_, text.data(), text.size());
    at_ += text.size();
  }
  template <class T>
  void array(const std::vector<T>& values) {
    if (!values.empty()) std::memcpy(out_.data() + at_, values.data(), values.size() * sizeof(T));
    at_ += values.size() * sizeof(T);
  }
  // Numbers in planes: visit(put) calls put(number) for each of them.
  template <class Visit>
  void planes(std::size_t count, const Visit& visit) {
    std::size_t next = 0;
    visit([&](std::uint32_t number) {
      for (std::size_t plane = 0; plane < 4; ++plane)
        layout::store(out_.span(), at_ + plane * count + next,
                      static_cast<std::uint8_t>(number >> (8 * plane)));
      ++next;
    });
    at_ += 4 * count;
  }

 private:
  Buffer<std::byte>& out_;
  std::size_t at_ = 0;
};

}  // namespace kelp
