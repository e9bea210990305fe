// SPDX-License-Identifier: MIT
// A soft body on the nodes of a cage: position based dynamics, as plain as it gets. No OpenGL here.
//
// A step predicts where nodes fly, then moves them to where their constraints want them, and takes the way
// that they really went as their velocity (Macklin et al. 2016, XPBD, in small steps). Constraints:
//   edges   keep their length, softly: runtime::nodeEdges();
//   shape   each node is held, softly, to its place in the shape at rest, turned and moved as the body is now
//           (Mueller et al. 2005, shape matching);
//   ground  nodes stay above what runtime::distance() says;
//   finger  nodes stay out of a sphere.
#pragma once

#include <optional>
#include <vector>

#include "kelp/kelp.hpp"

class SoftBody {
 public:
  // Of the part's finest cage. The asset must be loaded, with distances.
  SoftBody(const kelp::runtime::Asset& asset, int part);

  void drop(float height, float tilt);  // from rest: meters above its place, radians
  // Steps of one length make the same motion on every machine. ground: what it falls on.
  void step(float seconds, kelp::runtime::Instances ground,
            const std::optional<kelp::runtime::Sphere>& finger);
  // Nodes in meters -> nodes of the pose, voxels.
  void write(kelp::runtime::Pose& pose) const;
  void fling(float speed);  // all nodes, apart: more than any solver bears

  std::size_t nodes() const { return at_.size(); }
  std::size_t edges() const { return edges_.size(); }
  double mass() const { return mass_; }
  double energy() const;  // joules: of motion, height and springs
  // The farthest that a node is from its place in the shape at rest, turned and moved as the body is; voxels.
  double strain() const;
  glm::vec3 middle() const { return middle_; }

 private:
  struct Node {
    glm::vec3 at, before, velocity;
    glm::vec3 rest;  // from the middle of the body
    float mass, inverse_mass;
    glm::vec3 to_solid;  // at rest, from the node to the solid nearest to it: that is what meets the ground
    // The plane of the ground near that, for a frame: dot(normal, at + turned to_solid) >= height.
    glm::vec3 normal;
    float height;
  };
  struct Edge {
    std::uint32_t a, b;
    float length;
  };
  void findGround(kelp::runtime::Instances ground, float seconds);
  void findShape();
  void holdEdges(float seconds);
  void holdShape(float seconds);
  void stayAbove();
  void leave(const kelp::runtime::Sphere& finger);

  int part_;
  glm::mat4 to_part_;  // meters -> voxels
  float voxel_;        // meters
  double mass_ = 0;
  std::vector<Node> at_;
  std::vector<Edge> edges_;
  glm::vec3 middle_{0}, rest_middle_{0};
  glm::quat turn_{1, 0, 0, 0};
};
