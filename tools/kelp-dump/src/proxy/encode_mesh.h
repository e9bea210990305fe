// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

namespace kelp::dump {

// A mesh as a file of a format, by OpenMesh: ".obj" and ".off" as text with all digits of a float, ".ply" and
// ".stl" in binary. ToolError kRuntime if OpenMesh refuses.
std::string encodeMesh(const std::vector<glm::vec3>& points,
                       const std::vector<std::array<std::uint32_t, 3>>& triangles,
                       const std::string& extension);

}  // namespace kelp::dump
