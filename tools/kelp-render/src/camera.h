// SPDX-License-Identifier: MIT
// A camera that sees all of the model in all frames, as large as possible, with +Y up.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <glm/mat4x4.hpp>

#include "kelp/runtime/pose.h"
#include "kelp/gl/renderer.h"

namespace kelp::render {

// World points to be seen, in any frame: of each frame of a full turn what lies farthest out.
class Framing {
 public:
  // `turns`: how many frames of a full turn; 1: no turntable. Angles in degrees.
  Framing(double yaw, double pitch, int turns, double aspect);
  void add(const glm::dvec3& point);
  bool empty() const { return !(low_.x <= high_.x); }

 private:
  friend class Camera;
  static constexpr std::size_t kExtremes = 6;  // to the right, left, up, down, front and back
  struct Turn {
    std::array<glm::dvec3, kExtremes> direction;
    std::array<double, kExtremes> farthest;
  };
  double yaw_, pitch_, aspect_;
  glm::dvec3 low_{1e30}, high_{-1e30};
  std::vector<Turn> turns_;
};

class Camera {
 public:
  // The nearest that has all points between the planes of its sides.
  explicit Camera(const Framing& framing);

  // The view of one frame; viewport and light of the caller are kept, but the sun stands to the left behind the camera.
  void apply(int turn, gl::View& view) const;
  double nearPlane() const { return near_; }
  double farPlane() const { return far_; }

 private:
  double yaw_, pitch_;
  int turns_;
  double aspect_;
  glm::dvec3 pivot_;
  glm::dvec3 eye_{0};  // in the camera's axes, from the pivot
  double near_ = 0, far_ = 0;
};

// The corners of the bricks that hold voxels, as the instance poses them, world: what a camera has to see. The asset must be loaded.
void addOutline(const runtime::Instance& instance, Framing& framing);

}  // namespace kelp::render
