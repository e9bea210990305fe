// SPDX-License-Identifier: MIT
// Draws instances of packs with OpenGL 3.3 core or OpenGL ES 3.0, into whatever framebuffer the host has bound.
// Everything here belongs to the thread that has the context current.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include <glm/mat4x4.hpp>

#include "kelp/runtime/instance.h"

namespace kelp::gl {

// What happens to the GL state a call touches.
enum class State : std::uint8_t {
  kRestore,  // every call leaves the state as it found it
  kLeave,    // the host sets all state it needs itself; what kelp changes is listed in runtime/gl/README.md
};

struct Config {
  // Address of a GL function, as glfwGetProcAddress or eglGetProcAddress answer it. Called during create() only.
  void* (*getProcAddress)(void* user, const char* name) = nullptr;
  void* user = nullptr;
  std::uint64_t gpu_budget = std::uint64_t{1} << 30;  // bytes of textures; upload() answers kLimit rather than exceed it
  State state = State::kRestore;
  // GLSL text that defines `vec4 kelpSurface(KelpSurface s)`, the colour of a hit; null: sun and sky (shaders/surface.glsl, which also
  // documents KelpSurface). Compiled once, in create(); kGraphics, and the compiler's words to `log`, if it does not compile.
  const char* surface_glsl = nullptr;
  // Told what the GLSL compiler or the linker said, when create() fails because of it; null: nobody is. STRING:LINE in it are explained in
  // runtime/gl/README.md. The text is good during the call only.
  void (*log)(void* user, const char* text) = nullptr;
  Allocator allocator;
};

// Where the normal and the material of a hit come from. It shows where voxels are larger than pixels; the shape, the depth and
// runtime::raycast are the same in all three.
enum class Shading : std::uint8_t {
  kGradient,  // the paper's: the normal stored with the voxel, from the gradient of the field it was baked from; one for the whole voxel
  kFaces,     // the face of the voxel's cube that is seen: crisp blocks
  kSmooth,    // normals and materials blended between the surface voxels around the hit: no voxel is told from the next. The dearest: up to
              // 27 voxels are read at a hit, none on the way to it
};

// The camera and the light. GL conventions: eye space looks down -z, clip space -w..w.
struct View {
  glm::mat4 world_to_eye{1};
  glm::mat4 eye_to_clip{1};      // perspective or orthographic
  glm::ivec2 viewport{0};        // pixels: size of the current viewport, at least 1 x 1
  glm::vec3 sun_direction{0.4f, 0.8f, 0.45f};  // towards the sun, world; any length > 0
  // Linear. The defaults sum to white for a white surface in full light, so that a host without tone mapping sees no clipping.
  glm::vec3 sun_color{2.1f, 2.02f, 1.9f};
  glm::vec3 sky_color{0.32f, 0.35f, 0.41f};     // light from above
  glm::vec3 ground_color{0.13f, 0.12f, 0.11f};  // light from below
  Shading shading = Shading::kGradient;
  int finest_level = 0;          // no finer level is drawn, as runtime::raycast's `level`
  float pixels_per_voxel = 1.0f;  // a coarser level is drawn where finer voxels would be smaller than this many pixels; 0: always the finest
};

enum class Pass : std::uint8_t {
  kColour,  // colour and depth
  kDepth,   // depth only, for shadow maps and pre-passes
};

struct Stats {
  std::uint32_t instances = 0;      // parts of instances drawn
  std::uint32_t culled = 0;
  std::uint32_t draws = 0;
  std::uint64_t bytes_uploaded = 0;  // by this call
  std::uint64_t gpu_bytes = 0;       // of assets' textures, held now
  std::uint32_t pending = 0;         // levels that are resident in memory and not yet on the GPU
};

// Owns GL objects of the context that was current in create(). Destroy it while that context is current, or call abandon() first.
class Renderer {
 public:
  // kGraphics: no context is current, its version is below GL 3.3 / ES 3.0, a function is missing, or a shader does not compile.
  static Result<std::unique_ptr<Renderer>> create(const Config& config);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  // Makes an asset known; it must outlive the renderer or be removed first. Adding twice is kMisuse.
  Result<void> add(const runtime::Asset& asset);
  void remove(const runtime::Asset& asset);

  // Uploads resident levels of known assets, coarse to fine, at least one and no more than about `max_bytes`. A level that can not go to the
  // GPU is left out, and its part drawn coarser; the rest goes on. kLimit: over gpu_budget (answered every time, until there is room), or too
  // large for this context's textures (answered once). kOutOfMemory, kGraphics: OpenGL refused (answered once).
  Result<Stats> upload(std::uint64_t max_bytes);

  // Draws into the current framebuffer and viewport with depth writes and the depth test GL_LEQUAL, so that Pass::kColour after Pass::kDepth
  // gives the same picture. Clear values, scissor, stencil and the colour mask (but in Pass::kDepth) are the host's own. Instances whose
  // asset has nothing uploaded yet are left out; poses that are not monotone or not finite, unknown assets, singular transforms and a
  // viewport without pixels (leave out the frames of a minimised window) are kMisuse and nothing is drawn.
  // Colour is linear: enable GL_FRAMEBUFFER_SRGB, or encode in surface_glsl.
  Result<Stats> draw(const View& view, std::span<const runtime::Instance> instances, Pass pass = Pass::kColour);

  // Forgets all GL objects without touching them: after the context was lost. From then on everything but the destructor is kMisuse.
  void abandon();

 private:
  struct Impl;
  explicit Renderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace kelp::gl
