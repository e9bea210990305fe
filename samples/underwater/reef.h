// SPDX-License-Identifier: MIT
// The living scene: plants and fish, and the instances that draw them. No window, no OpenGL.
#pragma once

#include "meadow.h"
#include "shoal.h"

namespace underwater {

class Reef {
 public:
  static kelp::Result<std::unique_ptr<Reef>> grow(const Library& library, int plants);

  // The scene at a time, `passed` seconds after the last one; plants make way for fish and for the one who
  // looks. Allocates nothing.
  void update(double seconds, float passed, const Visitor& player);
  // good until the next update()
  std::span<const kelp::runtime::Instance> instances() const { return instances_; }

 private:
  std::unique_ptr<Meadow> meadow_;
  std::unique_ptr<Shoal> shoal_;
  std::vector<Visitor> visitors_;
  std::vector<kelp::runtime::Instance> instances_;
};

}  // namespace underwater
