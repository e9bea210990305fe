// SPDX-License-Identifier: MIT
// What a level of a part is worth from round to round (a round is an upload()), and the rules against
// thrashing: in too small a budget, models that sway must not take each other's place for ever.
#pragma once

#include <cstdint>

namespace kelp::gl {

// A block gives way only to what is worth this much more.
inline constexpr float kWorthMoving = 1.25f;

// A level that lost its place and came back soon is restless: from then on it is worth its peak, which is the
// most that it was ever worth, until it was worth much less for some ages. While the camera rests peaks only
// grow, and a block gives way only to a higher one, so the exchange ends. Levels that did not come back keep
// no peak; otherwise everything that a camera passed would hold its place.
class Worth {
 public:
  // > 0: wanted; the pixels that a voxel of the next coarser level covers. < 0: minus the rounds since it was
  // wanted.
  float priority() const { return priority_; }
  // It gives way to what is worth more: its priority, or, restless, its peak.
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

  float priority_ = 0;
  float value_ = 0;
  float recent_ = 0;           // its highest priority in this age
  float peak_ = 0;             // in all ages since it was last worth much less
  std::uint32_t lost_ = 0;     // the round in which it last lost a place; 0: never
  std::uint8_t quiet_ = 0;     // ages in which it was worth much less than its peak
  std::uint8_t patience_ = 0;  // so many ages may be quiet; twice as many each time that it came back soon
  bool restless_ = false;
};

}  // namespace kelp::gl
