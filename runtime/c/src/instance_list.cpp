// SPDX-License-Identifier: MIT
#include "instance_list.h"

namespace kelp::c {
namespace {

thread_local InstanceList::Memory spare_memory;

// Of an instance of a list: the last error, with its place.
kelp_result failAt(kelp_result result, std::uint64_t index) {
  kelp_error error = {};
  error.struct_size = sizeof error;
  (void)kelp_last_error(&error);
  return fail(result, error.text, index, KELP_UNIT_INSTANCE);
}

}  // namespace

InstanceList::InstanceList() : memory_(std::move(spare_memory)) {}

InstanceList::~InstanceList() {
  for (const Pins& pins : memory_.pins.span().first(count_)) {
    if (pins.asset) unpin(pins.asset);
    if (pins.pose) unpin(pins.pose);
    if (pins.previous) unpin(pins.previous);
  }
  spare_memory = std::move(memory_);
}

kelp_result InstanceList::read(const kelp_instance* instances, std::uint32_t count) {
  if (count == 0) return KELP_OK;
  if (!instances) return nullPointer();
  if (!memory_.instances.reuse(count) || !memory_.pins.reuse(count)) return noMemory();
  const std::uint32_t stride = instances->struct_size;
  const auto* place = reinterpret_cast<const std::byte*>(instances);
  for (; count_ < count; place += stride) {
    const auto* const from = reinterpret_cast<const kelp_instance*>(place);
    Pins& pins = memory_.pins[count_] = {};
    kelp_instance one;
    kelp_result result = readStruct(from, one);
    if (result == KELP_OK && one.struct_size != stride)
      result = fail(KELP_ERROR_STRUCT_SIZE, "the instances of a list differ in struct_size");
    if (result == KELP_OK) result = readOne(one, memory_.instances[count_], pins);
    ++count_;
    if (result != KELP_OK) return failAt(result, count_ - 1);
  }
  return KELP_OK;
}

kelp_result InstanceList::readOne(const kelp_instance& from, runtime::Instance& to, Pins& pins) {
  to = {};
  pins.asset = pin(from.asset.id, Kind::kAsset);
  if (!pins.asset) return badHandle(from.asset.id);
  to.asset = static_cast<const AssetObject*>(objectOf(pins.asset))->asset.get();
  for (const bool previous : {false, true}) {
    const std::uint64_t id = previous ? from.previous_pose.id : from.pose.id;
    if (id == 0) continue;
    Slot*& pose = previous ? pins.previous : pins.pose;
    pose = pin(id, Kind::kPose);
    if (!pose) return badHandle(id);
    (previous ? to.previous_pose : to.pose) = &static_cast<const PoseObject*>(objectOf(pose))->pose;
  }
  if (from.unsound < KELP_UNSOUND_LEAVE_OUT || from.unsound > KELP_UNSOUND_CLAMP)
    return misuse("there is no such `unsound`");
  to.unsound = static_cast<runtime::Unsound>(from.unsound);
  if (!from.palette && from.palette_count > 0) return nullPointer();
  to.palette = same<Material>(from.palette, from.palette_count);
  to.to_world = glm::make_mat4(from.to_world);
  to.tint = glm::make_vec4(from.tint);
  to.previous_to_world = reinterpret_cast<const glm::mat4*>(from.previous_to_world);
  return KELP_OK;
}

}  // namespace kelp::c
