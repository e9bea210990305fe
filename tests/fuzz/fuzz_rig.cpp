// SPDX-License-Identifier: MIT
// Any bytes as a rig file's JSON: read it; what is read must print and read again as the same, and its clips
// must prove or refuse quickly.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "kelp/rig/rig_file.h"

namespace {

using namespace kelp;

void use(const RigDescription& rig, const glm::ivec3& voxels) {
  if (!(parseRig(printRig(rig)) == rig)) std::abort();
  const RestRig rest = realizeRig(rig);
  const std::vector<RawSocket> sockets = realizeSockets(rig, 0);
  const RigDescription back = describeRig(rest, {}, 0, rig.axis.value_or(Axis::kPlusY), sockets);
  if (back.parent_at != rig.parent_at || back.sockets.size() != rig.sockets.size()) std::abort();
  if (back.bend != rest.bend || back.roll != rest.roll) std::abort();
  if (!(parseRig(printRig(back)) == back)) std::abort();
  for (const RawClip& clip : realizeClips(rig, 0)) proveClip(clip, 0, rest, voxels);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr glm::ivec3 kSizes[] = {{32, 64, 32}, {1, 1, 1}, {8192, 8192, 8192}, {3, 8192, 1}};
  try {
    const RigFile file = parseRigFile({reinterpret_cast<const char*>(data), size});
    if (!(parseRigFile(printRigFile(file)) == file)) std::abort();
    use(file.whole, kSizes[size % 4]);
    for (const RigFile::PartRig& part : file.parts) use(part.rig, kSizes[size % 4]);
  } catch (const RigError&) {
  }
  return 0;
}
