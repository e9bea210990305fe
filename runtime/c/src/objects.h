// SPDX-License-Identifier: MIT
// The objects behind handles.
#pragma once

#include <atomic>
#include <memory>

#include "handles.h"
#include "kelp/c/planner.h"
#include "kelp/gl/renderer.h"
#include "kelp/runtime/spring.h"
#include "structs.h"

namespace kelp::c {

struct AssetObject {
  static constexpr Kind kKind = Kind::kAsset;
  Allocator allocator;
  kelp_source source;  // of kelp_asset_open; outlives the asset, which reads by it
  std::unique_ptr<runtime::Asset> asset;
};

struct PoseObject {
  static constexpr Kind kKind = Kind::kPose;
  Allocator allocator;
  runtime::Pose pose;
};

struct SpringObject {
  static constexpr Kind kKind = Kind::kSpring;
  Allocator allocator;
  runtime::Spring spring;
};

struct RendererObject {
  static constexpr Kind kKind = Kind::kRenderer;
  Allocator allocator;
  std::atomic<std::uint64_t> thread;
  std::unique_ptr<gl::Renderer> renderer;
};

struct PlannerObject {
  static constexpr Kind kKind = Kind::kPlanner;
  Allocator allocator;
  std::atomic<bool> used = false;  // a thread is in a function of the planner
  std::unique_ptr<draw::Planner> planner;
  // What its functions return pointers to.
  Buffer<kelp_copy> copies;
  Buffer<kelp_call> calls;
  kelp_uniforms uniforms;
};

// call(asset): what a function does with a valid asset.
template <class Call>
kelp_result withAsset(kelp_asset asset, const Call& call) {
  const Pinned<AssetObject> object(asset.id);
  return object ? call(*object->asset) : object.bad();
}

// Copies at most `capacity` values, and says how many there are.
template <class From, class To>
kelp_result copyOut(std::span<const From> from, To* to, std::uint32_t capacity, std::uint32_t* count) {
  static_assert(sizeof(From) == sizeof(To));
  if (!count || (!to && capacity > 0)) return nullPointer();
  if (from.empty()) return misuse("there is no such part");
  if (to) std::memcpy(to, from.data(), std::min<std::size_t>(capacity, from.size()) * sizeof(To));
  *count = static_cast<std::uint32_t>(from.size());
  return KELP_OK;
}

}  // namespace kelp::c
