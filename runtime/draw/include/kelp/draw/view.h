// SPDX-License-Identifier: MIT
// A picture that a host asks for, whatever graphics API draws it: camera, light, quality.
#pragma once

#include <cstdint>

#include <glm/mat4x4.hpp>

#include "kelp/formats/error.h"

namespace kelp::draw {

// Abilities beyond drawing. Each costs memory or time even in frames that do not use it.
enum class Features : std::uint8_t {
  kNone = 0,
  // Rays cast from what is seen: Quality::self_shadow, Quality::occlusion_rays. The program is then larger:
  // on Mesa's llvmpipe, which also runs branches that are not taken, a frame takes 1.2 times as long.
  kSecondaryRays = 1,
  // Distances on the GPU: Quality::soft_shadows, Quality::occlusion, and kelpDistance in shaders. They come
  // from assets that load them (runtime::AssetOptions::distance_level), and take part of the pool.
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

// Gets messages for people, on the thread that calls; `text` is valid during the call only.
struct Log {
  void (*write)(void* user, const char* text) = nullptr;  // null: nobody listens
  void* user = nullptr;
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
  kZeroToOne,      // Vulkan, Direct3D, Metal, WebGPU, or OpenGL with clip control
};

// Where the eye is, and what it draws into. Eye space looks down -z.
struct Camera {
  glm::mat4 world_to_eye{1};
  glm::mat4 eye_to_clip{1};  // perspective or orthographic; the far plane may be at infinity
  // Size of the current viewport in pixels. Without pixels, as in a minimized window, nothing is drawn; the
  // log is told so once.
  glm::ivec2 viewport{0};
  ClipRange clip_range = ClipRange::kMinusOneToOne;
  // The near plane is at the upper end of the range: the depth test is "greater or equal" instead of "less
  // or equal".
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
  // surface_glsl, which may call kelpVisible. They meet a part with a cage only if one of these two is set.
  // True: voxels keep the sun's light off others.
  bool self_shadow = false;
  // 0 .. 16 cosine-weighted rays for each pixel, which measure how much of the sky it sees. 0: all of it.
  int occlusion_rays = 0;
  // Length of those rays, in lengths of the part's longest side, > 0. A hit counts less the farther away it
  // is.
  float occlusion_reach = 0.25f;
  // Light past all solid parts of the instance, by distances; kMisuse without Features::kDistances. The sun's
  // shadow, with a penumbra: the angle in degrees, 0 .. 20, across the sun (the real one: 0.53). 0: no
  // shadow. Takes the place of self_shadow. Slower where an asset loads no distances, and where parts have
  // cages.
  float soft_shadows = 0;
  // How much of the sky a pixel sees, within occlusion_reach. Takes the place of occlusion_rays. A part whose
  // asset loads no distances, or whose distances are not uploaded yet, hides nothing. A part with a cage
  // costs about as much as by eight rays.
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
  // Linear light, for a framebuffer that encodes (an sRGB format) or is tone-mapped later. On a framebuffer
  // that does neither, the picture is too dark.
  kLinear,
  // For the screen: tone-mapped, so that bright light does not clip, and encoded as sRGB. For targets that
  // encode nothing: a canvas in a browser, many windows of SDL. Fog is then blended in encoded colors, which
  // is not quite right.
  kDisplay,
};

// A picture that explains itself, at run time. The first three draw other colors, by programs of their own;
// lines are one pixel wide, and nothing hides them. Only the first color target is written.
enum class DebugView : std::uint8_t {
  kNone,
  kParts,  // a color for each part of each instance
  // How many steps a ray took until it hit: blue 0, green 16, yellow 32, red 64 and more. In fog, until its
  // end, without shadow rays.
  kSteps,
  // A color for each level that is hit, gray for level 0. Black stripes: a finer level is wanted and not on
  // the GPU. In fog, where it begins.
  kLevels,
  // The boxes whose outlines, or cages in them, are rasterized; red: the eye is in or close to it, so all
  // pixels are.
  kBounds,
  kSplines,  // the splines of parts and their knots, as Instance::pose has them
  kCages,    // the cages of parts that have them: the edges of their outer cells
};
// True for those that replace the colors of parts, and the host's kelpSurface.
constexpr bool replacesColors(DebugView debug) {
  return debug >= DebugView::kParts && debug <= DebugView::kLevels;
}

// A picture to draw.
struct View {
  Camera camera = {};
  Light light = {};
  Quality quality = {};
  Output output = Output::kLinear;
  DebugView debug = DebugView::kNone;
};

// False: in a minimized window, say. Then nothing is drawn.
inline bool hasPixels(const View& view) { return view.camera.viewport.x > 0 && view.camera.viewport.y > 0; }

enum class Pass : std::uint8_t {
  kColor,  // color and depth of solid parts
  kDepth,  // depth only, for shadow maps and pre-passes
  // Fog parts, which the other passes leave out. Call it after everything opaque, the host's own included.
  // Blends premultiplied color into draw buffer 0 only; writes no depth. Rays end at the scene's depth:
  // a texture of the host's, or a copy of the depth buffer. Without either (no depth buffer, or a
  // multisampled one) fog is hidden only where it begins behind the scene. Parts that overlap are blended in
  // order: the one whose bounds begin farther from the eye first; of those around the eye, the later in the
  // list.
  kFog,
};

struct Stats {
  std::uint32_t instances = 0;  // parts of instances that were drawn
  // Parts that were culled: out of view, or covering fewer pixels than Quality::smallest_pixels. The latter:
  std::uint32_t culled = 0, too_small = 0;
  // Parts that are in view and not drawn, because nothing of them is on the GPU yet. If it stays above 0,
  // call Asset::pump() and upload(); the log says which was never called.
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
  // Draw calls. Solids: one for sheared parts and one for swept ones, one for each run of parts with like
  // cages, one for those that the eye is in (with Features::kDistances one for all), or that times
  // Quality::depth_batches at most. Fog: one for each run of parts that bend alike.
  std::uint32_t draws = 0;
  std::uint64_t bytes_uploaded = 0;  // by this call
  std::uint64_t gpu_bytes = 0;       // of assets, held now
  // Grids and pages that are wanted, would fit, and are not yet on the GPU; before the first upload(), all
  // levels of the assets. 0: the last draws' pictures are as fine as they get.
  std::uint32_t pending = 0;
};

}  // namespace kelp::draw
