// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

namespace kelp::bake {

// The colors of an OBJ file's vertices: more numbers on the lines "v", as MeshLab and Blender write them, or
// ZBrush's lines "#MRGB".
class ObjColors {
 public:
  // All numbers of the next vertex: x y z, x y z r g b, x y z r g b a, or x y z w r g b with weights of 1.
  void addVertex(std::span<const double> numbers);
  // A face ends a block of vertices.
  void endBlock() { block_ends_ = true; }
  // What follows "#MRGB": up to 64 colors MMRRGGBB, of which MM is a mask. They are for the vertices of the
  // same block, in their order.
  void addPaint(std::string_view line);
  // Linear colors: none, or one for each vertex, white where the file has none.
  std::vector<glm::vec4> take(std::vector<std::string>& notices);

 private:
  struct Paint {
    std::size_t first = 0;  // vertex
    std::vector<std::uint32_t> colors;
  };

  void makeLinear(std::vector<std::string>& notices);
  void paint(std::vector<std::string>& notices);

  std::vector<glm::vec4> colors_;  // none, or for each vertex the numbers from the fourth to the seventh
  std::vector<Paint> paint_;
  std::size_t vertices_ = 0, block_ = 0, bad_paint_ = 0;
  bool block_ends_ = false;
};

}  // namespace kelp::bake
