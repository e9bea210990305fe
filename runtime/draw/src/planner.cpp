// SPDX-License-Identifier: MIT
#include "kelp/draw/planner.h"

#include <cmath>
#include <new>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "debug_lines.h"
#include "draw_list.h"

namespace kelp::draw {
namespace {

constexpr std::uint64_t kLeastUpload = 4096;
constexpr Error kNoMemoryForPlanner{ErrorCode::kOutOfMemory, "no memory to plan what is drawn"};
constexpr Error kUnmade{ErrorCode::kMisuse,
                        "copies() of the call before were not made; make them, then call copied()"};

Uniforms uniformsOf(const View& view, Pass pass, Depth depth) {
  const Quality& quality = view.quality;
  Uniforms to;
  to.sun_direction = glm::normalize(view.light.sun_direction);
  to.sun_color = view.light.sun_color;
  to.sky_color = view.light.sky_color;
  to.ground_color = view.light.ground_color;
  to.motion = view.camera.previous_world_to_clip != nullptr;
  to.depth_only = pass == Pass::kDepth;
  to.clip_low = view.camera.clip_range == ClipRange::kZeroToOne ? 0.0f : -1.0f;
  to.scene = depth == Depth::kNone ? 0 : view.camera.reversed_depth ? 2 : 1;
  to.shading = static_cast<std::int32_t>(quality.shading);
  to.self_shadow = quality.self_shadow;
  to.occlusion_rays = quality.occlusion_rays;
  to.occlusion_reach = quality.occlusion_reach;
  to.sun_radius = std::tan(glm::radians(0.5f * quality.soft_shadows));
  to.occlusion = quality.occlusion;
  to.display = view.output == Output::kDisplay;
  to.debug = static_cast<std::int32_t>(view.debug);
  return to;
}

}  // namespace

struct Planner::Impl {
  explicit Impl(const PlannerOptions& options)
      : features(options.features),
        log(options.log),
        store(options.allocator, has(options.features, Features::kDistances)),
        list(options.allocator, options.log),
        lines(options.allocator),
        calls(options.allocator) {}

  Features features;
  Log log;
  bool told_no_pixels = false;
  Residency store;
  DrawList list;
  DebugLines lines;
  Buffer<Call> calls;

  Stats stats() const {
    Stats stats;
    stats.gpu_bytes = store.pool().usedBytes();
    stats.pending = store.pending();
    return stats;
  }
  Result<DrawData> build(const View& view, runtime::Instances instances, Pass pass, Depth depth, Rays rays);
  Result<std::size_t> listSolids(Depth depth, int batches, bool debug);
  void takeRun(Call& call) const;
  Result<std::size_t> listFog(Depth depth, bool shadow, bool debug);
};

Result<DrawData> Planner::Impl::build(const View& view, runtime::Instances instances, Pass pass, Depth depth,
                                      Rays rays) {
  if (auto good = checkView(view, features); !good) return good.error();
  DrawData data;
  data.stats = stats();
  data.uniforms = uniformsOf(view, pass, depth);
  if (!hasPixels(view)) {
    if (log.write && !std::exchange(told_no_pixels, true))
      log.write(log.user, "kelp: Camera::viewport has no pixels, so nothing is drawn; this is told once\n");
    return data;
  }
  const auto projection = makeProjection(view);
  if (!projection) return projection.error();
  const PartKind kind = pass == Pass::kFog ? PartKind::kFog : PartKind::kSolid;
  const bool boxes = replacesColors(view.debug) || has(features, Features::kDistances);
  if (auto good = list.build(store, *projection, view, instances, kind, rays, boxes); !good)
    return good.error();
  list.count(data.stats);
  data.frame = store.pool().frame();
  data.uniforms.first_instance = static_cast<std::int32_t>(list.firstNumber());
  if (data.stats.instances > 0) data.records = list.records();
  return data;
}

// Near to far, in batches of equal size; each way to draw by itself. If any call copies the depth, the first
// does.
Result<std::size_t> Planner::Impl::listSolids(Depth depth, int batches, bool debug) {
  const std::uint32_t all = list.parts();
  const std::uint32_t most = depth == Depth::kCopied ? std::min(static_cast<std::uint32_t>(batches), all) : 1;
  // Each part with a cage may need a call, and then there are lines.
  if (!calls.grow(kWays * most + list.begin(Way::kTraced) - list.begin(Way::kCaged) + 1))
    return kNoMemoryForFrame;
  std::size_t count = 0;
  const auto add = [&](Program program, std::uint32_t begin, std::uint32_t end) {
    const std::uint64_t parts = end - begin;
    const std::uint32_t some = std::min(most, end - begin);
    for (std::uint32_t batch = 0; batch < some; ++batch) {
      auto first = static_cast<std::uint32_t>(begin + parts * batch / some);
      const auto last = static_cast<std::uint32_t>(begin + parts * (batch + 1) / some);
      bool copies = most > 1 && (some > 1 || count == 0);
      while (first < last) {
        calls[count] = {program, first, last - first, 6, copies};
        if (program == Program::kCaged) takeRun(calls[count]);
        first += calls[count++].count;
        copies = false;
      }
    }
  };
  if (debug || has(features, Features::kDistances)) {
    add(debug ? Program::kDebug | Program::kAnyBend : Program::kAnyBend, 0, all);
  } else {
    add(Program::kSheared, 0, list.begin(Way::kSwept));
    add(Program::kSwept, list.begin(Way::kSwept), list.begin(Way::kCaged));
    add(Program::kCaged, list.begin(Way::kCaged), list.begin(Way::kTraced));
    add(Program::kAnyBend, list.begin(Way::kTraced), all);
  }
  return count;
}

// Shortens a call for cages to instances whose vertices are half of what it draws, or more.
void Planner::Impl::takeRun(Call& call) const {
  std::uint64_t sum = 0, most = 0;
  std::uint32_t count = 0;
  for (; count < call.count; ++count) {
    const std::uint64_t faces = list.faces(call.first + count), greatest = std::max(most, faces);
    if (greatest * (count + 1) > 2 * (sum + faces)) break;
    sum += faces;
    most = greatest;
  }
  call.count = count;
  call.vertices = static_cast<std::uint32_t>(3 * most);
}

// Far to near: as many as follow each other and bend alike in one call.
Result<std::size_t> Planner::Impl::listFog(Depth depth, bool shadow, bool debug) {
  std::size_t count = 0;
  for (std::uint32_t begin = 0, end = 0; begin < list.parts(); begin = end) {
    const Bend bend = list.fogBend(begin);
    while (end < list.parts() && list.fogBend(end) == bend) ++end;
    if (!calls.grow(count + 2)) return kNoMemoryForFrame;
    const auto bit = [](bool wanted, Program set) { return wanted ? set : Program::kSheared; };
    const Program program =
        Program::kFog | bit(bend == Bend::kSweep, Program::kSwept) |
        (debug ? Program::kDebug
               : bit(list.hasHeat(bend), Program::kFogHeat) | bit(shadow, Program::kFogShadow));
    calls[count] = {program, begin, end - begin, 6, depth == Depth::kCopied && count == 0};
    ++count;
  }
  return count;
}

Planner::Planner(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Planner::~Planner() = default;

Result<std::unique_ptr<Planner>> Planner::create(const PlannerOptions& options) {
  std::unique_ptr<Impl> impl(new (std::nothrow) Impl(options));
  if (!impl) return kNoMemoryForPlanner;
  if (auto good = impl->store.create(options.pool_bytes); !good) return good.error();
  std::unique_ptr<Planner> planner(new (std::nothrow) Planner(std::move(impl)));
  if (!planner) return kNoMemoryForPlanner;
  return planner;
}

Result<void> Planner::add(const runtime::Asset& asset) {
  if (!copies().empty()) return kUnmade;
  return impl_->store.add(asset);
}
void Planner::remove(const runtime::Asset& asset) { impl_->store.remove(asset); }

std::uint32_t Planner::programs(const runtime::Asset& asset) const {
  std::uint32_t set = 0;
  const auto add = [&set](Program program) { set |= 1u << static_cast<int>(program); };
  const bool distances = has(impl_->features, Features::kDistances);
  add(distances ? Program::kAnyBend : Program::kSheared);
  for (const Part& part : asset.pack().parts()) {
    const Program bend = part.bend == Bend::kSweep ? Program::kSwept : Program::kSheared;
    const bool caged = !part.cages.empty();
    if (part.kind == PartKind::kSolid && !distances) add(caged ? Program::kCaged : bend);
    if (caged) add(Program::kAnyBend);
    if (!part.fog) continue;
    const Program fog =
        Program::kFog | bend | (part.fog->channels() > 1 ? Program::kFogHeat : Program::kSheared);
    add(fog);
    if (has(impl_->features, Features::kSecondaryRays)) add(fog | Program::kFogShadow);
  }
  return set;
}

Result<Stats> Planner::upload(std::uint64_t max_bytes) {
  if (!copies().empty()) return kUnmade;
  if (max_bytes > 0 && max_bytes < kLeastUpload)
    return Error{ErrorCode::kMisuse,
                 "max_bytes is below 4096, and an upload might never end; 0 uploads nothing"};
  const auto progress = impl_->store.upload(max_bytes);
  if (!progress) return progress.error();
  if (!progress->coarsest_fit)
    return Error{
        ErrorCode::kLimit,
        "the pool (gpu_budget) is too small for the coarsest levels of all assets: some are not drawn"};
  Stats stats = impl_->stats();
  stats.bytes_uploaded = progress->bytes;
  return stats;
}

std::span<const Copy> Planner::copies() const { return impl_->store.copies(); }
void Planner::copied() { impl_->store.copied(); }

Result<DrawData> Planner::draw(const View& view, runtime::Instances instances, Pass pass, Depth depth) {
  Impl& self = *impl_;
  auto data = self.build(view, instances, pass, depth, Rays::kView);
  if (!data) return data;
  if (data->stats.instances == 0) {
    data->uniforms.scene = 0;
    return data;
  }
  const bool debug = replacesColors(view.debug);
  const auto listed = pass == Pass::kFog ? self.listFog(depth, view.quality.self_shadow, debug)
                                         : self.listSolids(depth, view.quality.depth_batches, debug);
  if (!listed) return listed.error();
  std::size_t count = *listed;
  // Without a copy, the host's texture has the depth of another frame.
  if (depth == Depth::kCopied && !self.calls[0].copies_depth) data->uniforms.scene = 0;
  if (view.debug > DebugView::kLevels && pass != Pass::kDepth) {
    if (auto good = self.lines.build(view, self.list, instances); !good) return good.error();
    data->lines = self.lines.records();
    if (self.lines.points() > 0) self.calls[count++] = {Program::kLines, 0, 1, self.lines.points()};
  }
  data->calls = self.calls.span().first(count);
  data->stats.draws = static_cast<std::uint32_t>(count);
  return data;
}

Result<DrawData> Planner::trace(const View& view, runtime::Instances instances) {
  auto data = impl_->build(view, instances, Pass::kColor, Depth::kNone, Rays::kAny);
  if (!data) return data;
  data->uniforms.motion = 0;  // the records have none
  data->uniforms.part_count = static_cast<std::int32_t>(data->stats.instances);
  return data;
}

std::uint64_t Planner::poolBytes() const {
  return impl_->store.pool().rows() * std::uint64_t{Pool::kRowBytes};
}
Stats Planner::stats() const { return impl_->stats(); }

}  // namespace kelp::draw
