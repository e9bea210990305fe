// SPDX-License-Identifier: MIT
#include "copies.h"

#include <algorithm>

#include "pool.h"

namespace kelp::draw {

void Copies::forget(std::uint32_t row, std::uint32_t rows) {
  const std::uint64_t begin = std::uint64_t{row} * Pool::kRowBytes,
                      end = begin + std::uint64_t{rows} * Pool::kRowBytes;
  const auto gone = [=](const Copy& copy) {
    return copy.words.data() && copy.offset < end && copy.offset + copy.words.size_bytes() > begin;
  };
  count_ = static_cast<std::size_t>(std::remove_if(copies_.begin(), copies_.begin() + count_, gone) -
                                    copies_.begin());
}

std::span<const Copy> Copies::all() {
  const std::uint32_t* own = words_.data();
  for (Copy& copy : copies_.span().first(count_)) {
    if (copy.words.data()) continue;
    copy.words = {own, copy.words.size()};
    own += copy.words.size();
  }
  return copies_.span().first(count_);
}

}  // namespace kelp::draw
