// SPDX-License-Identifier: MIT
#include "kelp/gl/renderer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "depth_copy.h"
#include "draw_list.h"
#include "placing.h"
#include "program.h"
#include "record_textures.h"
#include "residency.h"
#include "state_guard.h"

namespace kelp::gl {
namespace {

using namespace constant;

constexpr std::uint64_t kLeastUpload = 4096;
constexpr Error kAbandoned{ErrorCode::kMisuse, "the renderer was abandoned"};
constexpr Error kOtherContext{ErrorCode::kMisuse,
                              "the renderer's context is not current on this thread; make the one current "
                              "that was so in Renderer::create(), or abandon() the renderer if it is gone"};
constexpr Error kIncomplete{
    ErrorCode::kMisuse, "the framebuffer to draw into is not complete; glCheckFramebufferStatus says why"};
static_assert(kFirstHostUnit >= kTextureUnits);

void bindUnit(const Api& api, Unit unit, Name texture) {
  api.ActiveTexture(kTexture0 + static_cast<Enum>(unit));
  api.BindTexture(kUnitTargets[unit], texture);
}

int fogProgram(Bend bend, bool heat, bool shadow) { return 4 * (bend == Bend::kSweep) + 2 * heat + shadow; }

// The uniforms of the look, in the program in use.
void setLook(const Api& api, const Program& program, const View& view) {
  const auto set = [&api](std::int32_t location, const glm::vec3& v) {
    api.Uniform3f(location, v.x, v.y, v.z);
  };
  set(program.sun_direction, glm::normalize(view.light.sun_direction));
  set(program.sun_color, view.light.sun_color);
  set(program.sky_color, view.light.sky_color);
  set(program.ground_color, view.light.ground_color);
  api.Uniform1i(program.shading, static_cast<std::int32_t>(view.quality.shading));
  api.Uniform1i(program.self_shadow, view.quality.self_shadow);
  api.Uniform1i(program.occlusion_rays, view.quality.occlusion_rays);
  api.Uniform1f(program.occlusion_reach, view.quality.occlusion_reach);
  api.Uniform1f(program.sun_radius, std::tan(glm::radians(0.5f * view.quality.soft_shadows)));
  api.Uniform1i(program.occlusion, view.quality.occlusion);
}

}  // namespace

struct Renderer::Impl {
  Impl(const RendererOptions& options, const Api& loaded)
      : api(loaded),
        log{options.log, options.user},
        restore(options.state == State::kRestore),
        features(options.features),
        surface(options.allocator),
        store(options.allocator, has(options.features, Features::kDistances)),
        list(options.allocator, log),
        traced(options.allocator, log) {}

  Api api;
  LogSink log;
  bool restore;
  Features features;
  bool abandoned = false, told_no_pixels = false;
  Buffer<char> surface;            // a copy of RendererOptions::surface_glsl; empty: kelp's own look
  Program program, swept_program;  // the latter once a part is swept; with distances one is for all
  Program fog_programs[8];         // fogProgram(); those that assets need
  Name vertex_array = 0;
  Name sampler = 0;
  RecordTextures records;
  DepthCopy depth;
  Residency store;
  DrawList list;
  RecordTextures traced_records;
  DrawList traced;  // of the last bindTrace()
  TraceStrings trace_strings{};

  // Null: OpenGL may be called.
  const Error* unusable() const {
    return abandoned ? &kAbandoned : api.isCurrent() ? nullptr : &kOtherContext;
  }
  // A host's surface may cast rays without the feature.
  bool castsRays() const { return has(features, Features::kSecondaryRays) || !surface.empty(); }
  Result<void> check(const View& view) const {
    return checkView(view, castsRays() ? features | Features::kSecondaryRays : features);
  }
  void tellNoPixels() {
    if (log.write && !told_no_pixels)
      log.write(log.user, "kelp: Camera::viewport has no pixels, so nothing is drawn; this is told once\n");
    told_no_pixels = true;
  }
  void setState(const Program& used, const View& view, Pass pass, Name scene_depth) const;
  Result<void> prepare(std::span<const Part> parts);
  std::uint32_t drawBatches(const Program& used, std::uint32_t begin, std::uint32_t end,
                            std::uint32_t batches) const;
  std::uint32_t drawFog(const View& view, Name scene_depth) const;
};

// Everything a draw needs from the state; DrawGuard's list.
void Renderer::Impl::setState(const Program& used, const View& view, Pass pass, Name scene_depth) const {
  api.UseProgram(used.name);
  api.BindVertexArray(vertex_array);
  for (int unit = 0; unit < kTextureUnits; ++unit) api.BindSampler(static_cast<Name>(unit), sampler);
  bindUnit(api, kPool, store.pool().texture());
  bindUnit(api, kRecords, records.names[records.now]);
  bindUnit(api, kScene, scene_depth);
  api.Enable(kDepthTest);
  api.DepthFunc(view.camera.reversed_depth ? kGequal : kLequal);
  api.DepthMask(pass != Pass::kFog);
  api.Disable(kCullFace);
  api.Disable(kBlend);
  if (!api.es) api.PolygonMode(kFrontAndBack, kFill);
  if (pass == Pass::kDepth) api.ColorMask(0, 0, 0, 0);

  setLook(api, used, view);
  api.Uniform1i(used.motion, view.camera.previous_world_to_clip != nullptr);
  api.Uniform1i(used.depth_only, pass == Pass::kDepth);
  api.Uniform1f(used.clip_low, view.camera.clip_range == ClipRange::kZeroToOne ? 0.0f : -1.0f);
  api.Uniform1i(used.display, view.output == Output::kDisplay);
  api.Uniform1i(used.scene, scene_depth == 0 ? 0 : view.camera.reversed_depth ? 2 : 1);
}

// Compiles the programs that fog and swept parts need. Within a DrawGuard.
Result<void> Renderer::Impl::prepare(std::span<const Part> parts) {
  for (const Part& part : parts) {
    if (part.bend == Bend::kSweep && !part.fog && !has(features, Features::kDistances) &&
        swept_program.name == 0) {
      const auto built = buildProgram(api, surface.data(), features, Bend::kSweep, log);
      if (!built) return built.error();
      swept_program = *built;
    }
    if (!part.fog) continue;
    const bool heat = part.fog->channels() > 1;
    for (const bool shadow : {false, true}) {
      Program& fog_program = fog_programs[fogProgram(part.bend, heat, shadow)];
      if (fog_program.name != 0 || (shadow && !castsRays())) continue;
      const auto built = buildFogProgram(api, part.bend, heat, shadow, log);
      if (!built) return built.error();
      fog_program = *built;
    }
  }
  return {};
}

// Draws parts of the list near to far, in batches of equal size. Before each of several batches the depth so
// far is copied.
std::uint32_t Renderer::Impl::drawBatches(const Program& used, std::uint32_t begin, std::uint32_t end,
                                          std::uint32_t batches) const {
  const std::uint64_t parts = end - begin;
  batches = std::min(batches, end - begin);
  for (std::uint32_t batch = 0; batch < batches; ++batch) {
    const auto first = static_cast<std::uint32_t>(begin + parts * batch / batches),
               last = static_cast<std::uint32_t>(begin + parts * (batch + 1) / batches);
    if (batches > 1) depth.copy(api);
    api.Uniform1i(used.first_instance, static_cast<std::int32_t>(list.firstNumber() + first));
    api.DrawArraysInstanced(kTriangleStrip, 0, 6, static_cast<std::int32_t>(last - first));
  }
  return batches;
}

// Draws the list's fog far to near: as many as follow each other and bend alike in one draw.
std::uint32_t Renderer::Impl::drawFog(const View& view, Name scene_depth) const {
  std::uint32_t draws = 0;
  for (std::uint32_t begin = 0, end = 0; begin < list.parts(); begin = end) {
    const Bend bend = list.fogBend(begin);
    while (end < list.parts() && list.fogBend(end) == bend) ++end;
    const Program& used = fog_programs[fogProgram(bend, list.hasHeat(bend), view.quality.self_shadow)];
    setState(used, view, Pass::kFog, scene_depth);
    const BlendGuard blend(api, restore);
    draws += drawBatches(used, begin, end, 1);
  }
  return draws;
}

Renderer::Renderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Result<std::unique_ptr<Renderer>> Renderer::create(const RendererOptions& options) {
  if (!options.getProcAddress) return Error{ErrorCode::kMisuse, "RendererOptions::getProcAddress is null"};
  Api api;
  if (auto good = loadApi(options.getProcAddress, options.user, api); !good) return good.error();
  std::unique_ptr<Impl> impl(new (std::nothrow) Impl(options, api));
  if (!impl) return Error{ErrorCode::kOutOfMemory, "no memory for the renderer"};
  std::unique_ptr<Renderer> renderer(new (std::nothrow) Renderer(std::move(impl)));
  if (!renderer) return Error{ErrorCode::kOutOfMemory, "no memory for the renderer"};

  Impl& self = *renderer->impl_;
  const DebugGroup group(self.api, "kelp create");
  const UploadGuard upload(self.api, self.restore);
  const DrawGuard guard(self.api, self.restore);
  if (const char* const text = options.surface_glsl) {
    if (!self.surface.reset(std::strlen(text) + 1))
      return Error{ErrorCode::kOutOfMemory, "no memory for the renderer"};
    std::memcpy(self.surface.data(), text, self.surface.size());
  }
  if (auto good = self.store.create(self.api, options.gpu_budget); !good) return good.error();
  auto program = buildProgram(self.api, self.surface.data(), self.features, Bend::kShear, self.log);
  if (!program) return program.error();
  self.program = *program;
  self.trace_strings = traceStrings(self.api, self.features);
  self.api.GenVertexArrays(1, &self.vertex_array);
  self.api.BindVertexArray(self.vertex_array);  // only then the name is an object that can be labeled
  label(self.api, kLabelVertexArray, self.vertex_array, "kelp without vertices");
  self.api.GenSamplers(1, &self.sampler);
  self.api.BindSampler(0, self.sampler);
  for (const Enum filter : {kTextureMinFilter, kTextureMagFilter})
    self.api.SamplerParameteri(self.sampler, filter, kNearest);
  self.api.SamplerParameteri(self.sampler, kTextureCompareMode, kNone);
  label(self.api, kLabelSampler, self.sampler, "kelp nearest");
  for (Name& name : self.records.names) name = makeTexture(self.api, kTexture2d, "kelp records");
  for (Name& name : self.traced_records.names)
    name = makeTexture(self.api, kTexture2d, "kelp traced records");
  self.depth.create(self.api);
  return renderer;
}

Renderer::~Renderer() {
  Impl& self = *impl_;
  const bool leaves = self.unusable() != nullptr;  // objects of another context are not touched
  self.store.clear(leaves ? nullptr : &self.api);
  if (leaves) return;
  self.api.DeleteTextures(RecordTextures::kCount, self.records.names);
  self.api.DeleteTextures(RecordTextures::kCount, self.traced_records.names);
  self.depth.destroy(self.api);
  self.api.DeleteSamplers(1, &self.sampler);
  self.api.DeleteVertexArrays(1, &self.vertex_array);
  self.api.DeleteProgram(self.program.name);
  self.api.DeleteProgram(self.swept_program.name);
  for (const Program& program : self.fog_programs) self.api.DeleteProgram(program.name);
}

Result<void> Renderer::add(const runtime::Asset& asset) {
  Impl& self = *impl_;
  if (const Error* const unusable = self.unusable()) return *unusable;
  const DebugGroup group(self.api, "kelp add");
  const UploadGuard guard(self.api, self.restore);
  const DrawGuard draw(self.api, self.restore);
  if (auto good = self.prepare(asset.pack().parts()); !good) return good;
  return self.store.add(self.api, asset);
}

void Renderer::remove(const runtime::Asset& asset) {
  if (!impl_->abandoned) impl_->store.remove(asset);
}

Result<Stats> Renderer::upload(std::uint64_t max_bytes) {
  Impl& self = *impl_;
  if (const Error* const unusable = self.unusable()) return *unusable;
  if (max_bytes > 0 && max_bytes < kLeastUpload)
    return Error{ErrorCode::kMisuse,
                 "max_bytes is below 4096, and an upload might never end; 0 uploads nothing"};
  const DebugGroup group(self.api, "kelp upload");
  const UploadGuard guard(self.api, self.restore);
  const auto progress = self.store.upload(self.api, max_bytes);
  if (!progress) return progress.error();
  if (!progress->coarsest_fit)
    return Error{ErrorCode::kLimit,
                 "gpu_budget is too small for the coarsest levels of all assets: some are not drawn"};
  Stats stats;
  stats.bytes_uploaded = progress->bytes;
  stats.gpu_bytes = self.store.pool().usedBytes();
  stats.pending = progress->pending;
  return stats;
}

Result<Stats> Renderer::draw(const View& view, runtime::Instances instances, Pass pass) {
  Impl& self = *impl_;
  if (const Error* const unusable = self.unusable()) return *unusable;
  if (auto good = self.check(view); !good) return good.error();
  Stats stats;
  stats.gpu_bytes = self.store.pool().usedBytes();
  stats.pending = self.store.pending();
  if (!hasPixels(view)) {
    self.tellNoPixels();
    return stats;
  }
  const auto projection = makeProjection(view);
  if (!projection) return projection.error();
  if (self.api.CheckFramebufferStatus(kDrawFramebuffer) != kFramebufferComplete) return kIncomplete;
  const bool fog = pass == Pass::kFog;
  if (auto good =
          self.list.build(self.store, *projection, view, instances, fog ? PartKind::kFog : PartKind::kSolid);
      !good)
    return good.error();
  self.list.count(stats);
  if (stats.instances == 0) return stats;
  const DebugGroup group(self.api, pass == Pass::kDepth ? "kelp depth" : fog ? "kelp fog" : "kelp draw");
  std::uint32_t batches = 1;
  Name scene_depth = view.scene_depth;
  {
    const UploadGuard guard(self.api, self.restore);
    const bool wants_copy =
        scene_depth == 0 && (fog || (view.quality.depth_batches > 1 && stats.instances > 1));
    if (wants_copy && self.depth.prepare(self.api)) {
      scene_depth = self.depth.texture();
      if (fog) self.depth.copy(self.api);
      if (!fog) batches = std::min(static_cast<std::uint32_t>(view.quality.depth_batches), stats.instances);
    }
    if (auto good = uploadRecords(self.api, self.records, self.list.records()); !good) return good.error();
  }
  const DrawGuard guard(self.api, self.restore);
  const std::uint32_t all = self.list.parts(),
                      sheared = has(self.features, Features::kDistances) ? all : self.list.sheared();
  if (fog) {
    stats.draws = self.drawFog(view, scene_depth);
  } else {
    const auto drawWith = [&](const Program& used, std::uint32_t begin, std::uint32_t end) {
      if (begin == end) return;
      self.setState(used, view, pass, scene_depth);
      if (view.bind) view.bind(view.bind_user, used.name);
      stats.draws += self.drawBatches(used, begin, end, batches);
    };
    drawWith(self.program, 0, sheared);
    drawWith(self.swept_program, sheared, all);
  }
  // The host must not find the copy bound.
  if (scene_depth != view.scene_depth) bindUnit(self.api, kScene, 0);
  return stats;
}

std::span<const char* const> Renderer::traceGlsl() const { return impl_->trace_strings; }

Result<Stats> Renderer::bindTrace(std::uint32_t program, const View& view, runtime::Instances instances,
                                  int first_unit) {
  Impl& self = *impl_;
  const Api& api = self.api;
  if (const Error* const unusable = self.unusable()) return *unusable;
  std::int32_t linked = 0;
  if (program != 0 && api.IsProgram(program)) api.GetProgramiv(program, kLinkStatus, &linked);
  if (!linked) return Error{ErrorCode::kMisuse, "`program` is not a linked program of this context"};
  if (first_unit < 0 || first_unit > api.max_texture_units - 2)
    return Error{ErrorCode::kMisuse, "first_unit or the next is not a texture unit of this context"};
  if (auto good = self.check(view); !good) return good.error();
  Stats stats;
  stats.gpu_bytes = self.store.pool().usedBytes();
  stats.pending = self.store.pending();
  const bool is_seen = hasPixels(view);
  const auto projection = is_seen ? makeProjection(view) : Result<Projection>(Projection{});
  if (!projection) return projection.error();
  if (!is_seen) instances = {};
  if (auto good = self.traced.build(self.store, *projection, view, instances, PartKind::kSolid, Rays::kAny);
      !good)
    return good.error();
  self.traced.count(stats);
  const DebugGroup group(api, "kelp trace");
  if (stats.instances > 0) {
    const UploadGuard guard(api, self.restore);
    if (auto good = uploadRecords(api, self.traced_records, self.traced.records()); !good)
      return good.error();
  }
  std::int32_t before = 0, unit_before = 0;
  if (self.restore) {
    api.GetIntegerv(kCurrentProgram, &before);
    api.GetIntegerv(kActiveTexture, &unit_before);
  }
  const std::pair<Enum, Name> textures[] = {{kTexture2dArray, self.store.pool().texture()},
                                            {kTexture2d, self.traced_records.names[self.traced_records.now]}};
  for (int i = 0; i < 2; ++i) {
    api.ActiveTexture(kTexture0 + static_cast<Enum>(first_unit + i));
    api.BindTexture(textures[i].first, textures[i].second);
    api.BindSampler(static_cast<Name>(first_unit + i), self.sampler);
  }
  api.UseProgram(program);
  const TraceProgram locations = locateTrace(api, program);
  api.Uniform1i(locations.pool, first_unit);
  api.Uniform1i(locations.records, first_unit + 1);
  api.Uniform1i(locations.first_instance, static_cast<std::int32_t>(self.traced.firstNumber()));
  api.Uniform1i(locations.part_count, static_cast<std::int32_t>(self.traced.parts()));
  setLook(api, locations.look, view);
  if (self.restore) {
    // It may have been deleted while it was current.
    api.UseProgram(api.IsProgram(static_cast<Name>(before)) ? static_cast<Name>(before) : 0);
    api.ActiveTexture(static_cast<Enum>(unit_before));
  }
  return stats;
}

void Renderer::abandon() {
  impl_->abandoned = true;
  impl_->store.clear(nullptr);
}

Result<void> Renderer::checkDestroy() const {
  const Error* const unusable = impl_->abandoned ? nullptr : impl_->unusable();
  return unusable ? Result<void>(*unusable) : Result<void>();
}

}  // namespace kelp::gl
