// SPDX-License-Identifier: MIT
// Draws instances of packs with OpenGL 3.3 core or OpenGL ES 3.0, into the framebuffer that the host has
// bound. Use everything here only on the thread that has the context current.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include <glm/mat4x4.hpp>

#include "kelp/runtime/instance.h"

namespace kelp::gl {

// How a call leaves the GL state that it changes.
enum class State : std::uint8_t {
  kRestore,  // every call leaves the state as it found it
  kLeave,    // nothing is restored; runtime/HOST_GUIDE.md lists what kelp changes
};

// Abilities beyond drawing. Each costs memory or time even in frames that do not use it.
enum class Features : std::uint8_t {
  kNone = 0,
  // Rays cast from what is seen: Quality::self_shadow, Quality::occlusion_rays. The program is then larger:
  // on Mesa's llvmpipe, which also runs branches that are not taken, a frame takes 1.2 times as long.
  kSecondaryRays = 1,
  // Distances on the GPU: Quality::soft_shadows, Quality::occlusion, and kelpDistance in shaders. They come
  // from assets that load them (runtime::AssetOptions::distance_level), and take part of gpu_budget.
  kDistances = 2,
  // No Shading but kGradient. The program compiles sooner: with SwiftShader, which browsers draw with where
  // there is no graphics card, in two thirds of the time.
  kGradientOnly = 4,
};
constexpr Features operator|(Features a, Features b) {
  return static_cast<Features>(static_cast<std::uint8_t>(a) | static_cast<std::uint8_t>(b));
}
constexpr bool has(Features set, Features feature) {
  return (static_cast<std::uint8_t>(set) & static_cast<std::uint8_t>(feature)) != 0;
}

struct RendererOptions {
  // Returns the address of a GL function, as glfwGetProcAddress or eglGetProcAddress do. Called during
  // create() only.
  void* (*getProcAddress)(void* user, const char* name) = nullptr;
  void* user = nullptr;
  // Bytes of GPU memory for voxels, at least 256 KiB. create() allocates them all; nothing more is allocated
  // for voxels later. If the scene needs more, the parts worth the fewest pixels are drawn coarser. The
  // maximum is what one texture array of the context holds, which is 1 GiB or more.
  std::uint64_t gpu_budget = std::uint64_t{256} << 20;
  State state = State::kRestore;
  // GLSL text that defines `vec4 kelpSurface(KelpSurface s)`, the color of a hit. shaders/surface.glsl
  // documents KelpSurface. Null: sun and sky. Compiled in create(), and once more in add() for the first
  // asset with swept parts. If it does not compile, create() returns kGraphics and `log` gets the compiler's
  // message.
  const char* surface_glsl = nullptr;
  Features features = Features::kNone;  // a set: Features::kSecondaryRays | Features::kDistances
  // Gets the messages of the GLSL compiler or linker when they make create() or add() fail
  // (runtime/HOST_GUIDE.md explains STRING:LINE in them), and once for each asset why an instance of it was
  // left out (Stats::left_out), or that pump() or upload() was never called (Stats::waiting). `text` is valid
  // during the call only. Null: no callback.
  void (*log)(void* user, const char* text) = nullptr;
  Allocator allocator = {};
};

// Where the normal and the material of a hit come from. The difference shows where voxels are larger than
// pixels. The shape, the depth and runtime::raycast are the same in all three.
enum class Shading : std::uint8_t {
  // The paper's: the normal stored with the voxel, from the gradient of the field that it was baked from. One
  // for the whole voxel.
  kGradient,
  // The normal of the face of the voxel's cube that is seen: crisp blocks.
  kFaces,
  // Normals and materials blended between the surface voxels around the hit, so that single voxels do not
  // show. The slowest: reads up to 27 voxels at a hit, none on the way to it.
  kSmooth,
};

// The range of z / w in clip space, from the near to the far plane, or with a reversed depth from the far to
// the near plane.
enum class ClipRange : std::uint8_t {
  kMinusOneToOne,  // OpenGL's default
  kZeroToOne,      // the host has called glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE)
};

// kelp uses the texture units below this one while it draws.
inline constexpr int kFirstHostUnit = 4;

// Where the eye is, and what it draws into. Eye space looks down -z.
struct Camera {
  glm::mat4 world_to_eye{1};
  glm::mat4 eye_to_clip{1};  // perspective or orthographic; the far plane may be at infinity
  // Size of the current viewport in pixels. Without pixels, as in a minimized window, nothing is drawn; the
  // log is told so once.
  glm::ivec2 viewport{0};
  ClipRange clip_range = ClipRange::kMinusOneToOne;
  // The near plane is at the upper end of the range: kelp tests with GL_GEQUAL instead of GL_LEQUAL.
  bool reversed_depth = false;
  // World to clip space in the frame before, for KelpSurface::previous_clip (motion vectors). Must be valid
  // during the call. Null: no motion vectors.
  const glm::mat4* previous_world_to_clip = nullptr;
};

// Colors are linear. With the defaults a white surface in full light is white, so that nothing clips without
// tone mapping.
struct Light {
  glm::vec3 sun_direction{0.4f, 0.8f, 0.45f};  // towards the sun, world; any length > 0
  glm::vec3 sun_color{2.1f, 2.02f, 1.9f};
  glm::vec3 sky_color{0.32f, 0.35f, 0.41f};     // light from above
  glm::vec3 ground_color{0.13f, 0.12f, 0.11f};  // light from below
};

// Limits on the cost of a picture.
struct Quality {
  Shading shading = Shading::kGradient;  // others: kMisuse with Features::kGradientOnly
  int finest_level = 0;                  // no finer level is drawn; as `level` of runtime::raycast
  // Levels are chosen so that a voxel covers about this many pixels where a part is nearest. 0: always the
  // finest level. Between two levels some pixels draw the one and some the other, so that no switch is seen.
  float pixels_per_voxel = 1.0f;
  float smallest_pixels = 0.5f;  // parts whose largest side covers fewer pixels are not drawn
  // Secondary rays stay in the same part of the same instance. They start less than two voxels off the
  // surface; in fog, at every voxel on the way. kMisuse without Features::kSecondaryRays, except with a
  // surface_glsl, which may call kelpVisible. Whether voxels keep the sun's light off others:
  bool self_shadow = false;
  // 0 .. 16 cosine-weighted rays for each pixel, which measure how much of the sky it sees. 0: all of it.
  int occlusion_rays = 0;
  // Length of those rays, in lengths of the part's longest side, > 0. A hit counts less the farther away it
  // is.
  float occlusion_reach = 0.25f;
  // Light past all solid parts of the instance, by distances; kMisuse without Features::kDistances. The sun's
  // shadow, with a penumbra: the angle in degrees, 0 .. 20, across the sun (the real one: 0.53). 0: no
  // shadow. Takes the place of self_shadow. Slower where an asset loads no distances.
  float soft_shadows = 0;
  // How much of the sky a pixel sees, within occlusion_reach. Takes the place of occlusion_rays. A part whose
  // asset loads no distances, or whose distances are not uploaded yet, hides nothing.
  bool occlusion = false;
  // 1 .. 16. More than 1: the instances are drawn near to far in so many draws. Before each, the depth drawn
  // so far is copied, and rays end there, so that nothing hidden is traced. The picture is the same. It gains
  // where three or more instances overlap on most pixels (8 is a good number then) and loses where hardly any
  // do: each copy costs as much as the framebuffer has pixels. No effect with scene_depth, without a depth
  // buffer, and with a multisampled one.
  int depth_batches = 1;
};

// The encoding of the colors that draw() writes.
enum class Output : std::uint8_t {
  // Linear light, for a framebuffer that encodes (GL_FRAMEBUFFER_SRGB on an sRGB framebuffer) or is
  // tone-mapped later. On a framebuffer that does neither, the picture is too dark.
  kLinear,
  // For the screen: tone-mapped, so that bright light does not clip, and encoded as sRGB. For targets that
  // encode nothing: a canvas in a browser, many windows of SDL. Fog is then blended in encoded colors, which
  // is not quite right.
  kDisplay,
};

// A picture to draw. The common case:
//
//   gl::View view;
//   view.camera = {world_to_eye, eye_to_clip, {width, height}};
//   renderer->draw(view, instances);
struct View {
  Camera camera = {};
  Light light = {};
  Quality quality = {};
  Output output = Output::kLinear;
  // A texture with the depth of the scene so far: GL_TEXTURE_2D, a depth format or GL_R32F, not attached to
  // the framebuffer drawn to; texel (x, y) belongs to the framebuffer's pixel (x, y). Rays end there, which
  // saves time, and replaces the depth test where no depth buffer is bound. 0: none.
  std::uint32_t scene_depth = 0;
  // Called by draw() just before it draws, with its program in use, in every pass except kFog; twice, with
  // two programs, if there are sheared parts and swept ones to draw. Sets what surface_glsl needs:
  // glUniform*, textures and samplers on units from kFirstHostUnit on, uniform buffers. These bindings stay.
  // It may change the active unit, and no other state. Don't leave samplers of different types on one unit.
  // Null: no callback.
  void (*bind)(void* user, std::uint32_t program) = nullptr;
  void* bind_user = nullptr;
};

enum class Pass : std::uint8_t {
  kColor,  // color and depth of solid parts
  kDepth,  // depth only, for shadow maps and pre-passes
  // Fog parts, which the other passes leave out. Call it after everything opaque, the host's own included.
  // Blends premultiplied color into draw buffer 0 only; writes no depth. Rays end at the scene's depth:
  // View::scene_depth, or else a copy of the depth buffer, made by this call. Without either (no depth
  // buffer, or a multisampled one) fog is hidden only where it begins behind the scene. Parts that overlap
  // are blended in order: the one whose bounds begin farther from the eye first; of those around the eye, the
  // later in the list. OpenGL ES 3.0 and 3.1 cannot mask single draw buffers, so bind a framebuffer with one.
  kFog,
};

struct Stats {
  std::uint32_t instances = 0;  // parts of instances that were drawn
  // Parts that were culled: out of view, or covering fewer pixels than Quality::smallest_pixels. The latter:
  std::uint32_t culled = 0, too_small = 0;
  // Parts that are in view and not drawn, because nothing of them is on the GPU yet. If it stays above 0,
  // call Asset::pump() and upload(); RendererOptions::log says which was never called.
  std::uint32_t waiting = 0;
  // Instances without a part of the kind that this pass draws: fog in kFog, solids in the others.
  std::uint32_t other_kind = 0;
  // Instances that were left out because they cannot be drawn: a pose that turns back (swept: that folds)
  // or is not finite, a motion of a part that is not finite, or a to_world that is not an invertible affine
  // matrix. The others are drawn.
  std::uint32_t left_out = 0;
  // Why the first of them was; `offset` is its index in the list that was given.
  Error first_left_out;
  std::uint32_t clamped = 0;  // instances whose pose was clamped (runtime::Instance::unsound)
  // Calls of OpenGL. Solids: one for sheared parts and one for swept ones (with Features::kDistances one for
  // both), or that times Quality::depth_batches at most. Fog: one for each run of parts that bend alike.
  std::uint32_t draws = 0;
  std::uint64_t bytes_uploaded = 0;  // by this call
  std::uint64_t gpu_bytes = 0;       // of assets' textures, held now
  // Grids and pages that are wanted, would fit, and are not yet on the GPU; before the first upload(), all
  // levels of the assets. 0: the last draws' pictures are as fine as they get.
  std::uint32_t pending = 0;
};

// Owns GL objects of the context that was current in create(). While another one is current, or
// none, as on another thread, add(), upload(), draw() and bindTrace() are kMisuse and do nothing, and the
// destructor leaves the objects to their context. Destroy the renderer while its context is current, or call
// abandon() first. (The context is asked for by eglGetCurrentContext, or that of GLX, WGL or CGL, where
// getProcAddress knows it.)
class Renderer {
 public:
  // kGraphics: no context is current, its version is below OpenGL 3.3 or ES 3.0, a function is missing, or a
  // shader does not compile.
  static Result<std::unique_ptr<Renderer>> create(const RendererOptions& options);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  // Registers an asset. It must outlive the renderer, or be removed first. kMisuse: it was added before.
  // kLimit: the coarsest levels of the assets added before leave no room in gpu_budget. kGraphics: the asset
  // has fog, and its programs, which the first such asset compiles, are refused.
  Result<void> add(const runtime::Asset& asset);
  void remove(const runtime::Asset& asset);

  // Call it once a frame. Uploads at most `max_bytes` (0, or 4096 and more) of what the draws since the last
  // upload() lacked, the voxels that cover the most pixels first. Requests from the assets what is not in
  // memory, so that their pump() reads it. If there is no room, what was not drawn for longest, or is worth
  // fewer pixels, is dropped. Large grids and pages take several frames. Before the first draw everything is
  // wanted: a loading screen calls upload() until `pending` is 0. If the allocator fails, the upload is tried
  // again in the next call. kLimit: the coarsest levels of all assets do not fit into gpu_budget; those that
  // do are drawn.
  Result<Stats> upload(std::uint64_t max_bytes);

  // Draws into the current framebuffer and viewport, with depth writes and the depth test GL_LEQUAL
  // (GL_GEQUAL), so that Pass::kColor after Pass::kDepth gives the same picture. The clear values, the
  // scissor, the stencil and the color mask (except in Pass::kDepth) are the host's. Color is linear, and
  // looks too dark where nothing encodes it: see View::output. Instances whose asset's coarsest level is not
  // uploaded yet are not drawn yet. Instances that cannot be drawn are left out: Stats::left_out. kMisuse,
  // and nothing is drawn: an asset that is unknown or was destroyed, a pose or a palette of another asset
  // (`offset` is the index of the instance), a view that is not sound, a framebuffer that is not complete.
  Result<Stats> draw(const View& view, runtime::Instances instances, Pass pass = Pass::kColor);

  // GLSL for a host's own vertex or fragment shader, in the context's dialect: kelpTrace(origin, direction,
  // t_max), a ray through posed instances in world space, and related functions (shaders/scene.glsl). Strings
  // for glShaderSource, to be placed after the host's #version and #extension lines and before the rest of
  // its text. Valid while the renderer lives. With `#define KELP_HOST_SURFACE` before them kelp's own
  // kelpSurface is left out, and the host may define one.
  std::span<const char* const> traceGlsl() const;

  // Binds what traceGlsl() needs to a linked program of the host's: its uniforms, texture units first_unit
  // and the next, and their samplers. Those units stay bound in both State modes; all other state is as in
  // draw(). Valid until the next bindTrace(), upload(), or end of the frame. `instances`: those that rays may
  // hit, wherever they are. `view` chooses the levels (as if each instance were seen, without the pattern of
  // pixels), the shading and the light; its matrices are used for the levels only. A ray's cost is
  // proportional to Stats::instances, the parts that it may hit. kMisuse: as draw(), and for units that the
  // context does not have.
  Result<Stats> bindTrace(std::uint32_t program, const View& view, runtime::Instances instances,
                          int first_unit = kFirstHostUnit);

  // Forgets all GL objects without touching them: call it after the context was lost. From then on every call
  // except the destructor is kMisuse.
  void abandon();

  // kMisuse: the destructor would leave GL objects behind, because the renderer's context is not current and
  // the renderer was not abandoned.
  Result<void> checkDestroy() const;

 private:
  struct Impl;
  explicit Renderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// Bytes of gpu_budget that the asset takes, as far as its grids have been loaded (Asset::pump): all of it
// after Asset::loadAll. A renderer needs 4 KiB more; from 4 MiB on, round the sum up to a multiple of 4 MiB.
// features: those of the renderer; only kDistances matters.
std::uint64_t poolBytes(const runtime::Asset& asset, Features features = Features::kNone);

// The level of a part of the instance that draw() wants at a pixel of the framebuffer, for a runtime::raycast
// that meets what is seen. (draw() draws a coarser level until that one is uploaded. It bends swept parts by
// fewer arcs at coarser levels, which moves them by at most half a voxel of that level.) nullopt: a view, an
// instance or a part that cannot be drawn.
std::optional<int> levelAt(const View& view, const runtime::Instance& instance, int part,
                           const glm::ivec2& pixel);

}  // namespace kelp::gl
