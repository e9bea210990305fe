// SPDX-License-Identifier: MIT
#include "exercise_pack.h"

#include <cstdint>

#include "kelp/formats/verify.h"
#include "kelp/runtime/instance.h"

void exercisePack(std::span<const std::byte> bytes) {
  using namespace kelp;
  Limits limits;
  limits.max_decoded_bytes = std::uint64_t{64} << 20;
  limits.max_side = 1024;
  limits.max_parts = 64;
  MemorySource memory(bytes);
  verify(memory.source(), limits, [](void*, const Issue&) {}, nullptr);
  auto asset = runtime::Asset::open(memory.source(), {limits, {}});
  if (!asset) return;
  if (!(*asset)->loadAll()) return;
  runtime::Instance instance{asset->get()};
  const Box box = runtime::bounds(instance);
  for (int i = 0; i < 8; ++i) {
    const glm::vec3 corner(i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y, i & 4 ? box.max.z : box.min.z);
    runtime::raycast(instance, {corner, 0.5f * (box.min + box.max) - corner});
  }
  auto pose = runtime::Pose::create(**asset);
  for (int clip = 0; pose && clip < static_cast<int>((*asset)->pack().clips().size()); ++clip) {
    if (runtime::addClip(**asset, clip, 0.3, 1.0f, *pose)) pose->clampMonotone();
  }
}
