// SPDX-License-Identifier: MIT
#include "kelp/c/planner.h"

#include "instance_list.h"
#include "kelp/draw/program_text.h"
#include "view.h"

namespace kelp::c {
namespace {

static_assert(KELP_PROGRAM_FOG_SHADOW == static_cast<int>(draw::Program::kFogShadow) &&
              KELP_PROGRAMS == draw::kPrograms && KELP_RECORD_WIDTH == draw::kRecordWidth);
static_assert(KELP_DEPTH_COPIED == static_cast<int>(draw::Depth::kCopied) &&
              KELP_DIALECT_VULKAN == static_cast<int>(draw::Dialect::kVulkan));
static_assert(sizeof(kelp_uniforms) == sizeof(draw::Uniforms) &&
              offsetof(kelp_uniforms, first_instance) == offsetof(draw::Uniforms, first_instance) &&
              offsetof(kelp_uniforms, clip_low) == offsetof(draw::Uniforms, clip_low) &&
              offsetof(kelp_uniforms, shading) == offsetof(draw::Uniforms, shading) &&
              offsetof(kelp_uniforms, occlusion_reach) == offsetof(draw::Uniforms, occlusion_reach) &&
              offsetof(kelp_uniforms, debug) == offsetof(draw::Uniforms, debug));

// call(object): what a function does with a valid planner that no other call is using.
template <class Call>
kelp_result withPlanner(kelp_planner planner, const Call& call) {
  const Pinned<PlannerObject> object(planner.id);
  if (!object) return object.bad();
  if (object->used.exchange(true)) return inUse();
  const kelp_result result = call(*object.operator->());
  object->used = false;
  return result;
}

// The planner's data as C's. Nothing is written if there is no memory.
kelp_result answerData(PlannerObject& object, const Result<draw::DrawData>& result, kelp_draw_data* data,
                       kelp_stats* stats) {
  if (!result) return fail(result.error());
  if (!object.calls.grow(result->calls.size())) return noMemory();
  std::memcpy(&object.uniforms, &result->uniforms, sizeof object.uniforms);
  std::size_t count = 0;
  for (const draw::Call& call : result->calls)
    object.calls[count++] = {static_cast<kelp_program>(call.program), call.first, call.count, call.vertices,
                             call.copies_depth};
  kelp_draw_data out = {};
  out.call_count = static_cast<std::uint32_t>(count);
  out.records = reinterpret_cast<const std::uint32_t*>(result->records.data());
  out.records_size = result->records.size_bytes();
  out.uniforms = &object.uniforms;
  out.calls = object.calls.span().data();
  out.frame = result->frame;
  out.lines = reinterpret_cast<const std::uint32_t*>(result->lines.data());
  out.lines_size = result->lines.size_bytes();
  writeStruct(out, data);
  return answerStats(result->stats, stats);
}

// list(planner, view, instances): the data of a draw or a trace.
template <class List>
kelp_result plan(kelp_planner planner, const kelp_view* view, const kelp_instance* instances,
                 std::uint32_t count, kelp_draw_data* data, kelp_stats* stats, const List& list) {
  if (const kelp_result bad = checkStats(stats)) return bad;
  if (const kelp_result bad = checkStruct(data)) return bad;
  return withPlanner(planner, [&](PlannerObject& object) {
    gl::View read;
    InstanceList all;
    if (const kelp_result bad = readView(view, read)) return bad;
    if (const kelp_result bad = all.read(instances, count)) return bad;
    const draw::View of = {read.camera, read.light, read.quality, read.output, read.debug};
    return answerData(object, list(*object.planner, of, all.all()), data, stats);
  });
}

}  // namespace
}  // namespace kelp::c

using namespace kelp::c;
using kelp::draw::Planner;

kelp_result kelp_planner_options_defaults(kelp_planner_options* options) {
  if (const kelp_result bad = checkStruct(options)) return bad;
  const kelp::draw::PlannerOptions defaults;
  kelp_planner_options out = {};
  out.features = static_cast<kelp_features>(defaults.features);
  out.pool_bytes = defaults.pool_bytes;
  return writeStruct(out, options);
}

kelp_result kelp_planner_create(const kelp_planner_options* options, kelp_planner* planner) {
  if (!planner) return nullPointer();
  kelp_planner_options read;
  if (const kelp_result bad = readStruct(options, read)) return bad;
  if (const kelp_result bad = checkFeatures(read.features)) return bad;
  kelp::draw::PlannerOptions to;
  if (const kelp_result bad = readAllocator(read.allocator, to.allocator)) return bad;
  to.pool_bytes = read.pool_bytes;
  to.features = static_cast<kelp::draw::Features>(read.features);
  to.log = {read.log, read.user};
  kelp::Result<std::unique_ptr<Planner>> made = Planner::create(to);
  if (!made) return fail(made.error());
  auto* const object = makeObject<PlannerObject>(to.allocator);
  if (!object) return noMemory();
  object->planner = *std::move(made);
  object->copies = kelp::Buffer<kelp_copy>(to.allocator);
  object->calls = kelp::Buffer<kelp_call>(to.allocator);
  return publish(object, planner);
}

kelp_result kelp_planner_destroy(kelp_planner planner) { return destroyHandle<PlannerObject>(planner.id); }

kelp_result kelp_planner_get_pool_bytes(kelp_planner planner, uint64_t* bytes) {
  if (!bytes) return nullPointer();
  return withPlanner(planner, [bytes](const PlannerObject& object) {
    *bytes = object.planner->poolBytes();
    return kelp_result{KELP_OK};
  });
}

kelp_result kelp_planner_add(kelp_planner planner, kelp_asset asset) {
  return withPlanner(planner, [asset](PlannerObject& to) {
    return withAsset(asset,
                     [&to](const kelp::runtime::Asset& added) { return answer(to.planner->add(added)); });
  });
}

kelp_result kelp_planner_remove(kelp_planner planner, kelp_asset asset) {
  return withPlanner(planner, [asset](PlannerObject& from) {
    return withAsset(asset, [&from](const kelp::runtime::Asset& removed) {
      from.planner->remove(removed);
      return kelp_result{KELP_OK};
    });
  });
}

kelp_result kelp_planner_get_programs(kelp_planner planner, kelp_asset asset, uint32_t* programs) {
  if (!programs) return nullPointer();
  return withPlanner(planner, [=](const PlannerObject& of) {
    return withAsset(asset, [&of, programs](const kelp::runtime::Asset& drawn) {
      *programs = of.planner->programs(drawn);
      return kelp_result{KELP_OK};
    });
  });
}

kelp_result kelp_get_program_text(kelp_program program, kelp_dialect dialect, kelp_stage stage,
                                  kelp_features features, const char* surface_glsl, char* text,
                                  uint64_t capacity, uint64_t* size) {
  if (!size || (!text && capacity > 0)) return nullPointer();
  if (program >= KELP_PROGRAMS) return misuse("there is no such program");
  if (dialect < KELP_DIALECT_GL_330 || dialect > KELP_DIALECT_VULKAN)
    return misuse("there is no such dialect");
  if (stage < KELP_STAGE_VERTEX || stage > KELP_STAGE_FRAGMENT) return misuse("there is no such stage");
  if (const kelp_result bad = checkFeatures(features)) return bad;
  const kelp::draw::ProgramText whole =
      kelp::draw::programText(static_cast<kelp::draw::Program>(program), toEnum<kelp::draw::Dialect>(dialect),
                              static_cast<kelp::draw::Features>(features), surface_glsl);
  std::uint64_t at = 0;
  for (const char* string : (stage == KELP_STAGE_VERTEX ? whole.vertex : whole.fragment).all())
    for (; *string; ++string, ++at)
      if (at + 1 < capacity) text[at] = *string;
  if (capacity > 0) text[std::min(at, capacity - 1)] = '\0';
  *size = at + 1;
  return KELP_OK;
}

kelp_result kelp_planner_upload(kelp_planner planner, uint64_t max_bytes, kelp_stats* stats) {
  if (const kelp_result bad = checkStats(stats)) return bad;
  return withPlanner(
      planner, [=](PlannerObject& object) { return answerStats(object.planner->upload(max_bytes), stats); });
}

kelp_result kelp_planner_get_copies(kelp_planner planner, const kelp_copy** copies, uint32_t* count) {
  if (!copies || !count) return nullPointer();
  return withPlanner(planner, [=](PlannerObject& object) {
    const std::span<const kelp::draw::Copy> wanted = object.planner->copies();
    if (!object.copies.grow(wanted.size())) return noMemory();
    std::size_t at = 0;
    for (const kelp::draw::Copy& copy : wanted)
      object.copies[at++] = {copy.offset, copy.frame, copy.words.data(), copy.words.size_bytes()};
    *copies = object.copies.span().data();
    *count = static_cast<std::uint32_t>(at);
    return kelp_result{KELP_OK};
  });
}

kelp_result kelp_planner_copied(kelp_planner planner) {
  return withPlanner(planner, [](PlannerObject& object) {
    object.planner->copied();
    return kelp_result{KELP_OK};
  });
}

kelp_result kelp_planner_draw(kelp_planner planner, const kelp_view* view, const kelp_instance* instances,
                              uint32_t count, kelp_pass pass, kelp_depth depth, kelp_draw_data* data,
                              kelp_stats* stats) {
  if (const kelp_result bad = checkPass(pass)) return bad;
  if (depth < KELP_DEPTH_NONE || depth > KELP_DEPTH_COPIED) return misuse("there is no such depth");
  return plan(planner, view, instances, count, data, stats,
              [=](Planner& by, const auto& of, const auto& all) {
                return by.draw(of, all, toEnum<kelp::draw::Pass>(pass), toEnum<kelp::draw::Depth>(depth));
              });
}

kelp_result kelp_planner_trace(kelp_planner planner, const kelp_view* view, const kelp_instance* instances,
                               uint32_t count, kelp_draw_data* data, kelp_stats* stats) {
  return plan(planner, view, instances, count, data, stats,
              [](Planner& by, const auto& of, const auto& all) { return by.trace(of, all); });
}
