// SPDX-License-Identifier: MIT
#include "kelp/runtime/distance.h"

#include "instance_list.h"
#include "kelp/c/distance.h"

namespace kelp::c {
namespace {

using runtime::Instances;
using Boxes = std::span<const Box>;

// call(instances, boxes): what a query does with a list.
template <class Call>
kelp_result withList(const kelp_instance* instances, std::uint32_t count, const kelp_box* boxes,
                     const Call& call) {
  InstanceList list;
  if (const kelp_result bad = list.read(instances, count)) return bad;
  return call(list.all(), same<Box>(boxes, boxes ? count : 0));
}

kelp_result overlapsShape(const kelp_instance* instances, std::uint32_t count, const kelp_box* boxes,
                          const runtime::Shape& shape, std::int32_t* instance) {
  if (!instance) return nullPointer();
  return withList(instances, count, boxes, [&](Instances all, Boxes around) {
    const auto found = overlaps(all, shape, around);
    if (!found) return fail(found.error());
    *instance = found->value_or(KELP_NONE);
    return kelp_result{KELP_OK};
  });
}

}  // namespace
}  // namespace kelp::c

using namespace kelp::c;

kelp_result kelp_distance(const kelp_instance* instances, uint32_t count, const kelp_box* boxes,
                          const float point[3], kelp_distance_answer* answer) {
  if (!point) return nullPointer();
  if (const kelp_result bad = checkStruct(answer)) return bad;
  return withList(instances, count, boxes, [=](Instances all, Boxes around) {
    const auto found = distance(all, vec3At(point), around);
    if (!found) return fail(found.error());
    kelp_distance_answer out = {};
    out.bound = found->bound;
    put(found->away, out.away);
    out.instance = found->instance;
    out.part = found->part.value_or(KELP_NONE);
    out.level = found->level;
    return writeStruct(out, answer);
  });
}

kelp_result kelp_closest_point(const kelp_instance* instances, uint32_t count, const kelp_box* boxes,
                               const float point[3], float reach, kelp_closest_point_answer* answer) {
  if (!point) return nullPointer();
  if (const kelp_result bad = checkStruct(answer)) return bad;
  return withList(instances, count, boxes, [=](Instances all, Boxes around) {
    const auto found = closestPoint(all, vec3At(point), reach, around);
    if (!found) return fail(found.error());
    kelp_closest_point_answer out = {};
    out.distance = found->distance;
    put(found->point, out.point);
    out.instance = found->instance;
    out.part = found->part.value_or(KELP_NONE);
    out.ran_out = found->ran_out;
    return writeStruct(out, answer);
  });
}

kelp_result kelp_overlaps_sphere(const kelp_instance* instances, uint32_t count, const kelp_box* boxes,
                                 const float center[3], float radius, int32_t* instance) {
  if (!center) return nullPointer();
  return overlapsShape(instances, count, boxes, kelp::runtime::Sphere{vec3At(center), radius}, instance);
}

kelp_result kelp_overlaps_capsule(const kelp_instance* instances, uint32_t count, const kelp_box* boxes,
                                  const float a[3], const float b[3], float radius, int32_t* instance) {
  if (!a || !b) return nullPointer();
  return overlapsShape(instances, count, boxes, kelp::runtime::Capsule{vec3At(a), vec3At(b), radius},
                       instance);
}

kelp_result kelp_overlaps_box(const kelp_instance* instances, uint32_t count, const kelp_box* boxes,
                              const float center[3], const float half_size[3], const float rotation[4],
                              int32_t* instance) {
  if (!center || !half_size || !rotation) return nullPointer();
  return overlapsShape(instances, count, boxes,
                       kelp::runtime::OrientedBox{vec3At(center), vec3At(half_size), quatAt(rotation)},
                       instance);
}

kelp_result kelp_sphere_cast(const kelp_instance* instances, uint32_t count, const kelp_box* boxes,
                             const float from[3], const float to[3], float radius,
                             kelp_sphere_cast_answer* answer) {
  if (!from || !to) return nullPointer();
  if (const kelp_result bad = checkStruct(answer)) return bad;
  return withList(instances, count, boxes, [=](Instances all, Boxes around) {
    const auto cast = sphereCast(all, vec3At(from), vec3At(to), radius, around);
    if (!cast) return fail(cast.error());
    kelp_sphere_cast_answer out = {};
    out.hit = cast->hit;
    out.t = cast->t;
    put(cast->center, out.center);
    put(cast->away, out.away);
    out.instance = cast->instance;
    out.part = cast->part.value_or(KELP_NONE);
    out.ran_out = cast->ran_out;
    return writeStruct(out, answer);
  });
}
