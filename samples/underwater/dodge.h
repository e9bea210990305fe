// SPDX-License-Identifier: MIT
// How a swimmer leaves its lane where something is in the way, and comes back. The way ahead is an elastic
// band (Quinlan and Khatib 1993): posts a step apart that solids push aside, that pull at their neighbors
// and that want back to the lane. A body follows the band, so it turns before it is there.
#pragma once

#include <array>
#include <cstdint>

#include "path.h"
#include "solids.h"

namespace underwater {

class Dodge {
 public:
  // Moves the posts for `passed` seconds. `swum` is how far along the lane the head is since the beginning,
  // rounds included, and never falls. The body behind it is `length` meters long and `radius` thick.
  void update(Solids& solids, const Lane& lane, double swum, float length, float radius, float passed);
  // True if something is so near the body that it might touch.
  bool tight() const { return tight_; }
  // How far off the lane (world), `ahead` meters ahead of the head. Smooth.
  glm::vec3 at(float ahead) const;

 private:
  static constexpr int kPosts = 16;
  struct Post {
    glm::vec3 aside{0}, velocity{0};  // off the lane: meters, meters a second
    glm::vec3 push{0};                // meters a second squared
  };
  void follow(std::int64_t first);

  std::array<Post, kPosts> posts_;
  std::int64_t first_ = 0;  // which post along the lane posts_[0] is
  bool tight_ = false;
  float head_ = 0;  // where the head is, in posts after posts_[0]
};

}  // namespace underwater
