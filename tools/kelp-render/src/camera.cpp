// SPDX-License-Identifier: MIT
#include "camera.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

namespace kelp::render {
namespace {

constexpr double kFieldOfView = 35.0;  // degrees, vertical
constexpr double kMargin = 0.9;        // of the picture that the model may fill

glm::dmat4 aboutY(double degrees) { return glm::rotate(glm::dmat4(1), glm::radians(degrees), glm::dvec3(0, 1, 0)); }
glm::dmat4 aboutX(double degrees) { return glm::rotate(glm::dmat4(1), glm::radians(degrees), glm::dvec3(1, 0, 0)); }

}  // namespace

Camera::Camera(const std::vector<glm::dvec3>& points, double yaw, double pitch, int turns, double aspect)
    : yaw_(yaw), pitch_(pitch), turns_(turns), aspect_(aspect) {
  glm::dvec3 low(1e30);
  glm::dvec3 high(-1e30);
  for (const glm::dvec3& p : points) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  pivot_ = 0.5 * (low + high);

  // The nearest eye that has all points between the planes of its sides. In the camera's axes the side planes through (ex, ey, ez) ask
  // ez >= z + |x - ex| / tan, so the extremes of x / tan + z and of z - x / tan decide; the same for y.
  const double tan_y = std::tan(glm::radians(0.5 * kFieldOfView)) * kMargin;
  const double tan_x = tan_y * aspect;
  double right = -1e30, left = -1e30, up = -1e30, down = -1e30, front = -1e30, back = 1e30;
  for (int turn = 0; turn < turns; ++turn) {
    const glm::dmat4 to_camera = aboutX(pitch) * aboutY(-yaw - 360.0 * turn / turns);
    for (const glm::dvec3& point : points) {
      const glm::dvec3 p(to_camera * glm::dvec4(point - pivot_, 0));
      right = std::max(right, p.z + p.x / tan_x);
      left = std::max(left, p.z - p.x / tan_x);
      up = std::max(up, p.z + p.y / tan_y);
      down = std::max(down, p.z - p.y / tan_y);
      front = std::max(front, p.z);
      back = std::min(back, p.z);
    }
  }
  eye_ = {0.5 * tan_x * (right - left), 0.5 * tan_y * (up - down), std::max(0.5 * (right + left), 0.5 * (up + down))};
  const double depth = std::max(front - back, 1e-6);
  near_ = std::max(eye_.z - front - 0.05 * depth, 0.01 * (eye_.z - back));
  far_ = eye_.z - back + 0.05 * depth;
}

void Camera::apply(int turn, gl::View& view) const {
  const double yaw = yaw_ + 360.0 * turn / turns_;
  const glm::dmat4 to_camera = aboutX(pitch_) * aboutY(-yaw);
  view.world_to_eye = glm::translate(glm::dmat4(1), -eye_) * to_camera * glm::translate(glm::dmat4(1), -pivot_);
  view.eye_to_clip = glm::perspective(glm::radians(kFieldOfView), aspect_, near_, far_);
  view.sun_direction = glm::dvec3(aboutY(yaw) * glm::dvec4(-0.55, 0.8, 0.6, 0));
}

void addOutline(const runtime::Instance& instance, std::vector<glm::dvec3>& points) {
  constexpr int kMostBricks = 24;  // along a side: fine enough to frame by, and few
  const std::span<const Part> parts = instance.asset->pack().parts();
  for (int p = 0; p < static_cast<int>(parts.size()); ++p) {
    const Part& part = parts[static_cast<std::size_t>(p)];
    int index = 0;
    while (index + 1 < part.levels && std::max({part.size.x, part.size.y, part.size.z}) > (kMostBricks * kBrickSide) << index) ++index;
    const runtime::VoxelLevel& level = *instance.asset->level(p, index);
    const float brick = static_cast<float>(kBrickSide << index);
    const glm::mat4 to_world = partToWorld(instance, p);

    // The map moves every height as a whole: two layers of corners for each layer of bricks.
    for (int y = 0; y < level.grid.y; ++y) {
      for (int upper = 0; upper < 2; ++upper) {
        const float height = std::min(brick * static_cast<float>(y + upper), static_cast<float>(part.size.y));
        const glm::dvec3 axis(toWorld(instance, p, {0, height, 0}));
        for (int z = 0; z < level.grid.z; ++z) {
          for (int x = 0; x < level.grid.x; ++x) {
            const auto cell = static_cast<std::size_t>(x) +
                              static_cast<std::size_t>(level.grid.x) * (static_cast<std::size_t>(y) + static_cast<std::size_t>(level.grid.y) * static_cast<std::size_t>(z));
            if (!(level.cells[cell] & kCellSolid)) continue;
            for (int corner = 0; corner < 4; ++corner) {
              const float along_x = std::min(brick * static_cast<float>(x + (corner & 1)), static_cast<float>(part.size.x));
              const float along_z = std::min(brick * static_cast<float>(z + (corner >> 1)), static_cast<float>(part.size.z));
              points.push_back(axis + glm::dvec3(along_x * to_world[0] + along_z * to_world[2]));
            }
          }
        }
      }
    }
  }
}

}  // namespace kelp::render
