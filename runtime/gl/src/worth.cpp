// SPDX-License-Identifier: MIT
#include "worth.h"

#include <algorithm>

namespace kelp::gl {
namespace {

constexpr float kMuchLess = 0.25f;  // of the peak
constexpr int kMostPatience = 16;   // ages

}  // namespace

void Worth::update(float priority, bool drawn, bool new_age) {
  priority_ = priority;
  if (new_age) {
    quiet_ = recent_ < kMuchLess * peak_ ? static_cast<std::uint8_t>(quiet_ + 1) : std::uint8_t{0};
    if (quiet_ > patience_) {
      peak_ = recent_;
      quiet_ = 0;
    }
    recent_ = 0;
  }
  if (drawn) recent_ = std::max(recent_, priority_);
  peak_ = std::max(peak_, recent_);
  restless_ = restless_ && peak_ > 0;
  value_ = restless_ ? peak_ : priority_;
}

void Worth::gotPlace(std::uint32_t round) {
  if (restless_ || lost_ == 0 || round - lost_ >= 2 * kAge) return;
  restless_ = true;
  patience_ = static_cast<std::uint8_t>(std::clamp(2 * patience_, 1, kMostPatience));
}

}  // namespace kelp::gl
