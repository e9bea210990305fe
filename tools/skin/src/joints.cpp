// SPDX-License-Identifier: MIT
#include "joints.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "key_choice.h"
#include "keys.h"

namespace kelp::bake {
namespace {

// Joints of one name are told apart.
std::vector<std::string> uniqueNames(const SourceSkin& skin) {
  std::set<std::string> taken;
  std::vector<std::string> names;
  for (const SourceSkin::Joint& joint : skin.joints) {
    std::string name = joint.name;
    for (int k = 2; !taken.insert(name).second; ++k) name = joint.name + "." + std::to_string(k);
    names.push_back(name);
  }
  return names;
}

// The axes about which a joint's node moves, as it is placed in the bind pose.
glm::dmat4x3 pivotOf(const SourceSkin::Joint& joint) {
  const Trs placed = nearestTrs(glm::dmat4x3(glm::inverse(joint.base) * joint.frame));
  const glm::dmat4x3 pivot(joint.base * glm::dmat4(Trs{placed.translation, placed.rotation}.matrix()));
  // Axes that floats cannot tell from a plane serve nobody.
  constexpr double kFlattest = 1e-4;
  const glm::dmat3 axes = linearOf(pivot);
  const double lengths = glm::length(axes[0]) * glm::length(axes[1]) * glm::length(axes[2]);
  if (std::abs(glm::determinant(axes)) > kFlattest * lengths) return pivot;
  return {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1), pivot[3]};
}

}  // namespace

std::vector<SkinJoint> jointsOfSkin(const SourceSkin& skin, std::span<const SkinNode> nodes, double tolerance,
                                    int threads) {
  const std::vector<std::string> names = uniqueNames(skin);
  std::vector<glm::dmat4x3> pivots;
  std::vector<SkinJoint> joints;
  for (std::size_t j = 0; j < skin.joints.size(); ++j) {
    pivots.push_back(pivotOf(skin.joints[j]));
    joints.push_back({names[j], skin.joints[j].parent, pivots.back(), {}});
  }
  for (std::size_t clip = 0; clip < skin.clips.size(); ++clip) {
    std::vector<RigDescription::Clip> of_joints = makeSkinKeys(skin, clip, pivots, nodes, tolerance, threads);
    for (std::size_t j = 0; j < joints.size(); ++j) joints[j].rig.clips.push_back(std::move(of_joints[j]));
  }
  return joints;
}

std::vector<glm::dmat4x3> keyedMotions(std::span<const SkinJoint> joints, std::size_t clip, double time) {
  std::vector<glm::dmat4x3> motions;
  for (const SkinJoint& joint : joints) {
    const glm::dmat4x3 to_pivot(glm::inverse(glm::dmat4(joint.pivot)));
    const glm::dmat4x3 local = joint.pivot *
                               glm::dmat4(motionOfTracks(joint.rig.clips[clip].tracks, time).matrix()) *
                               glm::dmat4(to_pivot);
    motions.push_back(joint.parent < 0 ? local
                                       : motions[static_cast<std::size_t>(joint.parent)] * glm::dmat4(local));
  }
  return motions;
}

}  // namespace kelp::bake
