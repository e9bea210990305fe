// SPDX-License-Identifier: MIT
#include "scenery.h"

#include <cstddef>
#include <cstdio>
#include <initializer_list>

#include <glm/gtc/matrix_transform.hpp>

#include "terrain.h"

namespace underwater {
namespace {

// A program of water.glsl and the two texts. On failure it prints the compiler's message and returns 0.
GLuint makeProgram(const char* name, const char* vertex, const char* fragment) {
  const GLuint program = glCreateProgram();
  char words[1024] = "";
  for (const GLenum kind : {GL_VERTEX_SHADER, GL_FRAGMENT_SHADER}) {
    const char* const text[] = {"#version 330 core\n", glsl::kWater,
                                kind == GL_VERTEX_SHADER ? vertex : fragment};
    const GLuint shader = glCreateShader(kind);
    glShaderSource(shader, 3, text, nullptr);
    glCompileShader(shader);
    GLint good = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
    if (!good) glGetShaderInfoLog(shader, sizeof words, nullptr, words);
    glAttachShader(program, shader);
    glDeleteShader(shader);  // as soon as the program is
  }
  glLinkProgram(program);
  GLint good = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &good);
  if (good) return program;
  if (!words[0]) glGetProgramInfoLog(program, sizeof words, nullptr, words);
  std::fprintf(stderr, "underwater: the shaders of the %s do not compile: %s\n", name, words);
  glDeleteProgram(program);
  return 0;
}

}  // namespace

Water::Water() : background_(makeProgram("background", glsl::kBackgroundVertex, glsl::kBackgroundFragment)) {
  glGenBuffers(1, &block_);
  glBindBuffer(GL_UNIFORM_BUFFER, block_);
  glBufferData(GL_UNIFORM_BUFFER, sizeof(WaterBlock), nullptr, GL_DYNAMIC_DRAW);
  glGenVertexArrays(1, &no_vertices_);
}

Water::~Water() {
  glDeleteVertexArrays(1, &no_vertices_);
  glDeleteBuffers(1, &block_);
  glDeleteProgram(background_);
}

void Water::set(const WaterBlock& block) const {
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, block_);
  glBufferSubData(GL_UNIFORM_BUFFER, 0, sizeof block, &block);
}

void Water::drawBackground() const {
  glUseProgram(background_);
  glBindVertexArray(no_vertices_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

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

SunMap::SunMap(int size) : size_(size) {
  glGenTextures(1, &texture_);
  glBindTexture(GL_TEXTURE_2D, texture_);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, size, size, 0, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT,
               nullptr);
  for (const GLenum side : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTexParameteri(GL_TEXTURE_2D, side, GL_CLAMP_TO_BORDER);
  const float lit[] = {1, 1, 1, 1};
  glTexParameterfv(GL_TEXTURE_2D, GL_TEXTURE_BORDER_COLOR, lit);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glGenFramebuffers(1, &framebuffer_);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, texture_, 0);
  glDrawBuffer(GL_NONE);
  glReadBuffer(GL_NONE);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

SunMap::~SunMap() {
  glDeleteFramebuffers(1, &framebuffer_);
  glDeleteTextures(1, &texture_);
}

void SunMap::begin() const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glViewport(0, 0, size_, size_);
  glClear(GL_DEPTH_BUFFER_BIT);
}

glm::mat4 SunMap::worldToSun(const glm::vec3& sun) {
  return glm::lookAt(20.0f * sun, glm::vec3(0), glm::vec3(0, 0, 1));
}

glm::mat4 SunMap::sunToClip(float radius, float height) {
  return glm::ortho(-radius, radius, -radius, radius, 20 - radius - height, 20 + radius);
}

}  // namespace underwater
