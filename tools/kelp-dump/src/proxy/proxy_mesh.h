// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "proxy/triangle.h"

namespace kelp::dump {

struct ProxyMesh {
  std::vector<glm::dvec3> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise seen from outside

  Triangle triangle(std::size_t i) const {
    return {points[triangles[i][0]], points[triangles[i][1]], points[triangles[i][2]]};
  }
};

}  // namespace kelp::dump
