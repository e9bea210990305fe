// SPDX-License-Identifier: MIT
// A smooth closed curve to swim along, measured by its length.
#pragma once

#include <span>
#include <vector>

#include "kelp/formats/spline.h"

namespace underwater {

// Catmull-Rom through its points, closed. Questions are answered by tables, in constant time and without
// memory.
class ClosedPath {
 public:
  // At least 3 points, meters, none equal to the next.
  explicit ClosedPath(std::span<const glm::vec3> points);

  float length() const { return length_; }  // meters
  glm::vec3 at(float s) const;              // s meters along it; any s, it goes round and round
  glm::vec3 direction(float s) const;       // unit
  float turn(float s) const;                // to the right, radians a meter: the curvature seen from above

 private:
  struct Place {
    std::size_t segment;
    float t;
  };
  Place place(float s) const;

  std::vector<kelp::Segment> segments_;
  std::vector<float> parameter_;  // at equal lengths: segment + t, from 0 to the number of segments
  float length_ = 0;
};

class Dodge;

// A line beside a path, as a lane on a road: shifted to the right and up by meters. The road is never banked.
struct Lane {
  const ClosedPath* path = nullptr;
  float right = 0, up = 0;
  // If not null: leaves the line round what is in the way of a swimmer whose head is at `head`.
  const Dodge* dodge = nullptr;
  float head = 0;

  glm::vec3 at(float s) const;
  glm::vec3 direction(float s) const;  // unit
};

}  // namespace underwater
