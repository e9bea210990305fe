// SPDX-License-Identifier: MIT
// All fish: schools on their paths. Where everyone is follows from the time alone.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "library.h"
#include "meadow.h"
#include "swimmer.h"

namespace underwater {

// The closed paths that the schools swim, in the order of shoal.cpp's schools; made anew at every call.
std::vector<ClosedPath> swimPaths();

class Shoal {
 public:
  static kelp::Result<std::unique_ptr<Shoal>> gather(const Library& library);

  // The poses `seconds` into the scene. Allocates nothing.
  void update(double seconds);
  // Writes size() instances, whose poses stay the shoal's.
  void place(std::span<kelp::runtime::Instance> instances) const;
  // What plants feel of the fish as they are now.
  std::span<const Visitor> visitors() const { return visitors_; }
  std::size_t size() const { return fish_.size(); }

 private:
  struct Fish {
    const kelp::runtime::Asset* asset;
    kelp::runtime::Pose pose;
    const Anatomy* anatomy;
    Lane lane;
    int clip = -1;
    float start = 0, speed = 0;  // metres along the path, metres a second
    float scale = 1;
    float phase = 0;  // radians
    glm::vec3 tint{1};
    glm::mat4 to_world{1};
  };

  std::vector<ClosedPath> paths_;
  Anatomy anatomies_[2];
  std::vector<Fish> fish_;  // made once: instances point into it
  std::vector<Visitor> visitors_;
};

}  // namespace underwater
