// SPDX-License-Identifier: MIT
// Drawing data for a graphics API of the host's own: bytes to copy into a pool of voxels, records, uniforms,
// draw calls. For hosts that draw with Vulkan, Direct3D, Metal, WebGPU; kelp::gl::Renderer is made of it.
// runtime/DRAW_DATA.md has the frame in ten steps; shaders/BINDINGS.md the bindings of the programs.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include <glm/ext/vector_uint4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "kelp/draw/view.h"
#include "kelp/runtime/instance.h"

namespace kelp::draw {

struct PlannerOptions {
  // Size of the pool: the buffer of the host's that holds all voxels. Whole blocks of 4 KiB; at least 256
  // KiB, less than 16 GiB, and no more than a storage buffer of the host's API may have (of Vulkan and WebGPU
  // 128 MiB is sure; HLSL by spirv-cross counts bytes in 32 bits). If the scene needs more, the parts worth
  // the fewest pixels are drawn coarser.
  std::uint64_t pool_bytes = std::uint64_t{256} << 20;
  Features features = Features::kNone;  // of the programs that the host has made
  // Told once for each asset why an instance of it was left out (Stats::left_out), or that pump() or upload()
  // was never called (Stats::waiting).
  Log log = {};
  Allocator allocator = {};
};

// Words to be copied into the pool.
struct Copy {
  std::uint64_t offset = 0;  // bytes into the pool, a multiple of 4
  // They lie in the planner or in the asset, until Planner::copied(), the next add(), remove() or upload(),
  // or the end of the asset.
  std::span<const std::uint32_t> words;
  // DrawData::frame of the last draw() that may read what is overwritten. 0: none. A copy that the GPU makes
  // between two frames, in a queue and behind a barrier, comes after that frame by itself. Who writes into
  // memory that the GPU reads waits until that frame is done.
  std::uint64_t frame = 0;
};

// A program: a set of bits, one for each #define of the shaders. kSheared alone is 0.
enum class Program : std::uint8_t {
  kSheared = 0,     // draws solid parts that are sheared
  kSwept = 1,       // parts that are swept
  kCaged = 2,       // solid parts with cages, by the faces of these: a list of triangles
  kAnyBend = 3,     // solid parts of all kinds, by their bounds: with Features::kDistances in place of the
                    // others; without, parts with cages that not all rays enter by a face
  kFog = 4,         // fog
  kFogHeat = 8,     // fog that glows by its heat
  kFogShadow = 16,  // fog that shades itself (Quality::self_shadow)
  kDebug = 32,      // parts, in the colors of View::debug
  kLines = 64,      // the lines of View::debug: no parts
};
inline constexpr int kPrograms = 65;  // every Program is below
constexpr Program operator|(Program a, Program b) {
  return static_cast<Program>(static_cast<std::uint8_t>(a) | static_cast<std::uint8_t>(b));
}
constexpr bool has(Program set, Program bit) {
  return (static_cast<std::uint8_t>(set) & static_cast<std::uint8_t>(bit)) != 0;
}

// kSheared, kSwept, kCaged or kAnyBend.
constexpr Program bendOf(Program program) {
  return static_cast<Program>(static_cast<std::uint8_t>(program) & 3);
}
// How a call's vertices are put together.
enum class Topology : std::uint8_t { kTriangleStrip, kTriangles, kLines };
constexpr Topology topologyOf(Program program) {
  return program == Program::kLines   ? Topology::kLines
         : program == Program::kCaged ? Topology::kTriangles
                                      : Topology::kTriangleStrip;
}

// A draw call: `count` instances from `first` on, of so many vertices each: strips of six; of kCaged lists of
// triangles, of kLines one list of lines, with DrawData::lines as the records. No vertex buffer.
struct Call {
  Program program = Program::kSheared;
  std::uint32_t first = 0, count = 0, vertices = 6;
  // Before this call the scene's depth must be the depth drawn so far: copy it. Only with Depth::kCopied.
  bool copies_depth = false;
};

// The uniform block of all programs; std140.
struct Uniforms {
  glm::vec3 sun_direction{0};  // normalized
  std::int32_t first_instance = 0;
  glm::vec3 sun_color{0};
  std::uint32_t motion = 0;
  glm::vec3 sky_color{0};
  std::uint32_t depth_only = 0;
  glm::vec3 ground_color{0};
  float clip_low = 0;
  std::int32_t scene = 0;  // 0: no scene depth is bound; 1, 2: one is, of an ordinary or a reversed depth
  std::int32_t shading = 0;
  std::uint32_t self_shadow = 0;
  std::int32_t occlusion_rays = 0;
  float occlusion_reach = 0;
  float sun_radius = 0;
  std::uint32_t occlusion = 0;
  std::uint32_t display = 0;
  std::int32_t part_count = 0;  // of trace()
  std::int32_t debug = 0;
  std::int32_t padding[2] = {};
};
static_assert(sizeof(Uniforms) == 112);

// The depth of the scene so far, where rays end, as a texture: texel (x, y) belongs to the framebuffer's
// pixel (x, y).
enum class Depth : std::uint8_t {
  kNone,    // there is none. Fog is then hidden only where it begins behind the scene
  kGiven,   // the host has one
  kCopied,  // the host copies the depth buffer where Call::copies_depth says so: fog, Quality::depth_batches
};

// A picture, or a pass of it. Valid until the planner's next draw() or trace().
struct DrawData {
  // For a storage buffer, or an unsigned RGBA texture 1,024 wide: whole rows of kRecordWidth.
  std::span<const glm::uvec4> records;
  Uniforms uniforms;
  std::span<const Call> calls;        // in this order
  std::span<const glm::uvec4> lines;  // as records, for kLines
  std::uint64_t frame = 0;            // 1, 2, ...: for Copy::frame
  Stats stats;
};
inline constexpr std::size_t kRecordWidth = 1024;

// Places, culls, chooses levels; decides what is in the pool. Makes no call of any graphics API. Use it on
// one thread at a time.
//
//   planner->upload(max_bytes);
//   for (const draw::Copy& copy : planner->copies()) ...;       // into the pool
//   const draw::DrawData data = *planner->draw(view, instances);
//   ... copy data.records and data.uniforms to where the frame's draws read them
//   for (const draw::Call& call : data.calls) ...;
//
// A host that makes copies late, but in order, or none at all, sees coarser voxels or nothing. One that makes
// later copies without the earlier ones may see voxels of another place. Nothing hangs.
class Planner {
 public:
  // The pool must then hold what copies() says. kMisuse: pool_bytes is out of range.
  static Result<std::unique_ptr<Planner>> create(const PlannerOptions& options);
  ~Planner();
  Planner(const Planner&) = delete;
  Planner& operator=(const Planner&) = delete;

  // Registers an asset; copies() then holds its tables. It must outlive the planner, or be removed first.
  // kMisuse: it was added before, or copies of the call before were not made. kLimit: the coarsest levels of
  // the assets added before leave no room. Where it fails, copies() is to be made too.
  Result<void> add(const runtime::Asset& asset);
  void remove(const runtime::Asset& asset);
  // The programs that parts of the asset may need, but for View::debug: bit i for Program i.
  std::uint32_t programs(const runtime::Asset& asset) const;

  // Call it once a frame. Fills copies() with at most `max_bytes` (0, or 4096 and more) of what the draws
  // since the last upload() lacked, the voxels that cover the most pixels first. Requests from the assets
  // what is not in memory, so that their pump() reads it. If there is no room, what was not drawn for
  // longest, or is worth fewer pixels, is dropped. Large grids and pages take several frames. Before the
  // first draw everything is wanted: a loading screen calls upload() until `pending` is 0. If the allocator
  // fails, the upload is tried again in the next call. kLimit: the coarsest levels of all assets do not fit;
  // those that do are drawn, so copies() is to be made then too. kMisuse: those of the call before were not.
  Result<Stats> upload(std::uint64_t max_bytes);
  // The copies that the last create(), add() or upload() wants made before the next draw()'s calls, even if
  // it failed. The copies do not overlap. remove() leaves out those of its asset.
  std::span<const Copy> copies() const;
  // The copies were made: lets go of their words. The next add() and upload() are kMisuse before.
  void copied();

  // Lists what to draw. Instances whose asset's coarsest level is not uploaded yet are not drawn yet.
  // Instances that cannot be drawn are left out: Stats::left_out. kMisuse: an asset that is unknown or was
  // destroyed, a pose or a palette of another asset (`offset` is the index of the instance), a view that is
  // not sound.
  Result<DrawData> draw(const View& view, runtime::Instances instances, Pass pass = Pass::kColor,
                        Depth depth = Depth::kNone);
  // The same for kelpTrace (shaders/scene.glsl) in a host's own shaders: all solid parts, no calls.
  Result<DrawData> trace(const View& view, runtime::Instances instances);

  std::uint64_t poolBytes() const;  // PlannerOptions::pool_bytes
  Stats stats() const;              // gpu_bytes and pending alone

 private:
  struct Impl;
  explicit Planner(std::unique_ptr<Impl> impl);

  std::unique_ptr<Impl> impl_;
};

// Bytes of the pool that the asset takes, as far as its grids have been loaded (Asset::pump): all of it after
// Asset::loadAll. A planner needs 4 KiB more. features: only kDistances matters.
std::uint64_t poolBytes(const runtime::Asset& asset, Features features = Features::kNone);

// The level of a part of the instance that draw() wants at a pixel of the framebuffer, for a runtime::raycast
// that meets what is seen. (draw() draws a coarser level until that one is uploaded. It bends swept parts by
// fewer arcs at coarser levels, which moves them by at most half a voxel of that level.) nullopt: a view, an
// instance or a part that cannot be drawn.
std::optional<int> levelAt(const View& view, const runtime::Instance& instance, int part,
                           const glm::ivec2& pixel);

}  // namespace kelp::draw
