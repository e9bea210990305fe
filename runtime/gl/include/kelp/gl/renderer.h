// SPDX-License-Identifier: MIT
// Draws instances of packs with OpenGL 3.3 core or OpenGL ES 3.0, into the framebuffer that the host has
// bound. Use everything here only on the thread that has the context current.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "kelp/draw/planner.h"

namespace kelp::gl {

// How a call leaves the GL state that it changes.
enum class State : std::uint8_t {
  kRestore,  // every call leaves the state as it found it
  kLeave,    // nothing is restored; runtime/HOST_GUIDE.md lists what kelp changes
};

// These are the same for every graphics API: kelp/draw/view.h.
using draw::Camera, draw::ClipRange, draw::DebugView, draw::Features, draw::Light, draw::Log, draw::Output,
    draw::Pass, draw::Quality, draw::Shading, draw::Stats, draw::has, draw::operator|;

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

// kelp uses the texture units below this one while it draws.
inline constexpr int kFirstHostUnit = 4;

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
  // Lines are as wide as GL_LINE_WIDTH. OpenGL ES 3.0 and 3.1 cannot mask single draw buffers: bind a
  // framebuffer with one. Programs are compiled when they are first used. Not in bindTrace().
  DebugView debug = DebugView::kNone;
  // A texture with the depth of the scene so far: GL_TEXTURE_2D, a depth format or GL_R32F, not attached to
  // the framebuffer drawn to; texel (x, y) belongs to the framebuffer's pixel (x, y). Rays end there, which
  // saves time, and replaces the depth test where no depth buffer is bound. 0: none.
  std::uint32_t scene_depth = 0;
  // Called by draw() just before it draws, with its program in use, in every pass except kFog; twice, with
  // two programs, if there are sheared parts and swept ones to draw. Sets what surface_glsl needs:
  // glUniform*, textures and samplers on units from kFirstHostUnit on, uniform buffers. These bindings stay.
  // It may change the active unit, and no other state. Don't leave samplers of different types on one unit.
  // Not called where `debug` replaces surface_glsl. Null: no callback.
  void (*bind)(void* user, std::uint32_t program) = nullptr;
  void* bind_user = nullptr;
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
using draw::poolBytes;

// As draw::levelAt (kelp/draw/planner.h).
std::optional<int> levelAt(const View& view, const runtime::Instance& instance, int part,
                           const glm::ivec2& pixel);

}  // namespace kelp::gl
