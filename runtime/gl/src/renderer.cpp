// SPDX-License-Identifier: MIT
#include "kelp/gl/renderer.h"

#include <cstring>
#include <new>
#include <optional>
#include <utility>

#include "depth_copy.h"
#include "pool_texture.h"
#include "program.h"
#include "record_textures.h"
#include "state_guard.h"

namespace kelp::gl {
namespace {

using namespace constant;

constexpr Error kAbandoned{ErrorCode::kMisuse, "the renderer was abandoned"};
constexpr Error kOtherContext{ErrorCode::kMisuse,
                              "the renderer's context is not current on this thread; make the one current "
                              "that was so in Renderer::create(), or abandon() the renderer if it is gone"};
constexpr Error kIncomplete{
    ErrorCode::kMisuse, "the framebuffer to draw into is not complete; glCheckFramebufferStatus says why"};
static_assert(kFirstHostUnit >= kTextureUnits);

draw::View drawView(const View& view) {
  return {view.camera, view.light, view.quality, view.output, view.debug};
}

}  // namespace

struct Renderer::Impl {
  Impl(const RendererOptions& options, const Api& loaded)
      : api(loaded),
        log{options.log, options.user},
        restore(options.state == State::kRestore),
        features(options.features),
        surface(options.allocator) {}

  Api api;
  Log log;
  bool restore;
  Features features;
  bool abandoned = false;
  Buffer<char> surface;               // a copy of RendererOptions::surface_glsl; empty: kelp's own look
  Program programs[draw::kPrograms];  // those that assets need
  Name vertex_array = 0;
  Name sampler = 0;
  RecordTextures records, traced_records, lines;
  DepthCopy depth;
  PoolTexture pool;
  std::unique_ptr<draw::Planner> planner;
  draw::ShaderText trace_text;

  // Null: OpenGL may be called.
  const Error* unusable() const {
    return abandoned ? &kAbandoned : api.isCurrent() ? nullptr : &kOtherContext;
  }
  void setState(const Program& used, const View& view, Pass pass, const draw::Uniforms& uniforms,
                Name scene_depth) const;
  Result<void> prepare(draw::Program which);
  void copyToPool() {
    pool.write(api, planner->copies());
    planner->copied();
  }
};

// Everything a draw needs from the state; DrawGuard's list.
void Renderer::Impl::setState(const Program& used, const View& view, Pass pass,
                              const draw::Uniforms& uniforms, Name scene_depth) const {
  api.UseProgram(used.name);
  api.BindVertexArray(vertex_array);
  for (int unit = 0; unit < kTextureUnits; ++unit) api.BindSampler(static_cast<Name>(unit), sampler);
  bindUnit(api, kPool, pool.name());
  bindUnit(api, kRecords, records.name());
  bindUnit(api, kScene, scene_depth);
  api.Enable(kDepthTest);
  api.DepthFunc(view.camera.reversed_depth ? kGequal : kLequal);
  api.DepthMask(pass != Pass::kFog);
  api.Disable(kCullFace);
  api.Disable(kBlend);
  if (!api.es) api.PolygonMode(kFrontAndBack, kFill);
  if (pass == Pass::kDepth) api.ColorMask(0, 0, 0, 0);

  setUniforms(api, used, uniforms);
}

// Compiles a program that is not there yet. Within a DrawGuard.
Result<void> Renderer::Impl::prepare(draw::Program which) {
  Program& program = programs[static_cast<std::size_t>(which)];
  if (program.name != 0) return {};
  const auto built = build(api, which, features, surface.data(), log);
  if (!built) return built.error();
  program = *built;
  return {};
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
  // A host's surface may cast rays without the feature.
  const Features rays = self.surface.empty() ? Features::kNone : Features::kSecondaryRays;
  auto planner = draw::Planner::create({.pool_bytes = PoolTexture::bytesFor(self.api, options.gpu_budget),
                                        .features = self.features | rays,
                                        .log = self.log,
                                        .allocator = options.allocator});
  if (!planner) return planner.error();
  self.planner = *std::move(planner);
  if (auto good = self.pool.create(self.api, self.planner->poolBytes()); !good) return good.error();
  self.copyToPool();
  const bool either = has(self.features, Features::kDistances);
  if (auto good = self.prepare(either ? draw::Program::kAnyBend : draw::Program::kSheared); !good)
    return good.error();
  self.trace_text = draw::traceText(dialectOf(self.api), self.features);
  self.api.GenVertexArrays(1, &self.vertex_array);
  self.api.BindVertexArray(self.vertex_array);  // only then the name is an object that can be labeled
  label(self.api, kLabelVertexArray, self.vertex_array, "kelp without vertices");
  self.api.GenSamplers(1, &self.sampler);
  self.api.BindSampler(0, self.sampler);
  for (const Enum filter : {kTextureMinFilter, kTextureMagFilter})
    self.api.SamplerParameteri(self.sampler, filter, kNearest);
  self.api.SamplerParameteri(self.sampler, kTextureCompareMode, kNone);
  label(self.api, kLabelSampler, self.sampler, "kelp nearest");
  self.depth.create(self.api);
  return renderer;
}

Renderer::~Renderer() {
  Impl& self = *impl_;
  if (self.unusable()) return;  // objects of another context are not touched
  self.pool.destroy(self.api);
  for (const RecordTextures* textures : {&self.records, &self.traced_records, &self.lines})
    self.api.DeleteTextures(RecordTextures::kCount, textures->names);
  self.depth.destroy(self.api);
  self.api.DeleteSamplers(1, &self.sampler);
  self.api.DeleteVertexArrays(1, &self.vertex_array);
  for (const Program& program : self.programs) self.api.DeleteProgram(program.name);
}

Result<void> Renderer::add(const runtime::Asset& asset) {
  Impl& self = *impl_;
  if (const Error* const unusable = self.unusable()) return *unusable;
  const DebugGroup group(self.api, "kelp add");
  const UploadGuard guard(self.api, self.restore);
  const DrawGuard draw(self.api, self.restore);
  const std::uint32_t needed = self.planner->programs(asset);
  for (std::uint32_t i = 0; i < 32; ++i) {
    if (!(needed >> i & 1)) continue;
    if (auto good = self.prepare(static_cast<draw::Program>(i)); !good) return good;
  }
  const auto added = self.planner->add(asset);
  self.copyToPool();
  return added;
}

void Renderer::remove(const runtime::Asset& asset) {
  if (!impl_->abandoned) impl_->planner->remove(asset);
}

Result<Stats> Renderer::upload(std::uint64_t max_bytes) {
  Impl& self = *impl_;
  if (const Error* const unusable = self.unusable()) return *unusable;
  const DebugGroup group(self.api, "kelp upload");
  const UploadGuard guard(self.api, self.restore);
  const auto stats = self.planner->upload(max_bytes);
  self.copyToPool();
  return stats;
}

Result<Stats> Renderer::draw(const View& view, runtime::Instances instances, Pass pass) {
  Impl& self = *impl_;
  const Api& api = self.api;
  if (const Error* const unusable = self.unusable()) return *unusable;
  const draw::View planned = drawView(view);
  if (draw::hasPixels(planned) && api.CheckFramebufferStatus(kDrawFramebuffer) != kFramebufferComplete)
    return kIncomplete;
  const bool fog = pass == Pass::kFog;
  auto data = self.planner->draw(planned, instances, pass,
                                 view.scene_depth != 0 ? draw::Depth::kGiven : draw::Depth::kCopied);
  bool copies = data && view.scene_depth == 0 && data->uniforms.scene != 0;
  if (copies) {
    const UploadGuard guard(api, self.restore);
    copies = self.depth.prepare(api);
    if (!copies) data = self.planner->draw(planned, instances, pass, draw::Depth::kNone);
  }
  if (!data) return data.error();
  if (data->calls.empty()) return data->stats;
  const DebugGroup group(api, pass == Pass::kDepth ? "kelp depth" : fog ? "kelp fog" : "kelp color");
  {
    const UploadGuard guard(api, self.restore);
    if (auto good = uploadRecords(api, self.records, "kelp records", data->records); !good)
      return good.error();
    if (auto good = uploadRecords(api, self.lines, "kelp debug lines", data->lines); !good)
      return good.error();
  }
  const DrawGuard guard(api, self.restore);
  const Name scene_depth = copies ? self.depth.texture() : view.scene_depth;
  for (const draw::Call& call : data->calls) {
    if (auto good = self.prepare(call.program); !good) return good.error();
  }
  const Program* used = nullptr;
  std::optional<DebugGroup> of_program;
  for (const draw::Call& call : data->calls) {
    const Program& program = self.programs[static_cast<std::size_t>(call.program)];
    const bool lines = has(call.program, draw::Program::kLines),
               debug = has(call.program, draw::Program::kDebug);
    if (&program != used) {
      of_program.reset();
      of_program.emplace(api, program.label);
      self.setState(program, view, pass, data->uniforms, scene_depth);
      if (debug || lines) maskOtherBuffers(api);
      if (view.bind && !fog && !debug && !lines) view.bind(view.bind_user, program.name);
    }
    used = &program;
    if (lines) {
      bindUnit(api, kRecords, self.lines.name());
      api.Disable(kDepthTest);  // no depth is written either
      api.DrawArraysInstanced(constant::kLines, 0, static_cast<std::int32_t>(call.vertices), 1);
      api.Enable(kDepthTest);
      continue;
    }
    std::optional<DebugGroup> batch;
    if (call.copies_depth && !fog) batch.emplace(api, "kelp depth batch");
    if (call.copies_depth) self.depth.copy(api);
    std::optional<BlendGuard> blend;
    if (fog) blend.emplace(api, self.restore);
    setFirstInstance(api, program, data->uniforms.first_instance + static_cast<std::int32_t>(call.first));
    const bool strip = draw::topologyOf(call.program) == draw::Topology::kTriangleStrip;
    api.DrawArraysInstanced(strip ? kTriangleStrip : kTriangles, 0, static_cast<std::int32_t>(call.vertices),
                            static_cast<std::int32_t>(call.count));
  }
  if (copies) bindUnit(api, kScene, 0);  // the host must not find the copy bound
  return data->stats;
}

std::span<const char* const> Renderer::traceGlsl() const { return impl_->trace_text.all(); }

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
  const auto data = self.planner->trace(drawView(view), instances);
  if (!data) return data.error();
  const DebugGroup group(api, "kelp trace");
  {
    const UploadGuard guard(api, self.restore);
    if (auto good = uploadRecords(api, self.traced_records, "kelp traced records", data->records); !good)
      return good.error();
  }
  std::int32_t before = 0, unit_before = 0;
  if (self.restore) {
    api.GetIntegerv(kCurrentProgram, &before);
    api.GetIntegerv(kActiveTexture, &unit_before);
  }
  const std::pair<Enum, Name> textures[] = {{kTexture2dArray, self.pool.name()},
                                            {kTexture2d, self.traced_records.name()}};
  for (int i = 0; i < 2; ++i) {
    api.ActiveTexture(kTexture0 + static_cast<Enum>(first_unit + i));
    api.BindTexture(textures[i].first, textures[i].second);
    api.BindSampler(static_cast<Name>(first_unit + i), self.sampler);
  }
  api.UseProgram(program);
  const Program used = locate(api, program);
  api.Uniform1i(used.pool, first_unit);
  api.Uniform1i(used.records, first_unit + 1);
  setUniforms(api, used, data->uniforms);
  if (self.restore) {
    // It may have been deleted while it was current.
    api.UseProgram(api.IsProgram(static_cast<Name>(before)) ? static_cast<Name>(before) : 0);
    api.ActiveTexture(static_cast<Enum>(unit_before));
  }
  return data->stats;
}

void Renderer::abandon() {
  impl_->abandoned = true;
  impl_->planner.reset();
}

std::optional<int> levelAt(const View& view, const runtime::Instance& instance, int part,
                           const glm::ivec2& pixel) {
  return draw::levelAt(drawView(view), instance, part, pixel);
}

Result<void> Renderer::checkDestroy() const {
  const Error* const unusable = impl_->abandoned ? nullptr : impl_->unusable();
  return unusable ? Result<void>(*unusable) : Result<void>();
}

}  // namespace kelp::gl
