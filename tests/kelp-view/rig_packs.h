// SPDX-License-Identifier: MIT
// Packs with rigs, for tests of the rig editor.
#pragma once

#include <gtest/gtest.h>

#include "kelp/rig/rig.h"
#include "support/test_pack.h"

namespace kelp::view {

// The pack that kelp-bake makes of a file whose part is `axis` and stands in its file as `in_file` has it.
inline RawPack packWith(const RigDescription& rig, const glm::mat3& in_file = glm::mat3(1),
                        const std::string& info = "{}", const glm::ivec3& size = {24, 50, 32}) {
  RawPack pack = test::packOf(test::ballClump(size, 12, 1));
  RawPart& part = pack.parts[0];
  part.to_object =
      glm::mat4x3(glm::mat4(in_file * glm::transpose(axisRotation(rig.axis.value_or(Axis::kPlusY))) * 0.02f));
  const RawRig rest = realizeRig(rig);
  part.knots = rest.knots;
  part.automatic_tangents = rest.automatic_tangents;
  part.bend = rest.bend;
  part.roll = rest.roll;
  pack.clips = realizeClips(rig, 0);
  pack.sockets = realizeSockets(rig, 0);
  pack.info_json = info;
  return pack;
}

struct OpenPack {
  explicit OpenPack(const RawPack& raw)
      : bytes(test::bytesOf(raw)), memory(bytes), pack(Pack::open(memory.source())) {}
  std::vector<std::byte> bytes;
  MemorySource memory;
  Result<Pack> pack;
};

inline void expectNear(const glm::vec3& a, const glm::vec3& b, float tolerance) {
  EXPECT_LT(glm::distance(a, b), tolerance) << a.x << " " << a.y << " " << a.z;
}

}  // namespace kelp::view
