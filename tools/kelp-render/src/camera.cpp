// SPDX-License-Identifier: MIT
#include "camera.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/gtc/matrix_transform.hpp>

#include "kelp/formats/brick.h"
#include "kelp/formats/sweep.h"
#include "kelp/runtime/level.h"

namespace kelp::render {
namespace {

constexpr double kFieldOfView = 35.0;  // degrees, vertical
constexpr double kMargin = 0.9;        // of the picture that the model may fill

glm::dmat4 aboutY(double degrees) {
  return glm::rotate(glm::dmat4(1), glm::radians(degrees), glm::dvec3(0, 1, 0));
}
glm::dmat4 aboutX(double degrees) {
  return glm::rotate(glm::dmat4(1), glm::radians(degrees), glm::dvec3(1, 0, 0));
}

// How the map moves a height of a part as a whole, to the world.
class Sections {
 public:
  struct Section {
    glm::dvec3 corner, x, z;  // of the voxel at x = z = 0; by one voxel
  };

  Sections(const runtime::Instance& instance, int index, const Part& part)
      : instance_(instance), index_(index), part_(part), to_world_(partToWorld(instance, index).value()) {
    // The pose was checked.
    if (part.bend == Bend::kSweep)
      (void)makeArcs(instance.pose->knots(index), part.size, part.roll + instance.pose->motion(index)->roll,
                     kArcTolerance, chain_);
  }

  Section at(float height) const {
    if (part_.bend == Bend::kShear)
      return {toWorld(instance_, index_, part_.to_object * glm::vec4(0, height, 0, 1)).value(), to_world_[0],
              to_world_[2]};
    const glm::mat4x3 in_part = sectionAt(chain_, height);
    const glm::mat4x3 in_world(to_world_ * glm::mat4(in_part));
    const glm::vec3 corner = in_world * glm::vec4(-0.5f * glm::vec3(part_.size.x, 0, part_.size.z), 1);
    return {corner, in_world[0], in_world[2]};
  }

 private:
  const runtime::Instance& instance_;
  int index_;
  const Part& part_;
  glm::mat4 to_world_;
  ArcChain chain_;
};

}  // namespace

Framing::Framing(double yaw, double pitch, int turns, double aspect)
    : yaw_(yaw), pitch_(pitch), aspect_(aspect) {
  // In the camera's axes the side planes through the eye (ex, ey, ez) ask ez >= z + |x - ex| / tan, so the
  // extremes of z + x / tan and of z - x / tan decide; the same for y.
  const double tan_y = std::tan(glm::radians(0.5 * kFieldOfView)) * kMargin;
  const double tan_x = tan_y * aspect;
  for (int turn = 0; turn < turns; ++turn) {
    const glm::dmat3 to_camera(aboutX(pitch) * aboutY(-yaw - 360.0 * turn / turns));
    const glm::dmat3 rows = glm::transpose(to_camera);
    turns_.push_back({{rows[2] + rows[0] / tan_x, rows[2] - rows[0] / tan_x, rows[2] + rows[1] / tan_y,
                       rows[2] - rows[1] / tan_y, rows[2], -rows[2]},
                      {}});
    turns_.back().farthest.fill(-std::numeric_limits<double>::infinity());
  }
}

void Framing::add(const glm::dvec3& point) {
  low_ = glm::min(low_, point);
  high_ = glm::max(high_, point);
  for (Turn& turn : turns_)
    for (std::size_t i = 0; i < kExtremes; ++i)
      turn.farthest[i] = std::max(turn.farthest[i], glm::dot(turn.direction[i], point));
}

Camera::Camera(const Framing& framing)
    : yaw_(framing.yaw_),
      pitch_(framing.pitch_),
      turns_(static_cast<int>(framing.turns_.size())),
      aspect_(framing.aspect_),
      pivot_(0.5 * (framing.low_ + framing.high_)) {
  const double tan_y = std::tan(glm::radians(0.5 * kFieldOfView)) * kMargin;
  const double tan_x = tan_y * aspect_;
  std::array<double, Framing::kExtremes> all;
  all.fill(-std::numeric_limits<double>::infinity());
  for (const Framing::Turn& turn : framing.turns_)
    for (std::size_t i = 0; i < all.size(); ++i)
      all[i] = std::max(all[i], turn.farthest[i] - glm::dot(turn.direction[i], pivot_));
  const auto [right, left, up, down, front, behind] = all;
  eye_ = {0.5 * tan_x * (right - left), 0.5 * tan_y * (up - down),
          std::max(0.5 * (right + left), 0.5 * (up + down))};
  const double depth = std::max(front + behind, 1e-6);
  near_ = std::max(eye_.z - front - 0.05 * depth, 0.01 * (eye_.z + behind));
  far_ = eye_.z + behind + 0.05 * depth;
}

void Camera::apply(int turn, gl::View& view) const {
  const double yaw = yaw_ + 360.0 * turn / turns_;
  const glm::dmat4 to_camera = aboutX(pitch_) * aboutY(-yaw);
  view.camera.world_to_eye =
      glm::translate(glm::dmat4(1), -eye_) * to_camera * glm::translate(glm::dmat4(1), -pivot_);
  view.camera.eye_to_clip = glm::perspective(glm::radians(kFieldOfView), aspect_, near_, far_);
  view.light.sun_direction = glm::dvec3(aboutY(yaw) * glm::dvec4(-0.55, 0.8, 0.6, 0));
}

void addOutline(const runtime::Instance& instance, Framing& framing) {
  constexpr int kMostBricks = 24;  // along a side: fine enough to frame by, and few
  const std::span<const Part> parts = instance.asset->pack().parts();
  for (int p = 0; p < static_cast<int>(parts.size()); ++p) {
    const Part& part = parts[static_cast<std::size_t>(p)];
    if (part.kind == PartKind::kEmpty) continue;
    if (!part.cages.empty()) {
      const glm::dmat4 to_world(partToWorld(instance, p).value());
      for (const glm::vec3& node : instance.pose->nodes(p))
        framing.add(glm::dvec3(to_world * glm::dvec4(node, 1)));
      continue;
    }
    int index = 0;
    while (index + 1 < part.levels &&
           std::max({part.size.x, part.size.y, part.size.z}) > (kMostBricks * kBrickSide) << index)
      ++index;
    const runtime::Level& level = *instance.asset->level(p, index);
    const float brick = static_cast<float>(kBrickSide << index);
    const Sections sections(instance, p, part);

    // Two layers of corners for each layer of bricks.
    for (int y = 0; y < level.grid.y; ++y) {
      for (int upper = 0; upper < 2; ++upper) {
        const float height = std::min(brick * static_cast<float>(y + upper), static_cast<float>(part.size.y));
        const Sections::Section section = sections.at(height);
        for (int z = 0; z < level.grid.z; ++z) {
          for (int x = 0; x < level.grid.x; ++x) {
            const auto cell = static_cast<std::size_t>(x) +
                              static_cast<std::size_t>(level.grid.x) *
                                  (static_cast<std::size_t>(y) +
                                   static_cast<std::size_t>(level.grid.y) * static_cast<std::size_t>(z));
            if (!(level.cells[cell] & kCellSolid)) continue;
            for (int corner = 0; corner < 4; ++corner) {
              const double along_x =
                  std::min(brick * static_cast<float>(x + (corner & 1)), static_cast<float>(part.size.x));
              const double along_z =
                  std::min(brick * static_cast<float>(z + (corner >> 1)), static_cast<float>(part.size.z));
              framing.add(section.corner + along_x * section.x + along_z * section.z);
            }
          }
        }
      }
    }
  }
}

}  // namespace kelp::render
