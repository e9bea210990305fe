// SPDX-License-Identifier: MIT
#include "kelp/runtime/instance.h"

#include "instance_list.h"

namespace kelp::c {
namespace {

kelp_result putMatrix(const Result<glm::mat4>& result, float* matrix) {
  if (!result) return fail(result.error());
  put(*result, matrix);
  return KELP_OK;
}

}  // namespace
}  // namespace kelp::c

using namespace kelp::c;
using kelp::runtime::Instance;

kelp_result kelp_instance_defaults(kelp_instance* instance) {
  if (const kelp_result bad = checkStruct(instance)) return bad;
  const Instance defaults;
  kelp_instance out = {};
  put(defaults.to_world, out.to_world);
  put(defaults.tint, out.tint);
  return writeStruct(out, instance);
}

kelp_result kelp_instance_get_bounds(const kelp_instance* instance, kelp_box* bounds) {
  if (!bounds) return nullPointer();
  return withInstance(instance, [bounds](const Instance& of) {
    const kelp::Box box = kelp::runtime::bounds(of);
    put(box.min, bounds->min);
    put(box.max, bounds->max);
    return KELP_OK;
  });
}

kelp_result kelp_instance_part_to_world(const kelp_instance* instance, int32_t part, float matrix[16]) {
  if (!matrix) return nullPointer();
  return withInstance(instance, [=](const Instance& of) { return putMatrix(partToWorld(of, part), matrix); });
}

kelp_result kelp_instance_parts_to_world(const kelp_instance* instance, float* matrices, uint32_t count) {
  if (!matrices && count > 0) return nullPointer();
  return withInstance(instance, [=](const Instance& of) {
    return answer(partsToWorld(of, {reinterpret_cast<glm::mat4*>(matrices), count}));
  });
}

kelp_result kelp_instance_to_world(const kelp_instance* instance, int32_t part, const float rest[3],
                                   float world[3]) {
  if (!rest || !world) return nullPointer();
  return withInstance(instance, [=](const Instance& of) {
    const kelp::Result<glm::vec3> point = toWorld(of, part, vec3At(rest));
    if (!point) return fail(point.error());
    put(*point, world);
    return kelp_result{KELP_OK};
  });
}

kelp_result kelp_instance_to_rest(const kelp_instance* instance, int32_t part, const float world[3],
                                  float rest[3], kelp_bool* found) {
  if (!world || !rest || !found) return nullPointer();
  return withPart(instance, part, [=](const Instance& of) {
    const std::optional<glm::vec3> point = toRest(of, part, vec3At(world));
    *found = point.has_value();
    if (point) put(*point, rest);
    return kelp_result{KELP_OK};
  });
}

kelp_result kelp_instance_frame_at(const kelp_instance* instance, int32_t part, const float rest[3],
                                   float matrix[16]) {
  if (!rest || !matrix) return nullPointer();
  return withInstance(instance,
                      [=](const Instance& of) { return putMatrix(frameAt(of, part, vec3At(rest)), matrix); });
}

kelp_result kelp_instance_socket_to_world(const kelp_instance* instance, int32_t socket, float matrix[16]) {
  if (!matrix) return nullPointer();
  return withInstance(instance,
                      [=](const Instance& of) { return putMatrix(socketToWorld(of, socket), matrix); });
}

kelp_result kelp_raycast(const kelp_instance* instances, uint32_t count, const float origin[3],
                         const float direction[3], float t_max, int32_t level, kelp_raycast_answer* answer) {
  if (!origin || !direction) return nullPointer();
  if (const kelp_result bad = checkStruct(answer)) return bad;
  InstanceList list;
  if (const kelp_result bad = list.read(instances, count)) return bad;
  kelp_raycast_answer out = {};
  if (const auto hit = raycast(list.all(), {vec3At(origin), vec3At(direction), t_max}, level)) {
    out.found = 1;
    out.t = hit->t;
    put(hit->position, out.position);
    put(hit->normal, out.normal);
    put(hit->rest, out.rest);
    out.instance = hit->instance;
    out.part = hit->part;
    out.level = hit->level;
    put(hit->voxel, out.voxel);
    out.material = hit->material;
  }
  return writeStruct(out, answer);
}
