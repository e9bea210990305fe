// SPDX-License-Identifier: MIT
// Changing the knots of a pose, for tests that think in voxels.
#pragma once

#include <utility>
#include <vector>

#include "kelp/runtime/pose.h"
#include "support/voxel_knots.h"

namespace kelp::test {

// The knots of a pose in voxels of a part of `height`, to change as one likes: no tangent follows. The pose
// gets them when this is destroyed.
class EditedKnots {
 public:
  EditedKnots(runtime::Pose& pose, int part, float height)
      : pose_(pose),
        part_(part),
        height_(height),
        knots_(inVoxels(std::as_const(pose).knots(part), height)),
        before_(knots_) {}
  ~EditedKnots() {
    // What was not changed keeps its bits.
    std::vector<Knot> after(std::as_const(pose_).knots(part_).begin(),
                            std::as_const(pose_).knots(part_).end());
    for (std::size_t i = 0; i < knots_.size(); ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        if (!(knots_[i].position[axis] == before_[i].position[axis]))
          after[i].position[axis] = knots_[i].position[axis] / height_;
        if (!(knots_[i].tangent[axis] == before_[i].tangent[axis]))
          after[i].tangent[axis] = knots_[i].tangent[axis] / height_;
      }
    }
    (void)pose_.setKnots(part_, after);
  }
  EditedKnots(const EditedKnots&) = delete;
  EditedKnots& operator=(const EditedKnots&) = delete;

  Knot& operator[](std::size_t i) { return knots_[i]; }
  Knot& back() { return knots_.back(); }
  auto begin() { return knots_.begin(); }
  auto end() { return knots_.end(); }

 private:
  runtime::Pose& pose_;
  int part_;
  float height_;
  std::vector<Knot> knots_, before_;
};
inline EditedKnots edit(runtime::Pose& pose, int part, float height = 1) { return {pose, part, height}; }

}  // namespace kelp::test
