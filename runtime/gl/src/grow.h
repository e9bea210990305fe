// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstring>

#include "kelp/formats/buffer.h"

namespace kelp::gl {

// Enlarges `buffer` to `size` or more, at least twice as large, and keeps its content.
template <class T>
[[nodiscard]] bool grow(Buffer<T>& buffer, std::size_t size) {
  if (size <= buffer.size()) return true;
  Buffer<T> more(buffer.allocator());
  if (!more.reset(std::max(size, 2 * buffer.size()))) return false;
  if (!buffer.empty()) std::memcpy(static_cast<void*>(more.data()), buffer.data(), buffer.size() * sizeof(T));
  buffer = std::move(more);
  return true;
}

}  // namespace kelp::gl
