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
  // Bytes of GPU memory for voxels: taken at once, in create(), and never more; at least 256 KiB. Where less is needed for a whole scene, what is
  // worth the fewest pixels is drawn coarser. At most what one texture array of the context holds, which is 1 GiB or more.
  std::uint64_t gpu_budget = std::uint64_t{256} << 20;
  State state = State::kRestore;
  // GLSL text that defines `vec4 kelpSurface(KelpSurface s)`, the colour of a hit; null: sun and sky (shaders/surface.glsl, which also
  // documents KelpSurface). Compiled once, in create(); kGraphics, and the compiler's words to `log`, if it does not compile.
  const char* surface_glsl = nullptr;
  // Whether kelp's own look may cast rays, for View::self_shadow and View::occlusion_rays. A larger program, also while a view asks for neither:
  // Mesa's llvmpipe, which runs the branches that it does not take, then takes 1.2 times as long for a frame.
  bool secondary_rays = false;
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

// The range of z / w in clip space, between the near and the far plane or, with a reversed depth, the far and the near one.
enum class ClipRange : std::uint8_t {
  kMinusOneToOne,  // OpenGL's own
  kZeroToOne,      // glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE), which the host has set
};

// Texture units below are kelp's while it draws.
inline constexpr int kFirstHostUnit = 4;

// The camera and the light. Eye space looks down -z.
struct View {
  glm::mat4 world_to_eye{1};
  glm::mat4 eye_to_clip{1};      // perspective or orthographic; its far plane may be at infinity
  glm::ivec2 viewport{0};        // pixels: size of the current viewport, at least 1 x 1
  ClipRange clip_range = ClipRange::kMinusOneToOne;
  bool reversed_depth = false;   // the near plane is at the range's upper end: kelp tests with GL_GEQUAL instead of GL_LEQUAL
  // A texture (GL_TEXTURE_2D, a depth format or GL_R32F; not attached to the framebuffer drawn to) with the depth of the scene so far, texel
  // (x, y) for the framebuffer's pixel (x, y): rays end there, which spares what would be hidden. Saves time, or does for a depth test where
  // no depth buffer is bound. 0: none.
  std::uint32_t scene_depth = 0;
  // 1 .. 16: the instances are drawn near to far in so many draws, and before each the depth drawn so far is copied, so that rays end there: it
  // spares what nearer instances, and the host's triangles, hide. The picture is the same. Worth it where three or more overlap on most pixels (then 8
  // is a good number), a loss where hardly any do: each copy costs as much as the framebuffer has pixels. 1 copies nothing. Without effect where scene_depth is
  // given, and where the framebuffer has no depth or is multisampled.
  int depth_batches = 1;
  // World to clip in the frame before, for KelpSurface::previous_clip (motion vectors); null: there are none. Good during the call.
  const glm::mat4* previous_world_to_clip = nullptr;
  glm::vec3 sun_direction{0.4f, 0.8f, 0.45f};  // towards the sun, world; any length > 0
  // Linear. The defaults sum to white for a white surface in full light, so that a host without tone mapping sees no clipping.
  glm::vec3 sun_color{2.1f, 2.02f, 1.9f};
  glm::vec3 sky_color{0.32f, 0.35f, 0.41f};     // light from above
  glm::vec3 ground_color{0.13f, 0.12f, 0.11f};  // light from below
  // Rays through the same part of the same instance, which start less than two voxels off the surface; in fog, from every voxel on the way. kMisuse without Config::secondary_rays, but
  // for a surface_glsl, which may call kelpVisible. Whether the sun's light is kept off:
  bool self_shadow = false;
  int occlusion_rays = 0;        // 0 .. 16 cosine-weighted rays a pixel, for how much of the sky it sees; 0: all of it
  float occlusion_reach = 0.25f;  // of those, in lengths of the part's longest side, > 0. What they hit counts the less the farther it is
  Shading shading = Shading::kGradient;
  int finest_level = 0;          // no finer level is drawn, as runtime::raycast's `level`
  // Levels are chosen so that a voxel covers about this many pixels where a part is nearest; 0: always the finest. Between two levels some of
  // the pixels draw the one and some the other, so that none is seen to switch.
  float pixels_per_voxel = 1.0f;
  // Called by draw() just before it draws, with its program in use, for what surface_glsl has of its own: glUniform*, textures and samplers on
  // the units from kFirstHostUnit on, uniform buffers. Changing any other state there is not allowed, but for the active unit; what is bound
  // there stays bound. In every pass but kFog: samplers of two kinds must not be left on one unit. Null: nobody is.
  void (*bind)(void* user, std::uint32_t program) = nullptr;
  void* bind_user = nullptr;
  float smallest_pixels = 0.5f;  // parts whose largest side covers less are left out
};

enum class Pass : std::uint8_t {
  kColour,  // colour and depth of solid parts
  kDepth,   // depth only, for shadow maps and pre-passes
  // Fog parts, which the other passes leave out: blended, premultiplied, into draw buffer 0 alone, over what is there. After everything that is opaque,
  // the host's own included. Rays end at the scene's depth: View::scene_depth or, without, a copy of the depth buffer, made by this call. Where that can not be had
  // (no depth, or multisampled) fog is hidden where it begins behind what is there, and else drawn to its end. No depth is written. Parts that overlap are
  // blended one over the other, the one whose bounds begin farther from the eye first, the later in the list of those around it. In OpenGL ES 3.0 and 3.1, which can not mask
  // draw buffers one by one, bind a framebuffer with one.
  kFog,
};

struct Stats {
  std::uint32_t instances = 0;      // parts of instances drawn
  std::uint32_t culled = 0;
  std::uint32_t draws = 0;           // 0, 1 or, with View::depth_batches, that many
  std::uint64_t bytes_uploaded = 0;  // by this call
  std::uint64_t gpu_bytes = 0;       // of assets' textures, held now
  // Grids and pages that are wanted, would fit, and are not yet on the GPU: 0 when the last draws' pictures are as fine as they get.
  std::uint32_t pending = 0;
};

// Owns GL objects of the context that was current in create(). Destroy it while that context is current, or call abandon() first.
class Renderer {
 public:
  // kGraphics: no context is current, its version is below GL 3.3 / ES 3.0, a function is missing, or a shader does not compile.
  static Result<std::unique_ptr<Renderer>> create(const Config& config);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  // Makes an asset known, which should outlive the renderer or be removed first. Adding twice is kMisuse. kLimit: the coarsest levels of what
  // was added before leave no room in gpu_budget. kGraphics: the asset has fog, whose programs, compiled for the first such asset, are refused.
  Result<void> add(const runtime::Asset& asset);
  void remove(const runtime::Asset& asset);

  // Once a frame: uploads at most `max_bytes` (0, or 4096 and more) of what the draws since the last upload() lacked, the voxels that cover
  // the most pixels first, and asks the assets for what is not in memory, so that their pump() reads it. What was not drawn for longest, or
  // is worth fewer pixels, makes room. Large grids and pages take several frames. kLimit: the coarsest levels of all assets do not fit into
  // gpu_budget; what does is drawn. Before the first draw everything is wanted: a loading screen calls until `pending` is 0.
  // What the allocator has no memory to keep account of is tried again at the next upload().
  Result<Stats> upload(std::uint64_t max_bytes);

  // Draws into the current framebuffer and viewport with depth writes and the depth test GL_LEQUAL (GL_GEQUAL), so that Pass::kColour after Pass::kDepth
  // gives the same picture. Clear values, scissor, stencil and the colour mask (but in Pass::kDepth) are the host's own. Instances whose
  // asset's coarsest level is not uploaded yet are left out; poses that are not monotone or not finite, unknown or destroyed assets, singular transforms and a
  // viewport without pixels (leave out the frames of a minimised window) are kMisuse and nothing is drawn.
  // Colour is linear: enable GL_FRAMEBUFFER_SRGB, or encode in surface_glsl.
  Result<Stats> draw(const View& view, std::span<const runtime::Instance> instances, Pass pass = Pass::kColour);

  // GLSL for a host's own vertex or fragment shader, in the context's dialect: kelpTrace(origin, direction, t_max), a ray through posed instances
  // in world space, and what goes with it (shaders/scene.glsl). Strings for glShaderSource, after the host's #version and #extension lines and
  // before the rest of its text. Good while the renderer lives. A text that has `#define KELP_HOST_SURFACE` before it defines kelpSurface itself, if it wants one.
  std::span<const char* const> traceGlsl() const;

  // Binds what that text needs to a linked program of the host's: its uniforms, texture units first_unit and the next, and the samplers there. The
  // units stay bound: that is what they are for; the rest of the state is as in draw(). Good until the next bindTrace(), upload(), or end of the
  // frame. The instances are those that rays may meet, wherever they are; `view` chooses levels (as if each were seen, without the pattern of
  // pixels), shading and light, and its matrices nothing else. kMisuse as draw(), and for units that the context has not. A shader's rays cost
  // in proportion to Stats::instances, the parts they may meet.
  Result<Stats> bindTrace(std::uint32_t program, const View& view, std::span<const runtime::Instance> instances, int first_unit = kFirstHostUnit);

  // Forgets all GL objects without touching them: after the context was lost. From then on everything but the destructor is kMisuse.
  void abandon();

 private:
  struct Impl;
  explicit Renderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// Bytes of gpu_budget that all of the asset takes whose grids have been loaded (Asset::pump); all of it after Asset::loadAll. On top a renderer
// needs 4 KiB, and 4 MiB to the next multiple of 4 MiB from there on.
std::uint64_t poolBytes(const runtime::Asset& asset);

// The level of a part of the instance that draw() wants at a pixel of the framebuffer (it draws a coarser one while that is not uploaded): for
// runtime::raycast of what is seen. -1 for a view, an instance or a part that can not be drawn.
int levelAt(const View& view, const runtime::Instance& instance, int part, const glm::ivec2& pixel);

}  // namespace kelp::gl
