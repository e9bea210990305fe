// SPDX-License-Identifier: MIT
// The value of a level from round to round (a round is an upload()), and the rules against thrashing: in too
// small a budget, models that sway must not take each other's place for ever.
#pragma once

#include <algorithm>
#include <cstdint>

namespace kelp::draw {

// A block is dropped only for one of this many times its value.
inline constexpr float kWorthMoving = 1.25f;

// A level that lost its place and came back soon is restless: its value is then its peak, the highest
// priority that it ever had, until its priority was much less for some ages. While the camera rests peaks
// only grow, and a block is dropped only for a higher one, so the exchange ends. Levels that did not come
// back keep no peak; otherwise everything that a camera passed would hold its place.
class Worth {
 public:
  // > 0: wanted; the pixels that a voxel of the next coarser level covers. < 0: minus the rounds since it was
  // wanted.
  float priority() const { return priority_; }
  // It is dropped for a higher one. Its priority or, restless, its peak.
  float value() const { return value_; }

  // A new round. `drawn`: something was drawn already, so priorities mean pixels. `new_age`: isNewAge(round).
  void update(float priority, bool drawn, bool new_age);
  // Something of the level lost its place in this round.
  void lostPlace(std::uint32_t round) { lost_ = round; }
  // Something of the level gets a place in this round.
  void gotPlace(std::uint32_t round);

  static bool isNewAge(std::uint32_t round) { return round % kAge == 0; }

 private:
  static constexpr std::uint32_t kAge = 256;  // rounds
  static constexpr float kMuchLess = 0.25f;   // of the peak
  static constexpr int kMostPatience = 16;    // ages

  float priority_ = 0;
  float value_ = 0;
  float recent_ = 0;           // its highest priority in this age
  float peak_ = 0;             // in all ages since its priority was last much less
  std::uint32_t lost_ = 0;     // the round in which it last lost a place; 0: never
  std::uint8_t quiet_ = 0;     // ages in which its priority was much less than its peak
  std::uint8_t patience_ = 0;  // so many ages may be quiet; twice as many each time that it came back soon
  bool restless_ = false;
};

inline void Worth::update(float priority, bool drawn, bool new_age) {
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

inline void Worth::gotPlace(std::uint32_t round) {
  if (restless_ || lost_ == 0 || round - lost_ >= 2 * kAge) return;
  restless_ = true;
  patience_ = static_cast<std::uint8_t>(std::clamp(2 * patience_, 1, kMostPatience));
}

}  // namespace kelp::draw
