// SPDX-License-Identifier: MIT
#include "dodge.h"

#include <algorithm>
#include <cmath>

namespace underwater {
namespace {

constexpr float kStep = 0.16f;    // meters between posts
constexpr float kMargin = 0.22f;  // meters: the room about its body that a fish likes
constexpr float kTouch = 0.12f;   // meters: with more room than this nothing touches the body
// Accelerations, in 1 / seconds^2: of a post that is too near, off the lane, and off its neighbors.
constexpr float kPush = 90, kHome = 2, kPull = 300;
constexpr float kOut = 4;        // how much more the way out of a plant counts than the way out of its leaves
constexpr float kDrag = 14;      // 1 / second
constexpr float kSteady = 0.2f;  // seconds over which pushes are averaged
constexpr float kLongestStep = 0.04f;  // seconds: longer steps would overshoot

}  // namespace

void Dodge::follow(std::int64_t first) {
  const std::int64_t moved = first - first_;
  first_ = first;
  if (moved < 0 || moved >= kPosts) {  // somewhere else
    posts_ = {};
    return;
  }
  std::rotate(posts_.begin(), posts_.begin() + moved, posts_.end());
  // New posts go on where the band ends.
  const std::size_t kept = kPosts - static_cast<std::size_t>(moved);
  for (std::size_t i = kept; i < kPosts; ++i) posts_[i] = {posts_[kept - 1].aside};
}

void Dodge::update(Solids& solids, const Lane& lane, double swum, float length, float radius, float passed) {
  // at() needs more posts on each side.
  follow(static_cast<std::int64_t>(std::floor((swum - double{length}) / double{kStep})) - 2);
  head_ = static_cast<float>(swum / double{kStep} - static_cast<double>(first_));

  const float wanted = radius + kMargin;
  std::array<float, kPosts> along{};
  std::array<glm::vec3, kPosts> at{};
  kelp::Box box{glm::vec3(1e30f), glm::vec3(-1e30f)};
  for (std::size_t i = 0; i < kPosts; ++i) {
    const double s = static_cast<double>(first_ + static_cast<std::int64_t>(i)) * double{kStep};
    along[i] = static_cast<float>(std::fmod(s, double{lane.path->length()}));
    at[i] = lane.at(along[i]) + posts_[i].aside;
    box = {glm::min(box.min, at[i] - wanted), glm::max(box.max, at[i] + wanted)};
  }
  solids.stayWithin(box);

  std::array<glm::vec3, kPosts> push{};
  tight_ = false;
  float free = 0;  // of a ball about the post that was asked for last
  glm::vec3 asked(0);
  for (std::size_t i = 0; i < kPosts; ++i) {
    if (free - glm::distance(at[i], asked) > wanted) continue;
    const Solids::Clearance clearance = solids.clearance(at[i]);
    free = clearance.free, asked = at[i];
    if (free > wanted) continue;
    tight_ = tight_ || (static_cast<float>(i) < head_ + 1 && free < radius + kTouch);
    const glm::vec3 way = clearance.away + kOut * clearance.out, ahead = lane.direction(along[i]),
                    aside = way - glm::dot(way, ahead) * ahead;  // who is in a hurry does not wait
    push[i] = kPush * (wanted - free) / (1 + kOut) * aside;
  }
  const int rounds = static_cast<int>(std::ceil(passed / kLongestStep));
  const float step = passed / static_cast<float>(std::max(rounds, 1));
  for (int round = 0; round < rounds; ++round) {
    std::array<glm::vec3, kPosts> force{};
    for (std::size_t i = 0; i < kPosts; ++i) {
      Post& post = posts_[i];
      post.push = glm::mix(push[i], post.push, std::exp(-step / kSteady));
      force[i] = post.push - kHome * post.aside;
      if (i > 0) force[i] += kPull * (posts_[i - 1].aside - post.aside);
      if (i + 1 < kPosts) force[i] += kPull * (posts_[i + 1].aside - post.aside);
    }
    for (std::size_t i = 0; i < kPosts; ++i) {
      posts_[i].velocity = (posts_[i].velocity + step * force[i]) / (1 + step * kDrag);
      posts_[i].aside += step * posts_[i].velocity;
    }
  }
}

// A uniform cubic B-spline: its second derivative has no jumps.
glm::vec3 Dodge::at(float ahead) const {
  const float x = std::clamp(head_ + ahead / kStep, 1.0f, static_cast<float>(kPosts) - 2.001f);
  const auto i = static_cast<std::size_t>(x);
  const float t = x - static_cast<float>(i), u = 1 - t;
  return (u * u * u * posts_[i - 1].aside + (3 * t * t * (t - 2) + 4) * posts_[i].aside +
          (3 * u * u * (u - 2) + 4) * posts_[i + 1].aside + t * t * t * posts_[i + 2].aside) /
         6.0f;
}

}  // namespace underwater
