// SPDX-License-Identifier: MIT
#include "copies.h"

namespace kelp::draw {

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
