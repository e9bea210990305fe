// SPDX-License-Identifier: MIT
// Changing the knots of a pose, for tests that think in voxels.
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "kelp/runtime/pose.h"

namespace kelp::test {

// The knots of a pose in voxels of a part of `height`, to change as one likes: no tangent follows. The pose
// gets them when this is destroyed. Allocates nothing.
class EditedKnots {
 public:
  EditedKnots(runtime::Pose& pose, int part, float height)
      : pose_(pose), part_(part), height_(height), count_(pose.knots(part).size()) {
    const std::span<const Knot> knots = pose.knots(part);
    std::copy(knots.begin(), knots.end(), knots_.begin());
    for (Knot& knot : *this) knot.position *= height, knot.tangent *= height;
    before_ = knots_;
  }
  ~EditedKnots() {
    std::array<Knot, kMaxKnots> after;
    const std::span<const Knot> knots = pose_.knots(part_);
    std::copy(knots.begin(), knots.end(), after.begin());
    for (std::size_t i = 0; i < count_; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        // Values that were not changed keep their bits.
        if (!(knots_[i].position[axis] == before_[i].position[axis]))
          after[i].position[axis] = knots_[i].position[axis] / height_;
        if (!(knots_[i].tangent[axis] == before_[i].tangent[axis]))
          after[i].tangent[axis] = knots_[i].tangent[axis] / height_;
      }
    }
    (void)pose_.setKnots(part_, std::span(after).first(count_));
  }
  EditedKnots(const EditedKnots&) = delete;
  EditedKnots& operator=(const EditedKnots&) = delete;

  Knot& operator[](std::size_t i) { return knots_[i]; }
  Knot& back() { return knots_[count_ - 1]; }
  Knot* begin() { return knots_.data(); }
  Knot* end() { return knots_.data() + count_; }

 private:
  runtime::Pose& pose_;
  int part_;
  float height_;
  std::size_t count_;
  std::array<Knot, kMaxKnots> knots_, before_;
};
inline EditedKnots edit(runtime::Pose& pose, int part, float height = 1) { return {pose, part, height}; }

}  // namespace kelp::test
