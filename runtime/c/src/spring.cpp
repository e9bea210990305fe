// SPDX-License-Identifier: MIT
#include "kelp/runtime/spring.h"

#include "instance_list.h"
#include "kelp/c/spring.h"

namespace kelp::c {

template <>
inline constexpr std::size_t kFirstSize<kelp_spring_options> = offsetof(kelp_spring_options, rooted) +
                                                               sizeof(kelp_bool);

namespace {

// call(spring): what a function does with a valid spring.
template <class Call>
kelp_result withSpring(kelp_spring spring, const Call& call) {
  const Pinned<SpringObject> object(spring.id);
  return object ? call(object->spring) : object.bad();
}

// A push or a wind in the world.
using InWorld = Result<void> (runtime::Spring::*)(const runtime::Instance&, int, const glm::vec3&);
kelp_result moveInWorld(kelp_spring spring, const kelp_instance* instance, std::int32_t part,
                        const float* vector, InWorld move) {
  if (!vector) return nullPointer();
  return withSpring(spring, [=](runtime::Spring& of) {
    return withInstance(instance, [=, &of](const runtime::Instance& in) {
      return answer((of.*move)(in, part, vec3At(vector)));
    });
  });
}

}  // namespace
}  // namespace kelp::c

using namespace kelp::c;
using kelp::runtime::Spring;

kelp_result kelp_spring_options_defaults(kelp_spring_options* options) {
  if (const kelp_result bad = checkStruct(options)) return bad;
  const kelp::runtime::SpringOptions defaults;
  return writeStruct({0, defaults.frequency, defaults.damping, defaults.reach, defaults.rooted, nullptr, 0},
                     options);
}

kelp_result kelp_spring_create(kelp_asset asset, const kelp_spring_options* options,
                               const kelp_allocator* allocator, kelp_spring* spring) {
  const Pinned<AssetObject> of(asset.id);
  if (!of) return of.bad();
  if (!spring) return nullPointer();
  kelp::runtime::SpringOptions set;
  if (options) {
    kelp_spring_options read;
    if (const kelp_result bad = readStruct(options, read)) return bad;
    if (!read.parts && read.part_count > 0) return nullPointer();
    set = {read.frequency, read.damping, read.reach, read.rooted != 0};
    if (read.parts) set.parts.emplace(read.parts, read.part_count);
  }
  kelp::Allocator memory;
  if (const kelp_result bad = readAllocator(allocator, memory)) return bad;
  kelp::Result<Spring> made = Spring::create(*of->asset, set, memory);
  if (!made) return fail(made.error());
  auto* const object = makeObject<SpringObject>(memory);
  if (!object) return noMemory();
  object->spring = *std::move(made);
  return publish(object, spring);
}

kelp_result kelp_spring_destroy(kelp_spring spring) { return destroyHandle<SpringObject>(spring.id); }

kelp_result kelp_spring_get_parts(kelp_spring spring, int32_t* parts) {
  return withSpring(spring, [parts](const Spring& of) {
    if (!parts) return nullPointer();
    *parts = of.parts();
    return kelp_result{KELP_OK};
  });
}

kelp_result kelp_spring_get_swings(kelp_spring spring, int32_t part, kelp_swing* swings, uint32_t capacity,
                                   uint32_t* count) {
  return withSpring(spring,
                    [=](const Spring& of) { return copyOut(of.knots(part), swings, capacity, count); });
}

kelp_result kelp_spring_get_node_swings(kelp_spring spring, int32_t part, kelp_swing* swings,
                                        uint32_t capacity, uint32_t* count) {
  return withSpring(spring, [=](const Spring& of) {
    if (part < 0 || part >= of.parts() || !of.nodes(part).empty())
      return copyOut(of.nodes(part), swings, capacity, count);
    if (!count || (!swings && capacity > 0)) return nullPointer();
    *count = 0;
    return kelp_result{KELP_OK};
  });
}

kelp_result kelp_spring_reset(kelp_spring spring) {
  return withSpring(spring, [](Spring& of) {
    of.reset();
    return kelp_result{KELP_OK};
  });
}

kelp_result kelp_spring_push(kelp_spring spring, int32_t part, const float velocity[3]) {
  return withSpring(
      spring, [=](Spring& of) { return velocity ? answer(of.push(part, vec3At(velocity))) : nullPointer(); });
}

kelp_result kelp_spring_push_in_world(kelp_spring spring, const kelp_instance* instance, int32_t part,
                                      const float velocity[3]) {
  return moveInWorld(spring, instance, part, velocity, &Spring::pushInWorld);
}

kelp_result kelp_spring_set_wind(kelp_spring spring, int32_t part, const float acceleration[3]) {
  return withSpring(spring, [=](Spring& of) {
    return acceleration ? answer(of.setWind(part, vec3At(acceleration))) : nullPointer();
  });
}

kelp_result kelp_spring_set_wind_in_world(kelp_spring spring, const kelp_instance* instance, int32_t part,
                                          const float acceleration[3]) {
  return moveInWorld(spring, instance, part, acceleration, &Spring::setWindInWorld);
}

kelp_result kelp_spring_push_away(kelp_spring spring, const kelp_instance* instance, const float center[3],
                                  float radius) {
  if (!center) return nullPointer();
  return withSpring(spring, [=](Spring& of) {
    return withInstance(instance, [=, &of](const kelp::runtime::Instance& in) {
      return answer(of.pushAway(in, vec3At(center), radius));
    });
  });
}

kelp_result kelp_spring_step(kelp_spring spring, float seconds) {
  return withSpring(spring, [=](Spring& of) { return answer(of.step(seconds)); });
}

kelp_result kelp_spring_add_to(kelp_spring spring, kelp_pose pose) {
  return withSpring(spring, [=](const Spring& of) {
    const Pinned<PoseObject> object(pose.id);
    return object ? answer(of.addTo(object->pose)) : object.bad();
  });
}
