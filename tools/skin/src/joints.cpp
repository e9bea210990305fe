// SPDX-License-Identifier: MIT
#include "joints.h"

#include <algorithm>
#include <limits>
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

// How much each joint moves: vertices by their weights, and sockets.
std::vector<double> usesOf(const SourceSkin& skin) {
  std::vector<double> uses(skin.joints.size(), 0);
  for (const SourceSkin::Influence& influence : skin.influences)
    uses[influence.joint] += static_cast<double>(influence.weight);
  for (const SourceSkin::Socket& socket : skin.sockets) uses[socket.joint] += 1;
  return uses;
}

// The joints that limitJoints() keeps.
std::vector<bool> keptJoints(const SourceSkin& skin, std::size_t most, std::vector<std::string>& notices) {
  const std::size_t count = skin.joints.size();
  std::vector<double> uses = usesOf(skin);
  std::vector<bool> kept(count, false);
  for (std::size_t j = count; j-- > 0;) {
    if (uses[j] > 0) kept[j] = true;
    if (kept[j] && skin.joints[j].parent >= 0) kept[static_cast<std::size_t>(skin.joints[j].parent)] = true;
  }
  const auto needed = static_cast<std::size_t>(std::count(kept.begin(), kept.end(), true));
  if (needed == 0) kept[0] = true;
  if (needed <= most) return kept;
  // Roots stay, so that what follows a joint that goes has one above it to follow.
  for (std::size_t j = 0; j < count; ++j)
    if (skin.joints[j].parent < 0) uses[j] = std::numeric_limits<double>::infinity();
  std::vector<std::size_t> order;
  for (std::size_t j = 0; j < count; ++j)
    if (kept[j]) order.push_back(j);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return uses[a] > uses[b]; });
  for (std::size_t i = most; i < order.size(); ++i) kept[order[i]] = false;
  notices.push_back("the skin has " + std::to_string(count) + " joints, and a pack holds " +
                    std::to_string(most) + ": what the others move follows the joints above them");
  return kept;
}

}  // namespace

void limitJoints(SourceSkin& skin, std::size_t most, std::vector<std::string>& notices) {
  const std::size_t count = skin.joints.size();
  if (count <= most) return;
  const std::vector<bool> kept = keptJoints(skin, most, notices);
  const auto first = static_cast<std::size_t>(std::find(kept.begin(), kept.end(), true) - kept.begin());
  constexpr int kNone = -1;
  std::vector<int> above(count, kNone), place(count, kNone);  // of each: the nearest kept one; its new index
  std::vector<SourceSkin::Joint> joints;
  for (std::size_t j = 0; j < count; ++j) {
    const int parent = skin.joints[j].parent;
    above[j] = kept[j] ? static_cast<int>(j) : parent < 0 ? kNone : above[static_cast<std::size_t>(parent)];
    if (!kept[j]) continue;
    place[j] = static_cast<int>(joints.size());
    joints.push_back(skin.joints[j]);
    const int kept_parent = parent < 0 ? kNone : above[static_cast<std::size_t>(parent)];
    joints.back().parent = kept_parent < 0 ? -1 : place[static_cast<std::size_t>(kept_parent)];
  }
  for (SourceSkin::Clip& clip : skin.clips) {
    std::vector<glm::dmat4x3> locals, within(count);
    for (std::size_t t = 0; t < clip.times.size(); ++t)
      for (std::size_t j = 0; j < count; ++j) {
        const int parent = skin.joints[j].parent;
        within[j] = clip.locals[t * count + j];  // its nearest kept parent's motion
        if (parent >= 0 && !kept[static_cast<std::size_t>(parent)])
          within[j] = within[static_cast<std::size_t>(parent)] * glm::dmat4(within[j]);
        if (kept[j]) locals.push_back(within[j]);
      }
    clip.locals = std::move(locals);
    std::vector<glm::dquat> turns;
    for (std::size_t i = 0; i < clip.turns.size(); ++i)
      if (kept[i % count]) turns.push_back(clip.turns[i]);
    clip.turns = std::move(turns);
  }
  const auto follow = [&](std::uint32_t& joint) {
    const int to = above[joint];
    joint = static_cast<std::uint32_t>(place[to < 0 ? first : static_cast<std::size_t>(to)]);
  };
  for (SourceSkin::Influence& influence : skin.influences) follow(influence.joint);
  for (SourceSkin::Socket& socket : skin.sockets) follow(socket.joint);
  skin.joints = std::move(joints);
}

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
