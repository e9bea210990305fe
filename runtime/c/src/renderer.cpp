// SPDX-License-Identifier: MIT
#include "kelp/c/renderer.h"
#include "instance_list.h"
#include "view.h"

namespace kelp::c {
namespace {

// A number for each thread of the process; unlike a thread's id, it never comes back.
std::uint64_t thisThread() {
  static constinit std::atomic<std::uint64_t> threads{0};
  thread_local const std::uint64_t number = ++threads;
  return number;
}

kelp_result wrongThread() { return fail(KELP_ERROR_WRONG_THREAD, "the renderer belongs to another thread"); }

// call(renderer): what a function does with a valid renderer on its own thread.
template <class Call>
kelp_result withRenderer(kelp_renderer renderer, const Call& call) {
  const Pinned<RendererObject> object(renderer.id);
  if (!object) return object.bad();
  return object->thread.load() == thisThread() ? call(*object->renderer) : wrongThread();
}

}  // namespace
}  // namespace kelp::c

using namespace kelp::c;
using kelp::gl::Renderer;

kelp_result kelp_renderer_options_defaults(kelp_renderer_options* options) {
  if (const kelp_result bad = checkStruct(options)) return bad;
  const kelp::gl::RendererOptions defaults;
  kelp_renderer_options out = {};
  out.state = static_cast<kelp_state>(defaults.state);
  out.gpu_budget = defaults.gpu_budget;
  out.features = static_cast<kelp_features>(defaults.features);
  return writeStruct(out, options);
}

kelp_result kelp_renderer_create(const kelp_renderer_options* options, kelp_renderer* renderer) {
  if (!renderer) return nullPointer();
  kelp_renderer_options read;
  if (const kelp_result bad = readStruct(options, read)) return bad;
  if (!read.get_proc_address) return nullPointer();
  if (read.state != KELP_STATE_RESTORE && read.state != KELP_STATE_LEAVE)
    return misuse("there is no such state");
  if (const kelp_result bad = checkFeatures(read.features)) return bad;
  kelp::gl::RendererOptions to;
  if (const kelp_result bad = readAllocator(read.allocator, to.allocator)) return bad;
  to.getProcAddress = read.get_proc_address;
  to.user = read.user;
  to.gpu_budget = read.gpu_budget;
  to.state = toEnum<kelp::gl::State>(read.state);
  to.surface_glsl = read.surface_glsl;
  to.features = static_cast<kelp::gl::Features>(read.features);
  to.log = read.log;
  auto* const object = makeObject<RendererObject>(to.allocator);
  if (!object) return noMemory();
  kelp::Result<std::unique_ptr<Renderer>> made = Renderer::create(to);
  if (!made) {
    const kelp_result result = fail(made.error());
    deleteObject(object);
    return result;
  }
  object->renderer = *std::move(made);
  object->thread = thisThread();
  return publish(object, renderer);
}

kelp_result kelp_renderer_destroy(kelp_renderer renderer) {
  if (const kelp_result bad = withRenderer(renderer, [](Renderer& of) { return answer(of.checkDestroy()); }))
    return bad;
  return destroyHandle<RendererObject>(renderer.id);
}

kelp_result kelp_renderer_use_here(kelp_renderer renderer) {
  const Pinned<RendererObject> object(renderer.id);
  if (!object) return object.bad();
  object->thread = thisThread();
  return KELP_OK;
}

kelp_result kelp_renderer_abandon(kelp_renderer renderer) {
  return withRenderer(renderer, [](Renderer& of) {
    of.abandon();
    return kelp_result{KELP_OK};
  });
}

kelp_result kelp_renderer_add(kelp_renderer renderer, kelp_asset asset) {
  return withRenderer(renderer, [asset](Renderer& to) {
    return withAsset(asset, [&to](const kelp::runtime::Asset& added) { return answer(to.add(added)); });
  });
}

kelp_result kelp_renderer_remove(kelp_renderer renderer, kelp_asset asset) {
  return withRenderer(renderer, [asset](Renderer& from) {
    return withAsset(asset, [&from](const kelp::runtime::Asset& removed) {
      from.remove(removed);
      return kelp_result{KELP_OK};
    });
  });
}

kelp_result kelp_renderer_upload(kelp_renderer renderer, uint64_t max_bytes, kelp_stats* stats) {
  if (const kelp_result bad = checkStats(stats)) return bad;
  return withRenderer(renderer, [=](Renderer& of) { return answerStats(of.upload(max_bytes), stats); });
}

kelp_result kelp_renderer_draw(kelp_renderer renderer, const kelp_view* view, const kelp_instance* instances,
                               uint32_t count, kelp_pass pass, kelp_stats* stats) {
  if (const kelp_result bad = checkStats(stats)) return bad;
  if (const kelp_result bad = checkPass(pass)) return bad;
  return withRenderer(renderer, [=](Renderer& of) {
    kelp::gl::View read;
    InstanceList list;
    if (const kelp_result bad = readView(view, read)) return bad;
    if (const kelp_result bad = list.read(instances, count)) return bad;
    return answerStats(of.draw(read, list.all(), toEnum<kelp::gl::Pass>(pass)), stats);
  });
}

kelp_result kelp_renderer_get_trace_glsl(kelp_renderer renderer, const char* const** strings,
                                         uint32_t* count) {
  if (!strings || !count) return nullPointer();
  return withRenderer(renderer, [=](const Renderer& of) {
    const std::span<const char* const> texts = of.traceGlsl();
    *strings = texts.data();
    *count = static_cast<uint32_t>(texts.size());
    return kelp_result{KELP_OK};
  });
}

kelp_result kelp_renderer_bind_trace(kelp_renderer renderer, uint32_t program, const kelp_view* view,
                                     const kelp_instance* instances, uint32_t count, int32_t first_unit,
                                     kelp_stats* stats) {
  if (const kelp_result bad = checkStats(stats)) return bad;
  return withRenderer(renderer, [=](Renderer& of) {
    kelp::gl::View read;
    InstanceList list;
    if (const kelp_result bad = readView(view, read)) return bad;
    if (const kelp_result bad = list.read(instances, count)) return bad;
    return answerStats(of.bindTrace(program, read, list.all(), first_unit), stats);
  });
}
