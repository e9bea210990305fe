// SPDX-License-Identifier: MIT
#include "sea_floor.h"

#include <cstddef>

#include "floor_mesh.h"
#include "glsl.h"

namespace underwater {

SeaFloor::SeaFloor(float radius)
    : program_(makeProgram("sea floor", glsl::kFloorVertex, glsl::kFloorFragment)) {
  const FloorMesh mesh = makeFloorMesh(radius, 90, 160);
  indices_ = static_cast<GLsizei>(mesh.indices.size());
  glGenVertexArrays(1, &array_);
  glGenBuffers(2, buffers_);
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, buffers_[0]);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh.vertices.size() * sizeof(FloorMesh::Vertex)),
               mesh.vertices.data(), GL_STATIC_DRAW);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers_[1]);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh.indices.size() * sizeof(std::uint32_t)),
               mesh.indices.data(), GL_STATIC_DRAW);
  for (GLuint i = 0; i < 2; ++i) {
    glEnableVertexAttribArray(i);
    glVertexAttribPointer(
        i, 3, GL_FLOAT, GL_FALSE, sizeof(FloorMesh::Vertex),
        reinterpret_cast<const void*>(
            i * offsetof(FloorMesh::Vertex,
                         normal)));  // NOLINT(performance-no-int-to-ptr): OpenGL's own way to give an offset
  }
}

SeaFloor::~SeaFloor() {
  glDeleteVertexArrays(1, &array_);
  glDeleteBuffers(2, buffers_);
  glDeleteProgram(program_);
}

void SeaFloor::draw(GLuint sun_map) const {
  glUseProgram(program_);
  glActiveTexture(GL_TEXTURE0);  // where a sampler looks that was told nothing else
  glBindTexture(GL_TEXTURE_2D, sun_map);
  glBindVertexArray(array_);
  glDrawElements(GL_TRIANGLES, indices_, GL_UNSIGNED_INT, nullptr);
}

}  // namespace underwater
