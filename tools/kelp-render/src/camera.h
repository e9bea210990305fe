// SPDX-License-Identifier: MIT
// A camera that sees all of the model in all frames, as large as possible, with +Y up.
#pragma once

#include <vector>

#include <glm/mat4x4.hpp>

#include "kelp/runtime/pose.h"
#include "kelp/gl/renderer.h"

namespace kelp::render {

class Camera {
 public:
  // `points`: world points to be seen, in any frame. `turns`: how many frames of a full turn; 1: no turntable. Angles in degrees.
  Camera(const std::vector<glm::dvec3>& points, double yaw, double pitch, int turns, double aspect);

  // The view of one frame; viewport and light of the caller are kept, but the sun stands to the left behind the camera.
  void apply(int turn, gl::View& view) const;
  double nearPlane() const { return near_; }
  double farPlane() const { return far_; }

 private:
  double yaw_, pitch_;
  int turns_;
  double aspect_;
  glm::dvec3 pivot_{0};
  glm::dvec3 eye_{0};  // in the camera's axes, from the pivot
  double near_ = 0, far_ = 0;
};

// The corners of the bricks that hold voxels, as the instance poses them, world: what a camera has to see. The asset must be loaded.
void addOutline(const runtime::Instance& instance, std::vector<glm::dvec3>& points);

}  // namespace kelp::render
