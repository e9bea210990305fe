// SPDX-License-Identifier: MIT
#include "kelp/runtime/pose.h"

#include <algorithm>

#include "kelp/c/pose.h"
#include "objects.h"

namespace kelp::c {
namespace {

constexpr char kNoPart[] = "there is no such part";

// call(pose): what a function does with a valid pose.
template <class Call>
kelp_result withPose(kelp_pose pose, const Call& call) {
  const Pinned<PoseObject> object(pose.id);
  return object ? call(object->pose) : object.bad();
}
// The same with another pose, which may be the same one.
template <class Call>
kelp_result withPoses(kelp_pose pose, kelp_pose other, const Call& call) {
  const Pinned<PoseObject> object(pose.id), second(other.id);
  return !object ? object.bad() : !second ? second.bad() : call(object->pose, second->pose);
}
template <class Call>
kelp_result withPoseOf(kelp_pose pose, kelp_asset asset, const Call& call) {
  const Pinned<PoseObject> object(pose.id);
  const Pinned<AssetObject> of(asset.id);
  return !object ? object.bad() : !of ? of.bad() : call(object->pose, *of->asset);
}

}  // namespace
}  // namespace kelp::c

using namespace kelp::c;
using kelp::runtime::Asset;
using kelp::runtime::Pose;

kelp_result kelp_pose_create(kelp_asset asset, const kelp_allocator* allocator, kelp_pose* pose) {
  const Pinned<AssetObject> of(asset.id);
  if (!of) return of.bad();
  if (!pose) return nullPointer();
  kelp::Allocator memory;
  if (const kelp_result bad = readAllocator(allocator, memory)) return bad;
  kelp::Result<Pose> made = Pose::create(*of->asset, memory);
  if (!made) return fail(made.error());
  auto* const object = makeObject<PoseObject>(memory);
  if (!object) return noMemory();
  object->pose = *std::move(made);
  return publish(object, pose);
}

kelp_result kelp_pose_destroy(kelp_pose pose) { return destroyHandle<PoseObject>(pose.id); }

kelp_result kelp_pose_get_parts(kelp_pose pose, int32_t* parts) {
  return withPose(pose, [parts](const Pose& of) {
    if (!parts) return nullPointer();
    *parts = of.parts();
    return kelp_result{KELP_OK};
  });
}

kelp_result kelp_pose_fits(kelp_pose pose, kelp_asset asset, kelp_bool* fits) {
  return withPoseOf(pose, asset, [fits](const Pose& of, const Asset& whole) {
    if (!fits) return nullPointer();
    *fits = of.fits(whole);
    return kelp_result{KELP_OK};
  });
}

kelp_result kelp_pose_get_knots(kelp_pose pose, int32_t part, kelp_knot* knots, uint32_t capacity,
                                uint32_t* count) {
  return withPose(pose, [=](const Pose& of) { return copyOut(of.knots(part), knots, capacity, count); });
}

kelp_result kelp_pose_set_knots(kelp_pose pose, int32_t part, const kelp_knot* knots, uint32_t count) {
  return withPose(pose, [=](Pose& of) {
    return knots ? answer(of.setKnots(part, same<kelp::Knot>(knots, count))) : nullPointer();
  });
}

kelp_result kelp_pose_move(kelp_pose pose, int32_t part, int32_t knot, const float offset[3]) {
  return withPose(
      pose, [=](Pose& of) { return offset ? answer(of.move(part, knot, vec3At(offset))) : nullPointer(); });
}

kelp_result kelp_pose_set_tangent(kelp_pose pose, int32_t part, int32_t knot, const float tangent[3]) {
  return withPose(pose, [=](Pose& of) {
    return tangent ? answer(of.setTangent(part, knot, vec3At(tangent))) : nullPointer();
  });
}

kelp_result kelp_pose_get_motion(kelp_pose pose, int32_t part, kelp_motion* motion) {
  return withPose(pose, [=](const Pose& of) {
    if (!motion) return nullPointer();
    const kelp::runtime::Motion* const from = of.motion(part);
    if (!from) return misuse(kNoPart);
    put(from->translation, motion->translation);
    put(from->rotation, motion->rotation);
    put(from->scale, motion->scale);
    motion->roll = from->roll;
    return kelp_result{KELP_OK};
  });
}

kelp_result kelp_pose_set_motion(kelp_pose pose, int32_t part, const kelp_motion* motion) {
  return withPose(pose, [=](Pose& of) {
    if (!motion) return nullPointer();
    kelp::runtime::Motion* const to = of.motion(part);
    if (!to) return misuse(kNoPart);
    *to = {vec3(motion->translation), quatAt(motion->rotation), vec3(motion->scale), motion->roll};
    return kelp_result{KELP_OK};
  });
}

kelp_result kelp_pose_get_nodes(kelp_pose pose, int32_t part, float* nodes, uint32_t capacity,
                                uint32_t* count) {
  return withPose(pose, [=](const Pose& of) {
    if (!count || (!nodes && capacity > 0)) return nullPointer();
    if (part < 0 || part >= of.parts()) return misuse(kNoPart);
    const std::span<const glm::vec3> all = of.nodes(part);
    *count = static_cast<uint32_t>(all.size());
    for (std::size_t i = 0; i < std::min<std::size_t>(capacity, all.size()); ++i) put(all[i], nodes + 3 * i);
    return kelp_result{KELP_OK};
  });
}

kelp_result kelp_pose_write_nodes(kelp_pose pose, int32_t part, float** nodes, uint32_t* count) {
  return withPose(pose, [=](Pose& of) {
    if (!nodes || !count) return nullPointer();
    if (part < 0 || part >= of.parts()) return misuse(kNoPart);
    const std::span<glm::vec3> all = of.nodes(part);
    *nodes = all.empty() ? nullptr : &all[0].x;
    *count = static_cast<uint32_t>(all.size());
    return kelp_result{KELP_OK};
  });
}

kelp_result kelp_pose_set_joints(kelp_pose pose, kelp_asset asset, const float* matrices, uint32_t count) {
  return withPoseOf(pose, asset, [=](Pose& of, const Asset& its) {
    if (!matrices && count > 0) return nullPointer();
    return answer(of.setJoints(its, {reinterpret_cast<const glm::mat4*>(matrices), count}));
  });
}

kelp_result kelp_pose_set_section(kelp_pose pose, int32_t part, int32_t knot, const float width[2],
                                  float twist, float keep_volume) {
  return withPose(pose, [=](Pose& of) {
    const glm::vec2 widths = width ? glm::vec2(width[0], width[1]) : glm::vec2(1);
    return answer(of.setSection(part, knot, {widths, twist, keep_volume}));
  });
}

kelp_result kelp_pose_set_morph(kelp_pose pose, kelp_asset asset, const char* name, float weight) {
  if (!name) return nullPointer();
  return withPoseOf(pose, asset,
                    [=](Pose& of, const Asset& its) { return answer(of.setMorph(its, name, weight)); });
}

kelp_result kelp_pose_reset(kelp_pose pose) {
  return withPose(pose, [](Pose& of) {
    of.reset();
    return kelp_result{KELP_OK};
  });
}

kelp_result kelp_pose_assign(kelp_pose pose, kelp_pose other) {
  return withPoses(pose, other, [](Pose& to, const Pose& from) { return answer(to.assign(from)); });
}

kelp_result kelp_pose_blend(kelp_pose pose, kelp_pose to, float weight, const float* part_weights,
                            uint32_t count) {
  if (!part_weights && count > 0) return nullPointer();
  return withPoses(pose, to, [=](Pose& of, const Pose& towards) {
    return answer(of.blend(towards, weight, {part_weights, count}));
  });
}

kelp_result kelp_pose_check(kelp_pose pose) {
  return withPose(pose, [](const Pose& of) { return answer(of.check()); });
}

kelp_result kelp_pose_clamp(kelp_pose pose) {
  return withPose(pose, [](Pose& of) {
    of.clamp();
    return kelp_result{KELP_OK};
  });
}

kelp_result kelp_pose_add_clip(kelp_pose pose, kelp_asset asset, int32_t clip, double seconds, float weight,
                               kelp_play play) {
  if (play != KELP_PLAY_LOOP && play != KELP_PLAY_ONCE) return misuse("there is no such kind of play");
  return withPoseOf(pose, asset, [=](Pose& of, const Asset& whole) {
    return answer(addClip(whole, clip, seconds, weight, of, toEnum<kelp::runtime::Play>(play)));
  });
}
