// SPDX-License-Identifier: MIT
#include "view.h"

#include "instance_list.h"

namespace kelp::c {

template <>
inline constexpr std::size_t kFirstSize<kelp_view> = offsetof(kelp_view, debug);

kelp_result readView(const kelp_view* from, gl::View& to) {
  kelp_view read;
  if (const kelp_result bad = readStruct(from, read)) return bad;
  to.camera.world_to_eye = glm::make_mat4(read.world_to_eye);
  to.camera.eye_to_clip = glm::make_mat4(read.eye_to_clip);
  to.camera.viewport = {read.viewport[0], read.viewport[1]};
  to.camera.clip_range = toEnum<gl::ClipRange>(read.clip_range);
  to.camera.reversed_depth = read.reversed_depth != 0;
  to.camera.previous_world_to_clip = reinterpret_cast<const glm::mat4*>(read.previous_world_to_clip);
  to.light = {vec3(read.sun_direction), vec3(read.sun_color), vec3(read.sky_color), vec3(read.ground_color)};
  to.quality.shading = toEnum<gl::Shading>(read.shading);
  to.quality.finest_level = read.finest_level;
  to.quality.pixels_per_voxel = read.pixels_per_voxel;
  to.quality.smallest_pixels = read.smallest_pixels;
  to.quality.self_shadow = read.self_shadow != 0;
  to.quality.occlusion_rays = read.occlusion_rays;
  to.quality.occlusion_reach = read.occlusion_reach;
  to.quality.soft_shadows = read.soft_shadows;
  to.quality.occlusion = read.occlusion != 0;
  to.quality.depth_batches = read.depth_batches;
  to.output = toEnum<gl::Output>(read.output);
  to.scene_depth = read.scene_depth;
  to.bind = read.bind;
  to.bind_user = read.bind_user;
  to.debug = toEnum<gl::DebugView>(read.debug);
  return KELP_OK;
}

kelp_result checkFeatures(kelp_features features) {
  constexpr kelp_features kAll =
      KELP_FEATURE_SECONDARY_RAYS | KELP_FEATURE_DISTANCES | KELP_FEATURE_GRADIENT_ONLY;
  return features & ~kAll ? misuse("there is no such feature") : kelp_result{KELP_OK};
}

kelp_result checkPass(kelp_pass pass) {
  return pass < KELP_PASS_COLOR || pass > KELP_PASS_FOG ? misuse("there is no such pass")
                                                        : kelp_result{KELP_OK};
}

kelp_result checkStats(const kelp_stats* stats) { return stats ? checkStruct(stats) : kelp_result{KELP_OK}; }

kelp_result answerStats(const Result<draw::Stats>& result, kelp_stats* stats) {
  if (!result) return fail(result.error());
  if (!stats) return KELP_OK;
  const draw::Stats& from = *result;
  kelp_stats out = {};
  out.instances = from.instances;
  out.culled = from.culled;
  out.left_out = from.left_out;
  out.draws = from.draws;
  out.pending = from.pending;
  out.bytes_uploaded = from.bytes_uploaded;
  out.gpu_bytes = from.gpu_bytes;
  out.too_small = from.too_small;
  out.waiting = from.waiting;
  out.other_kind = from.other_kind;
  out.clamped = from.clamped;
  out.first_left_out_text = "";
  if (from.left_out > 0) {
    out.first_left_out_result = static_cast<kelp_result>(from.first_left_out.code);
    out.first_left_out = static_cast<std::uint32_t>(from.first_left_out.offset);
    out.first_left_out_text = from.first_left_out.detail;
  }
  return writeStruct(out, stats);
}

}  // namespace kelp::c

using namespace kelp::c;

kelp_result kelp_view_defaults(kelp_view* view) {
  if (const kelp_result bad = checkStruct(view)) return bad;
  const kelp::gl::View defaults;
  kelp_view out = {};
  out.viewport[0] = defaults.camera.viewport.x;
  out.viewport[1] = defaults.camera.viewport.y;
  put(defaults.camera.world_to_eye, out.world_to_eye);
  put(defaults.camera.eye_to_clip, out.eye_to_clip);
  out.clip_range = static_cast<kelp_clip_range>(defaults.camera.clip_range);
  out.reversed_depth = defaults.camera.reversed_depth;
  out.output = static_cast<kelp_output>(defaults.output);
  put(defaults.light.sun_direction, out.sun_direction);
  put(defaults.light.sun_color, out.sun_color);
  put(defaults.light.sky_color, out.sky_color);
  put(defaults.light.ground_color, out.ground_color);
  out.shading = static_cast<kelp_shading>(defaults.quality.shading);
  out.finest_level = defaults.quality.finest_level;
  out.pixels_per_voxel = defaults.quality.pixels_per_voxel;
  out.smallest_pixels = defaults.quality.smallest_pixels;
  out.self_shadow = defaults.quality.self_shadow;
  out.occlusion_rays = defaults.quality.occlusion_rays;
  out.occlusion_reach = defaults.quality.occlusion_reach;
  out.soft_shadows = defaults.quality.soft_shadows;
  out.occlusion = defaults.quality.occlusion;
  out.depth_batches = defaults.quality.depth_batches;
  out.scene_depth = defaults.scene_depth;
  out.debug = static_cast<kelp_debug_view>(defaults.debug);
  return writeStruct(out, view);
}

kelp_result kelp_pool_bytes(kelp_asset asset, kelp_features features, uint64_t* bytes) {
  if (!bytes) return nullPointer();
  if (const kelp_result bad = checkFeatures(features)) return bad;
  return withAsset(asset, [=](const kelp::runtime::Asset& of) {
    *bytes = kelp::gl::poolBytes(of, static_cast<kelp::gl::Features>(features));
    return kelp_result{KELP_OK};
  });
}

kelp_result kelp_level_at(const kelp_view* view, const kelp_instance* instance, int32_t part, int32_t x,
                          int32_t y, int32_t* level) {
  if (!level) return nullPointer();
  kelp::gl::View read;
  if (const kelp_result bad = readView(view, read)) return bad;
  return withInstance(instance, [&](const kelp::runtime::Instance& of) {
    *level = kelp::gl::levelAt(read, of, part, {x, y}).value_or(KELP_NONE);
    return kelp_result{KELP_OK};
  });
}
