// SPDX-License-Identifier: MIT
// The obstacles of fish: the plants as they are bent now, and the sand.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "kelp/runtime/distance.h"

namespace underwater {

class Solids {
 public:
  // The plants must live as long; their poses may change, if look() or lookAt() is called then.
  explicit Solids(std::span<const kelp::runtime::Instance> plants = {});

  // Once a frame, when all plants are where they are.
  void look();
  void lookAt(int plant);
  // From now on only plants that reach into the box are asked: a few in place of hundreds.
  void stayWithin(const kelp::Box& box);

  struct Clearance {
    float free = 0;           // meters: a ball of this radius is free. Below 0: inside of something
    glm::vec3 away{0, 1, 0};  // unit; where there is more room
    glm::vec3 out{0, 1, 0};   // unit; the way out of the whole plant: `away` may only lead to the next leaf
  };
  // Plants whose pack has no distances count for nothing.
  Clearance clearance(const glm::vec3& at) const;
  struct Touch {
    int plant = 0;
    glm::vec3 point{0};        // of the plant; nearest to the middle of the ball
    glm::vec3 aside{1, 0, 0};  // unit: the way by which the plant leaves the ball
    float deep = 0;            // meters: how far it has to go
  };
  std::optional<Touch> touch(const kelp::runtime::Sphere& ball) const;

  // How many questions were put to kelp since look().
  int asked() const { return asked_; }

 private:
  std::span<const kelp::runtime::Instance> plants_;
  std::vector<kelp::Box> boxes_;
  std::vector<int> near_;                                // which plants are asked
  std::vector<kelp::runtime::Instance> near_instances_;  // theirs
  std::vector<kelp::Box> near_boxes_;
  mutable int asked_ = 0;
};

}  // namespace underwater
