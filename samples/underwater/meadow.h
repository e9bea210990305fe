// SPDX-License-Identifier: MIT
// All plants: where they stand, and how they lean and sway now.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "kelp/runtime/spring.h"
#include "library.h"
#include "scatter.h"

namespace underwater {

// A body that plants make way for.
struct Visitor {
  glm::vec3 at{0};
  float radius = 0;  // metres; 0: nobody
};

class Meadow {
 public:
  static kelp::Result<std::unique_ptr<Meadow>> plant(const Library& library, int count);

  // The poses `seconds` into the scene, `passed` seconds after the last ones. Allocates nothing.
  void update(double seconds, float passed, std::span<const Visitor> visitors);
  // Writes size() instances, whose poses stay the meadow's.
  void place(std::span<kelp::runtime::Instance> instances) const;
  std::size_t size() const { return plants_.size(); }

 private:
  struct Rooted {
    const kelp::runtime::Asset* asset;
    kelp::runtime::Pose pose;
    kelp::runtime::Spring spring;
    Site site;
    glm::vec3 foot{0};  // world
    glm::mat4 to_world{1};
    float height = 0;     // metres, from the foot to the spline's end
    float stiffness = 0;  // of the spring: 1 / seconds^2
    int clip = -1;
  };

  std::vector<Rooted> plants_;  // made once: instances point into it
};

}  // namespace underwater
