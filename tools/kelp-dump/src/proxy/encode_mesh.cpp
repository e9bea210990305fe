// SPDX-License-Identifier: MIT
#include "proxy/encode_mesh.h"

#include <sstream>
#include <utility>

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

#include "kelp/common/error.h"

namespace kelp::dump {

std::string encodeMesh(const std::vector<glm::vec3>& points,
                       const std::vector<std::array<std::uint32_t, 3>>& triangles,
                       const std::string& extension) {
  OpenMesh::TriMesh_ArrayKernelT<> mesh;
  for (const glm::vec3& point : points) mesh.add_vertex({point.x, point.y, point.z});
  const auto vertex = [](std::uint32_t index) { return OpenMesh::VertexHandle(static_cast<int>(index)); };
  for (const auto& [a, b, c] : triangles) mesh.add_face(vertex(a), vertex(b), vertex(c));
  const bool text = extension == ".obj" || extension == ".off";
  constexpr std::streamsize kDigitsOfFloat = 9;
  std::ostringstream stream;
  omlog().disable();  // it tells that it writes
  if (!OpenMesh::IO::write_mesh(mesh, stream, extension,
                                text ? OpenMesh::IO::Options::Default : OpenMesh::IO::Options::Binary,
                                kDigitsOfFloat))
    throw ToolError(Exit::kRuntime, "OpenMesh cannot write a mesh as " + extension);
  return std::move(stream).str();
}

}  // namespace kelp::dump
