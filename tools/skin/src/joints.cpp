// SPDX-License-Identifier: MIT
#include "joints.h"

namespace kelp::bake {
std::vector<SkinJoint> jointsOfSkin(const SourceSkin& skin, std::span<const SkinNode>, double, int) {
  std::vector<SkinJoint> out;
  for (const auto& j : skin.joints) {
    SkinJoint& to = out.emplace_back();
    to.name = j.name + std::to_string(out.size());
    to.parent = j.parent;
    to.pivot[3] = j.origin;
    for (const auto& c : skin.clips) {
      auto& clip = to.rig.clips.emplace_back();
      clip.name = c.name;
      clip.duration = c.duration;
    }
  }
  return out;
}
void limitJoints(SourceSkin&, std::size_t, std::vector<std::string>&) {}
}  // namespace kelp::bake
