// SPDX-License-Identifier: MIT
// The OpenGL of the host: the water, the sea floor, the sun's shadow map. Their objects need the context of
// their creation, also when they go.
#pragma once

#include <glm/glm.hpp>

#define GL_GLEXT_PROTOTYPES
#define GLFW_INCLUDE_GLCOREARB
#include <GLFW/glfw3.h>

// The .glsl, .vert and .frag files of this folder as text, embedded when kelp is built.
namespace underwater::glsl {
extern const char* const kWater;
extern const char* const kVoxels;
extern const char* const kBackgroundVertex;
extern const char* const kBackgroundFragment;
extern const char* const kFloorVertex;
extern const char* const kFloorFragment;
}  // namespace underwater::glsl

namespace underwater {

// As `Water` in water.glsl, std140.
struct WaterBlock {
  glm::mat4 world_to_clip{1};
  glm::mat4 clip_to_world{1};
  glm::mat4 world_to_sun{1};  // to the shadow map, 0 .. 1
  glm::vec4 eye{0};           // w: seconds
  glm::vec4 sun{0, 1, 0, 0};  // towards it, unit; w: height of the surface, meters
};
static_assert(sizeof(WaterBlock) == 3 * 64 + 2 * 16);

// Draws the background, and gives all programs their uniform block.
class Water {
 public:
  Water();
  ~Water();
  Water(const Water&) = delete;
  Water& operator=(const Water&) = delete;

  bool good() const { return background_ != 0; }
  // Binds the block to binding point 0. That is where a block is taken from whose program says nothing else:
  // also kelp's program with a surface_glsl that declares it.
  void set(const WaterBlock& block) const;
  void drawBackground() const;  // behind everything: wants the depth test LEQUAL

 private:
  GLuint block_ = 0, background_ = 0, no_vertices_ = 0;
};

// The sand, drawn as ordinary triangles.
class SeaFloor {
 public:
  explicit SeaFloor(float radius);
  ~SeaFloor();
  SeaFloor(const SeaFloor&) = delete;
  SeaFloor& operator=(const SeaFloor&) = delete;

  bool good() const { return program_ != 0; }
  void draw(GLuint sun_map) const;  // a depth texture that compares, as SunMap's

 private:
  GLuint program_ = 0, array_ = 0, buffers_[2] = {};
  GLsizei indices_ = 0;
};

// A depth texture that the scene is drawn into from the sun, for shadows on the sand and on plants.
class SunMap {
 public:
  explicit SunMap(int size);  // pixels on a side
  ~SunMap();
  SunMap(const SunMap&) = delete;
  SunMap& operator=(const SunMap&) = delete;

  void begin() const;  // binds and clears it, with its viewport
  GLuint texture() const { return texture_; }
  int size() const { return size_; }

  // The sun's camera: all that grows within `radius` meters of the origin and up to `height`.
  static glm::mat4 worldToSun(const glm::vec3& sun);
  static glm::mat4 sunToClip(float radius, float height);

 private:
  int size_;
  GLuint texture_ = 0, framebuffer_ = 0;
};

}  // namespace underwater
