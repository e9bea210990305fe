// SPDX-License-Identifier: MIT
// All plants: where they stand, and how they lean and sway now.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "kelp/runtime/spring.h"
#include "library.h"
#include "scatter.h"
#include "solids.h"

namespace underwater {

class Meadow {
 public:
  static kelp::Result<std::unique_ptr<Meadow>> plant(const Library& library, int count);

  // The poses `seconds` into the scene, `passed` seconds after the last ones. Plants make way for the player,
  // a ball of radius 0 or more. Allocates nothing.
  void update(double seconds, float passed, const kelp::runtime::Sphere& player);
  // Bends a plant aside where a ball of that radius touches it, so far that it leaves the ball if it can.
  void giveWay(const Solids::Touch& touch, float radius);
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
    glm::vec2 stem{0};    // x and z of its middle line, undeformed
    float height = 0;     // meters, from the foot to the spline's end
    float stiffness = 0;  // of the spring: 1 / seconds^2
    int clip = -1;
    kelp::runtime::Instance instance() const { return {asset, &pose, to_world, glm::vec4(site.tint, 1)}; }
  };
  void sway(Rooted& plant) const;

  std::vector<Rooted> plants_;  // made once: instances point into it
  double seconds_ = 0;
};

}  // namespace underwater
