// SPDX-License-Identifier: MIT
#include "kelp/gl/renderer.h"

#include <algorithm>
#include <cmath>
#include <new>

#include <glm/geometric.hpp>

#include "asset_store.h"
#include "draw_list.h"
#include "program.h"
#include "state_guard.h"

namespace kelp::gl {
namespace {

using namespace constant;

// The frame's records on the GPU.
struct RecordTexture {
  Name name = 0;
  std::size_t rows = 0;
};

// Within an UploadGuard.
Result<void> uploadRecords(const Api& api, RecordTexture& texture, std::span<const glm::vec4> records) {
  constexpr auto kWidth = static_cast<std::int32_t>(DrawList::kRecordWidth);
  const std::size_t rows = records.size() / DrawList::kRecordWidth;
  const auto most = static_cast<std::size_t>(api.max_texture_size);
  if (rows > most) return Error{ErrorCode::kLimit, "more instances than a texture of this context holds"};
  api.BindTexture(kTexture2d, texture.name);
  if (rows > texture.rows) {
    const std::size_t fresh = std::min(std::max(rows, 2 * texture.rows), most);
    texture.rows = 0;
    drainErrors(api);
    api.TexImage2D(kTexture2d, 0, kRgba32f, kWidth, static_cast<std::int32_t>(fresh), 0, kRgba, kFloat, nullptr);
    if (auto good = checkErrors(api, "OpenGL refused the texture of the frame's instances"); !good) return good;
    texture.rows = fresh;
  }
  api.TexSubImage2D(kTexture2d, 0, 0, 0, kWidth, static_cast<std::int32_t>(rows), kRgba, kFloat, records.data());
  return {};
}

void bindUnit(const Api& api, Unit unit, Name texture) {
  api.ActiveTexture(kTexture0 + static_cast<Enum>(unit));
  api.BindTexture(kUnitTargets[unit], texture);
}

bool isGood(const View& view) {
  const float length = glm::length(view.sun_direction);
  return std::isfinite(length) && length > 0 && view.finest_level >= 0 && view.pixels_per_voxel >= 0 &&
         view.shading <= Shading::kSmooth;
}

}  // namespace

struct Renderer::Impl {
  Impl(const Config& config, const Api& loaded)
      : api(loaded), restore(config.state == State::kRestore), store(config.allocator, config.gpu_budget), list(config.allocator) {}

  Api api;
  bool restore;
  bool abandoned = false;
  Program program;
  Name vertex_array = 0;
  RecordTexture records;
  AssetStore store;
  DrawList list;

  void setState(const View& view, Pass pass) const;
  std::uint32_t drawItems() const;
};

// Everything a draw needs from the state; DrawGuard's list.
void Renderer::Impl::setState(const View& view, Pass pass) const {
  api.UseProgram(program.name);
  api.BindVertexArray(vertex_array);
  for (int unit = 0; unit < kTextureUnits; ++unit) api.BindSampler(static_cast<Name>(unit), 0);
  bindUnit(api, kRecords, records.name);
  api.Enable(kDepthTest);
  api.DepthFunc(kLequal);
  api.DepthMask(1);
  api.Disable(kCullFace);
  api.Disable(kBlend);
  if (!api.es) api.PolygonMode(kFrontAndBack, kFill);
  if (pass == Pass::kDepth) api.ColorMask(0, 0, 0, 0);

  const glm::vec3 sun = glm::normalize(view.sun_direction);
  const auto set = [this](std::int32_t location, const glm::vec3& v) { api.Uniform3f(location, v.x, v.y, v.z); };
  set(program.sun_direction, sun);
  set(program.sun_color, view.sun_color);
  set(program.sky_color, view.sky_color);
  set(program.ground_color, view.ground_color);
  api.Uniform1i(program.depth_only, pass == Pass::kDepth);
  api.Uniform1i(program.shading, static_cast<std::int32_t>(view.shading));
}

// One draw for each run of items of the same part and level. Answers the number of draws.
std::uint32_t Renderer::Impl::drawItems() const {
  const std::span<const DrawItem> items = list.items();
  std::uint32_t draws = 0;
  std::size_t texel = 0;
  for (std::size_t first = 0; first < items.size();) {
    const DrawItem& item = items[first];
    std::size_t end = first + 1;
    while (end < items.size() && items[end].sameDraw(item)) ++end;
    const GpuAsset& asset = store.at(item.asset);
    const LevelTextures& level = asset.level(item.part, item.level);
    bindUnit(api, kCells, level.cells);
    bindUnit(api, kCodes, level.codes);
    bindUnit(api, kSliceBase, level.slice_base);
    bindUnit(api, kAttributes, level.attributes);
    bindUnit(api, kPalette, asset.palette);
    const std::size_t stride = DrawList::recordTexels(item);
    api.Uniform1i(program.first_texel, static_cast<std::int32_t>(texel));
    api.Uniform1i(program.record_texels, static_cast<std::int32_t>(stride));
    api.Uniform1i(program.level, item.level);
    api.Uniform3i(program.level_size, level.size.x, level.size.y, level.size.z);
    api.DrawArraysInstanced(kTriangles, 0, 36, static_cast<std::int32_t>(end - first));
    texel += stride * (end - first);
    first = end;
    ++draws;
  }
  return draws;
}

Renderer::Renderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Result<std::unique_ptr<Renderer>> Renderer::create(const Config& config) {
  if (!config.getProcAddress) return Error{ErrorCode::kMisuse, "Config::getProcAddress is null"};
  Api api;
  if (auto good = loadApi(config.getProcAddress, config.user, api); !good) return good.error();
  std::unique_ptr<Impl> impl(new (std::nothrow) Impl(config, api));
  if (!impl) return Error{ErrorCode::kOutOfMemory, "no memory for the renderer"};
  std::unique_ptr<Renderer> renderer(new (std::nothrow) Renderer(std::move(impl)));
  if (!renderer) return Error{ErrorCode::kOutOfMemory, "no memory for the renderer"};

  Impl& self = *renderer->impl_;
  const UploadGuard upload(self.api, self.restore);
  const DrawGuard guard(self.api, self.restore);
  auto program = buildProgram(self.api, config.surface_glsl, {config.log, config.user});
  if (!program) return program.error();
  self.program = *program;
  self.api.GenVertexArrays(1, &self.vertex_array);
  self.records.name = makeTexture(self.api, kTexture2d);
  return renderer;
}

Renderer::~Renderer() {
  Impl& self = *impl_;
  self.store.clear(self.abandoned ? nullptr : &self.api);
  if (self.abandoned) return;
  self.api.DeleteTextures(1, &self.records.name);
  self.api.DeleteVertexArrays(1, &self.vertex_array);
  self.api.DeleteProgram(self.program.name);
}

Result<void> Renderer::add(const runtime::Asset& asset) {
  Impl& self = *impl_;
  if (self.abandoned) return Error{ErrorCode::kMisuse, "the renderer was abandoned"};
  const UploadGuard guard(self.api, self.restore);
  return self.store.add(self.api, asset);
}

void Renderer::remove(const runtime::Asset& asset) {
  if (!impl_->abandoned) impl_->store.remove(impl_->api, asset);
}

Result<Stats> Renderer::upload(std::uint64_t max_bytes) {
  Impl& self = *impl_;
  if (self.abandoned) return Error{ErrorCode::kMisuse, "the renderer was abandoned"};
  const UploadGuard guard(self.api, self.restore);
  const auto uploaded = self.store.upload(self.api, max_bytes);
  if (!uploaded) return uploaded.error();
  Stats stats;
  stats.bytes_uploaded = *uploaded;
  stats.gpu_bytes = self.store.bytes();
  stats.pending = self.store.pending();
  return stats;
}

Result<Stats> Renderer::draw(const View& view, std::span<const runtime::Instance> instances, Pass pass) {
  Impl& self = *impl_;
  if (self.abandoned) return Error{ErrorCode::kMisuse, "the renderer was abandoned"};
  if (view.viewport.x <= 0 || view.viewport.y <= 0) return Error{ErrorCode::kMisuse, "the viewport has no pixels; leave out frames while the window is minimised"};
  if (!isGood(view)) return Error{ErrorCode::kMisuse, "the view has a negative level, no direction of the sun, or a shading that is none"};
  Stats stats;
  stats.gpu_bytes = self.store.bytes();
  stats.pending = self.store.pending();
  const auto camera = makeCamera(view);
  if (!camera) return camera.error();
  if (auto good = self.list.build(self.store, *camera, view, instances); !good) return good.error();
  stats.culled = self.list.culled();
  stats.instances = static_cast<std::uint32_t>(self.list.items().size());
  if (stats.instances == 0) return stats;
  {
    const UploadGuard guard(self.api, self.restore);
    if (auto good = uploadRecords(self.api, self.records, self.list.records()); !good) return good.error();
  }
  const DrawGuard guard(self.api, self.restore);
  self.setState(view, pass);
  stats.draws = self.drawItems();
  return stats;
}

void Renderer::abandon() {
  impl_->abandoned = true;
  impl_->store.clear(nullptr);
}

}  // namespace kelp::gl
