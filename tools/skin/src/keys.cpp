// SPDX-License-Identifier: MIT
#include "keys.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "kelp/common/parallel.h"
#include "key_choice.h"

namespace kelp::bake {
namespace {

// Points by which the keys of a joint are chosen: those farthest out in so many directions.
constexpr std::array<glm::dvec3, 14> kDirections{{{1, 0, 0},
                                                  {-1, 0, 0},
                                                  {0, 1, 0},
                                                  {0, -1, 0},
                                                  {0, 0, 1},
                                                  {0, 0, -1},
                                                  {1, 1, 1},
                                                  {1, 1, -1},
                                                  {1, -1, 1},
                                                  {1, -1, -1},
                                                  {-1, 1, 1},
                                                  {-1, 1, -1},
                                                  {-1, -1, 1},
                                                  {-1, -1, -1}}};
constexpr double kLoose = 8;          // joints that move no node
constexpr double kNothing = 1e-12;    // a volume, of one
constexpr double kStill = 1e-9;       // of the size: what moves less does not move
constexpr double kLeastWeight = 0.1;  // of nodes by which keys are chosen, where there are such

// A place that a joint moves.
struct Watched {
  std::uint32_t joint = 0;
  glm::dvec3 at{0};
  std::size_t node = 0;
};

std::size_t at(int index) { return static_cast<std::size_t>(index); }

// Those that are farthest out in the directions, each once.
std::vector<Watched> farthestOf(const std::vector<Watched>& all) {
  std::vector<Watched> out;
  if (all.empty()) return out;
  for (const glm::dvec3& direction : kDirections) {
    const Watched& its = *std::max_element(all.begin(), all.end(), [&](const Watched& a, const Watched& b) {
      return glm::dot(direction, a.at) < glm::dot(direction, b.at);
    });
    if (std::none_of(out.begin(), out.end(),
                     [&](const Watched& other) { return its.at == other.at && its.joint == other.joint; }))
      out.push_back(its);
  }
  return out;
}

class ClipKeys {
 public:
  ClipKeys(const SourceSkin& skin, std::size_t clip, std::span<const glm::dmat4x3> pivots,
           std::span<const SkinNode> nodes, int threads)
      : skin_(skin),
        clip_(skin.clips[clip]),
        pivots_(pivots),
        nodes_(nodes),
        threads_(threads),
        count_(skin.joints.size()) {
    for (const glm::dmat4x3& pivot : pivots) to_pivots_.emplace_back(glm::inverse(glm::dmat4(pivot)));
    measureSize();
    takeApart();
    watch();
    countMoving();
  }

  // Chosen with less tolerance for each joint, or more, until all together keep it. Where floats cannot,
  // those that are nearest.
  std::vector<std::vector<RigDescription::Track>> make(double tolerance) const {
    constexpr int kRounds = 4, kMostRounds = 12;
    std::vector<std::vector<RigDescription::Track>> best;
    double share = 1.5, least = INFINITY;
    for (int round = 0; round < (least <= tolerance ? kRounds : kMostRounds); ++round) {
      std::vector<std::vector<RigDescription::Track>> tracks = tracksFor(share * tolerance);
      double worst = farthest(tracks, outer_);
      if (worst <= tolerance) worst = farthest(tracks, nodes_);
      // Of those that keep it, the last: shares only grow then.
      if (worst <= tolerance || worst < least) {
        best = std::move(tracks);
        least = worst;
      }
      if (worst <= tolerance && worst >= 0.85 * tolerance) break;
      share *= worst > 0 ? std::clamp(0.94 * tolerance / worst, 0.2, 2.0) : 2;
    }
    return best;
  }

 private:
  void measureSize() {
    glm::dvec3 low(INFINITY), high(-INFINITY);
    for (const SkinNode& node : nodes_) {
      low = glm::min(low, node.at);
      high = glm::max(high, node.at);
    }
    if (!nodes_.empty()) size_ = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
  }

  void takeApart() {
    poses_.resize(clip_.locals.size());
    motions_.resize(clip_.locals.size());
    std::vector<glm::dquat> at_rest;  // of the nodes that turn, as the pivots have them
    for (const SourceSkin::Joint& joint : skin_.joints)
      at_rest.push_back(nearestTrs(glm::dmat4x3(glm::inverse(joint.base) * joint.frame)).rotation);
    for (std::size_t t = 0; t < clip_.times.size(); ++t)
      for (std::size_t j = 0; j < count_; ++j) {
        const std::size_t i = t * count_ + j;
        poses_[i] = nearestTrs(to_pivots_[j] * glm::dmat4(clip_.locals[i]) * glm::dmat4(pivots_[j]),
                               glm::conjugate(at_rest[j]) * clip_.turns[i]);
        const glm::dquat before = t == 0 ? glm::dquat(1, 0, 0, 0) : poses_[i - count_].rotation;
        if (glm::dot(poses_[i].rotation, before) < 0) poses_[i].rotation = -poses_[i].rotation;
        const glm::dmat4x3 local = localOf(poses_[i], j);
        const int parent = skin_.joints[j].parent;
        motions_[i] = parent < 0 ? local : motions_[t * count_ + at(parent)] * glm::dmat4(local);
      }
  }

  glm::dmat4x3 localOf(const Trs& pose, std::size_t j) const {
    return pivots_[j] * glm::dmat4(pose.matrix()) * glm::dmat4(to_pivots_[j]);
  }

  // The nodes by which each joint's keys are chosen: of those that it or joints below it move.
  void watch() {
    watched_.resize(count_);
    std::vector<double> heaviest(count_, 0);
    for (const SkinNode& node : nodes_)
      for (std::size_t k = 0; k < 4; ++k)
        heaviest[node.joints[k]] = std::max(heaviest[node.joints[k]], node.weights[k]);
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      for (std::size_t k = 0; k < 4; ++k) {
        const std::uint32_t joint = nodes_[i].joints[k];
        if (nodes_[i].weights[k] > 0 && nodes_[i].weights[k] >= std::min(kLeastWeight, 0.5 * heaviest[joint]))
          watched_[joint].push_back({joint, nodes_[i].at, i});
      }
    for (const SourceSkin::Socket& socket : skin_.sockets)
      watched_[socket.joint].push_back({socket.joint, glm::dvec3(socket.place[3]), nodes_.size()});
    std::vector<bool> outer(nodes_.size() + 1, false);
    for (std::vector<Watched>& its : watched_) {
      its = farthestOf(its);
      for (const Watched& watched : its) outer[watched.node] = true;
    }
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (outer[i]) outer_.push_back(nodes_[i]);
    loose_.resize(count_);
    for (std::size_t j = count_; j-- > 0;) {
      loose_[j] = watched_[j].empty();
      if (loose_[j]) {
        constexpr double kReach = 1.0 / 32;
        const glm::dvec3 middle = pivots_[j][3];
        for (std::size_t d = 0; d < 6; ++d)
          watched_[j].push_back({static_cast<std::uint32_t>(j), middle + kReach * size_ * kDirections[d], 0});
        continue;
      }
      watched_[j] = farthestOf(watched_[j]);
      if (const int parent = skin_.joints[j].parent; parent >= 0)
        watched_[at(parent)].insert(watched_[at(parent)].end(), watched_[j].begin(), watched_[j].end());
    }
  }

  // Errors add up along chains: how many of its joints move.
  void countMoving() {
    std::vector<bool> moving(count_, false);
    for (std::size_t t = 1; t < clip_.times.size(); ++t)
      for (std::size_t j = 0; j < count_; ++j) {
        const glm::dmat4x3 off = clip_.locals[t * count_ + j] - clip_.locals[j];
        const glm::dvec3 middle = pivots_[j][3];
        double most = glm::length(off * glm::dvec4(middle, 1));
        for (int axis = 0; axis < 3; ++axis) most = std::max(most, size_ * glm::length(off[axis]));
        if (most > kStill * size_) moving[j] = true;
      }
    std::vector<int> above(count_, 0), below(count_, 0);
    for (std::size_t j = 0; j < count_; ++j) {
      const int parent = skin_.joints[j].parent;
      above[j] = (parent < 0 ? 0 : above[at(parent)]) + (moving[j] ? 1 : 0);
    }
    for (std::size_t j = count_; j-- > 0;) {
      const int parent = skin_.joints[j].parent, its = below[j] + (moving[j] ? 1 : 0);
      if (parent >= 0 && !loose_[j]) below[at(parent)] = std::max(below[at(parent)], its);
    }
    constexpr double kHeld = 0.02;  // one key costs nothing
    for (std::size_t j = 0; j < count_; ++j)
      shares_.push_back((loose_[j] ? kLoose : 1) * (moving[j] ? 1.0 / (above[j] + below[j]) : kHeld));
  }

  KeyedMotion motionOf(std::size_t j) const {
    KeyedMotion motion;
    motion.points = watched_[j].size();
    motion.places.reserve(clip_.times.size() * motion.points);
    const int parent = skin_.joints[j].parent;
    glm::dmat4x3 back(1);
    for (std::size_t t = 0; t < clip_.times.size(); ++t) {
      const glm::dmat4x3* const motions = &motions_[t * count_];
      motion.poses.push_back(poses_[t * count_ + j]);
      motion.spread.push_back(linearOf(parent < 0 ? pivots_[j] : motions[parent] * glm::dmat4(pivots_[j])));
      // From where points below the joint are, to the joint at rest. At a moment when the joint shrinks all
      // to nothing there is no way back: then as at the moment before.
      const bool regular = std::abs(glm::determinant(linearOf(motions[j]))) > kNothing;
      if (regular) back = to_pivots_[j] * glm::dmat4(glm::dmat4x3(glm::inverse(glm::dmat4(motions[j]))));
      for (std::size_t i = 0; i < motion.points; ++i) {
        const Watched& its = watched_[j][i];
        motion.places.push_back(regular  ? back * glm::dvec4(motions[its.joint] * glm::dvec4(its.at, 1), 1)
                                : t == 0 ? to_pivots_[j] * glm::dvec4(its.at, 1)
                                         : motion.places[(t - 1) * motion.points + i]);
      }
    }
    return motion;
  }

  std::vector<std::vector<RigDescription::Track>> tracksFor(double tolerance) const {
    std::vector<std::vector<RigDescription::Track>> tracks(count_);
    parallelRanges(count_, 1, threads_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t j = begin; j < end; ++j)
        tracks[j] = chooseTracks(motionOf(j), clip_.times, shares_[j] * tolerance);
    });
    return tracks;
  }

  // How far the tracks put any of the nodes, or a socket, from where the joints do, at any time.
  double farthest(const std::vector<std::vector<RigDescription::Track>>& tracks,
                  std::span<const SkinNode> nodes) const {
    std::vector<double> worst(clip_.times.size(), 0);
    parallelRanges(worst.size(), 16, threads_, [&](std::size_t begin, std::size_t end) {
      std::vector<glm::dmat4x3> keyed(count_), off(count_);
      for (std::size_t t = begin; t < end; ++t) {
        for (std::size_t j = 0; j < count_; ++j) {
          const glm::dmat4x3 its = localOf(motionOfTracks(tracks[j], static_cast<double>(clip_.times[t])), j);
          const int parent = skin_.joints[j].parent;
          keyed[j] = parent < 0 ? its : keyed[at(parent)] * glm::dmat4(its);
          off[j] = keyed[j] - motions_[t * count_ + j];
        }
        double most = 0;
        for (const SkinNode& node : nodes) {
          glm::dvec3 moved(0);
          for (std::size_t k = 0; k < 4; ++k)
            if (node.weights[k] > 0)
              moved += node.weights[k] * (off[node.joints[k]] * glm::dvec4(node.at, 1));
          most = std::max(most, glm::dot(moved, moved));
        }
        for (const SourceSkin::Socket& socket : skin_.sockets) {
          const glm::dvec3 moved = off[socket.joint] * glm::dvec4(glm::dvec3(socket.place[3]), 1);
          most = std::max(most, glm::dot(moved, moved));
        }
        worst[t] = std::sqrt(most);
      }
    });
    return *std::max_element(worst.begin(), worst.end());
  }

  const SourceSkin& skin_;
  const SourceSkin::Clip& clip_;
  const std::span<const glm::dmat4x3> pivots_;
  const std::span<const SkinNode> nodes_;
  const int threads_;
  const std::size_t count_;
  std::vector<glm::dmat4x3> to_pivots_;
  double size_ = 1;
  std::vector<Trs> poses_;             // of time t and joint j at [t * count_ + j]
  std::vector<glm::dmat4x3> motions_;  // of these, with those above
  std::vector<std::vector<Watched>> watched_;
  std::vector<SkinNode> outer_;  // the nodes that are farthest out, of each joint
  std::vector<bool> loose_;
  std::vector<double> shares_;  // of the tolerance
};

}  // namespace

std::vector<RigDescription::Clip> makeSkinKeys(const SourceSkin& skin, std::size_t clip,
                                               std::span<const glm::dmat4x3> pivots,
                                               std::span<const SkinNode> nodes, double tolerance,
                                               int threads) {
  const ClipKeys keys(skin, clip, pivots, nodes, threads);
  std::vector<RigDescription::Clip> clips;
  for (std::vector<RigDescription::Track>& tracks : keys.make(tolerance))
    clips.push_back({skin.clips[clip].name, skin.clips[clip].duration, {}, std::move(tracks)});
  return clips;
}

}  // namespace kelp::bake
