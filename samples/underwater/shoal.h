// SPDX-License-Identifier: MIT
// All fish: schools on their paths, round what is in their way.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "dodge.h"
#include "library.h"
#include "swimmer.h"

namespace underwater {

// The closed paths that the schools swim, in the order of shoal.cpp's schools; made anew at every call.
std::vector<ClosedPath> swimPaths();

class Shoal {
 public:
  static kelp::Result<std::unique_ptr<Shoal>> gather(const Library& library);

  // The poses `seconds` into the scene, `passed` seconds after the last ones. Allocates nothing.
  void update(double seconds, float passed, Solids& solids);
  // Writes size() instances, whose poses stay the shoal's.
  void place(std::span<kelp::runtime::Instance> instances) const;
  // Balls that push plants: kBalls along the body of each fish that is near a plant.
  std::span<const kelp::runtime::Sphere> balls() const { return balls_; }
  static constexpr int kBalls = 4;
  std::size_t size() const { return fish_.size(); }

 private:
  struct Fish {
    const kelp::runtime::Asset* asset;
    kelp::runtime::Pose pose;
    const Anatomy* anatomy;
    Lane lane{};
    int clip = -1;
    float start = 0, speed = 0;  // meters along the path, meters a second
    float scale = 1;
    float phase = 0;  // radians
    glm::vec3 tint{1};
    Dodge dodge{};
    glm::mat4 to_world{1};
  };

  std::vector<ClosedPath> paths_;
  Anatomy anatomies_[2];
  std::vector<Fish> fish_;  // made once: instances point into it
  std::vector<kelp::runtime::Sphere> balls_;
};

}  // namespace underwater
