// SPDX-License-Identifier: MIT
// The living scene: plants and fish, and the instances that draw them. No window, no OpenGL.
#pragma once

#include "meadow.h"
#include "shoal.h"

namespace underwater {

class Reef {
 public:
  // The scene as it is `start` seconds after its beginning, in motion.
  static kelp::Result<std::unique_ptr<Reef>> grow(const Library& library, int plants, double start = 0);

  // The scene at a time, `passed` seconds after the last one: fish keep clear of plants, and plants make way
  // for fish that touch them all the same and for the one who looks. Allocates nothing.
  void update(double seconds, float passed, const kelp::runtime::Sphere& player);
  // good until the next update()
  std::span<const kelp::runtime::Instance> instances() const { return instances_; }
  // How many distances the last update() asked for.
  int asked() const { return solids_.asked(); }

 private:
  std::unique_ptr<Meadow> meadow_;
  std::unique_ptr<Shoal> shoal_;
  Solids solids_;
  std::vector<kelp::runtime::Instance> instances_;
};

}  // namespace underwater
