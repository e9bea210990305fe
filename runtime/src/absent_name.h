// SPDX-License-Identifier: MIT
// The error for a name that a pack does not have: it lists those that it has.
#pragma once

#include <span>
#include <string_view>

#include "kelp/formats/buffer.h"
#include "kelp/formats/error.h"

namespace kelp::runtime {

class AbsentName {
 public:
  explicit AbsentName(const Allocator& allocator) : text_(allocator) {}

  // `kind` is "clip", "part", "socket" or "joint"; the items have names. False: no memory.
  template <class Item>
  [[nodiscard]] bool prepare(std::string_view kind, std::span<const Item> items) {
    if (!text_.reset(kMostBytes)) return false;
    add("there is no ");
    add(kind);
    add(" of that name; ");
    add(items.empty() ? "the pack has none" : "there are: ");
    for (std::size_t i = 0; i < items.size(); ++i) {
      if (i > 0) add(", ");
      if (used_ + items[i].name.size() + 8 > kMostBytes) {
        add("...");
        break;
      }
      add(items[i].name);
    }
    return true;
  }
  // Valid as long as this object.
  Error error() const { return {ErrorCode::kMisuse, text_.data()}; }

 private:
  static constexpr std::size_t kMostBytes = 1024;
  void add(std::string_view text) { used_ += text.copy(text_.data() + used_, text.size()); }
  Buffer<char> text_;
  std::size_t used_ = 0;
};

}  // namespace kelp::runtime
