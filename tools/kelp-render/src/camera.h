// SPDX-License-Identifier: MIT
// A camera that sees all of the model in all frames, as large as possible, with +Y up.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <glm/mat4x4.hpp>

#include "kelp/gl/renderer.h"
#include "kelp/runtime/pose.h"

namespace kelp::render {

// Collects the world points that any frame shows: for each frame of a full turn, the outermost ones.
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
  // The nearest camera that has all points between its side planes.
  explicit Camera(const Framing& framing);

  // Sets the matrices of one frame, and the sun, which stands to the left behind the camera. Leaves the rest.
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

// Adds the corners of the bricks that hold voxels, posed, in the world. The asset must be loaded.
void addOutline(const runtime::Instance& instance, Framing& framing);

}  // namespace kelp::render
