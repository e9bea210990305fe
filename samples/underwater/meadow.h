// SPDX-License-Identifier: MIT
// All plants: where they stand, and how they lean and sway now.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "kelp/runtime/instance.h"
#include "library.h"
#include "scatter.h"
#include "stalk.h"

namespace underwater {

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
    Site site;
    Sway sway{};
    glm::vec3 foot{0};  // world
    glm::mat4 to_world{1};
    glm::mat3 to_part{1};  // world, without scale -> the part's axes
    float height = 0;      // metres, from the foot to the spline's end
    int clip = -1;
  };

  std::vector<Rooted> plants_;  // made once: instances point into it
};

}  // namespace underwater
