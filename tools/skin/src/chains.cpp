// SPDX-License-Identifier: MIT
#include "chains.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "collapse.h"
#include "sweep_fit.h"

namespace kelp::bake {
namespace {

constexpr double kLeastSurface = 1;    // square units: joints that move less do not count
constexpr double kLeastShared = 0.03;  // of the smaller one's weight, between a joint and its child
constexpr double kLeastBone = 2;       // units: joints that are nearer make one bone
constexpr std::size_t kMostKnots = 24;
constexpr double kMoreKnotsGain = 0.9;  // more knots are taken if they lower the cost to this share
constexpr double kFartherOff = 1.5, kNearEnough = 0.3;  // square units
constexpr int kMostTries = 4;                           // with a chain, each with fewer joints
constexpr double kMostTurn = 0.26;                      // the cosine of 75 degrees, in the bind pose

// How much surface each joint moves, and shares with the joint above that moves some.
struct Weights {
  std::vector<double> own, shared;
  std::vector<int> above;  // the nearest joint above that counts, or -1
};

Weights weigh(const SkinSamples& samples, const SourceSkin& skin) {
  Weights weights;
  const std::size_t count = skin.joints.size();
  weights.own.assign(count, 0);
  weights.shared.assign(count, 0);
  for (std::size_t i = 0; i < samples.size(); ++i)
    for (std::size_t k = samples.first_weighted[i]; k < samples.first_weighted[i + 1]; ++k)
      weights.own[samples.weighted[k].joint] += samples.areas[i] * samples.weighted[k].x.w;
  for (const SourceSkin::Joint& joint : skin.joints) {
    int above = joint.parent;
    while (above >= 0 && weights.own[static_cast<std::size_t>(above)] < kLeastSurface)
      above = skin.joints[static_cast<std::size_t>(above)].parent;
    weights.above.push_back(above);
  }
  for (std::size_t i = 0; i < samples.size(); ++i)
    for (std::size_t k = samples.first_weighted[i]; k < samples.first_weighted[i + 1]; ++k) {
      const std::uint32_t joint = samples.weighted[k].joint;
      if (weights.above[joint] < 0) continue;
      const double other = samples.weight(i, static_cast<std::uint32_t>(weights.above[joint]));
      weights.shared[joint] += samples.areas[i] * std::min(samples.weighted[k].x.w, other);
    }
  return weights;
}

// How well rigid parts, or one swept part, follow the surface of a chain: square distances times area, and
// the lengths of the seams that are inside, as in the decomposition. Here their square steps count too.
struct Costs {
  double errors = 0, seams = 0;
};
Costs rigidCosts(const SkinSamples& samples, const SkinMoments& moments, const SkinLabels& labels,
                 const std::vector<std::uint32_t>& along) {
  std::map<std::uint32_t, std::vector<std::uint32_t>> members;  // of each part
  for (const std::uint32_t i : along) members[labels.parts[i]].push_back(i);
  Costs costs;
  std::map<std::uint32_t, std::vector<glm::dmat4x3>> motions;
  const double share = 1 / static_cast<double>(moments.size());
  for (const auto& [part, its] : members) {
    const std::vector<glm::dmat4x3>& motion = motions[part] =
        fitMotions(samples, moments, its, labels.joints[part]);
    for (std::size_t t = 0; t < moments.size(); ++t)
      for (const std::uint32_t i : its) {
        const glm::dvec3 off =
            motion[t] * glm::dvec4(samples.positions[i], 1) - skinnedPoint(samples, i, moments, t);
        costs.errors += samples.areas[i] * glm::dot(off, off) * share;
      }
  }
  for (const std::uint32_t i : along)
    for (std::size_t k = samples.first_neighbor[i]; k < samples.first_neighbor[i + 1]; ++k) {
      const auto& [other, width] = samples.neighbors[k];
      // Each pair once, of two parts along the chain.
      if (other < i || labels.parts[other] == labels.parts[i] || !members.contains(labels.parts[other]))
        continue;
      costs.seams += width;
      const glm::dvec4 x(0.5 * (samples.positions[i] + samples.positions[other]), 1);
      const auto &a = motions[labels.parts[i]], &b = motions[labels.parts[other]];
      for (std::size_t t = 0; t < moments.size(); ++t) {
        const glm::dvec3 step = a[t] * x - b[t] * x;
        costs.seams += width * glm::dot(step, step) * share;
      }
    }
  return costs;
}

std::optional<double> sweptCost(const SkinSamples& samples, const SkinMoments& moments,
                                const SkinSweep& sweep, const std::vector<std::uint32_t>& members,
                                int threads) {
  const SweepFit fit(samples, sweep, members);
  const SweepFit::Poses poses = fit.poses(moments, threads);
  if (poses.fold()) return std::nullopt;
  double area = 0, sum = 0;
  for (const std::uint32_t i : members) area += samples.areas[i];
  for (std::size_t t = 0; t < moments.size(); ++t) sum += fit.meanSquare(poses.of_moments[t], moments, t);
  return area * sum / static_cast<double>(moments.size());
}

// The best swept part along the joints, in place of rigid ones; none if these are better.
bool sweepChain(const SkinSamples& samples, const SourceSkin& skin, const SkinMoments& moments,
                const SkinSpace& space, int threads, const std::vector<std::uint32_t>& joints,
                SkinLabels& labels) {
  std::vector<bool> inside;
  for (std::size_t p = 0; p < labels.joints.size(); ++p)
    inside.push_back(!labels.chains[p].swept() &&
                     std::find(joints.begin(), joints.end(), labels.joints[p]) != joints.end());
  if (std::count(inside.begin(), inside.end(), true) < 2) return false;
  std::vector<std::uint32_t> along;
  for (std::uint32_t i = 0; i < samples.size(); ++i)
    if (inside[labels.parts[i]]) along.push_back(i);
  const Costs rigid = rigidCosts(samples, moments, labels, along);
  // Closed seams do not make up for a surface that is much farther off, unless that is near enough.
  double area = 0;
  for (const std::uint32_t i : along) area += samples.areas[i];
  double best =
      std::min(rigid.errors + rigid.seams, std::max(kFartherOff * rigid.errors, kNearEnough * area));
  SkinChain chain;
  for (const std::size_t knots : {joints.size() + 2, 2 * joints.size() + 2}) {
    const SkinChain candidate{joints, std::min(knots, kMostKnots)};
    const std::optional<SkinSweep> sweep = makeSweep(samples, skin, space, along, candidate);
    if (!sweep) continue;
    const std::optional<double> cost = sweptCost(samples, moments, *sweep, along, threads);
    if (!cost || *cost > best) continue;
    chain = candidate;
    best = kMoreKnotsGain * *cost;
  }
  if (!chain.swept()) return false;
  joinParts(inside, chain, labels);
  return true;
}

}  // namespace

std::vector<std::vector<std::uint32_t>> findChains(const SkinSamples& samples, const SourceSkin& skin,
                                                   const SkinSpace& space) {
  const Weights weights = weigh(samples, skin);
  const std::size_t count = skin.joints.size();
  std::vector<int> children(count, 0), below(count, -1);
  for (std::size_t j = 0; j < count; ++j) {
    if (weights.own[j] < kLeastSurface || weights.above[j] < 0) continue;
    const auto above = static_cast<std::size_t>(weights.above[j]);
    ++children[above];
    below[above] = static_cast<int>(j);
  }
  // True if the joint continues the chain of the joint above.
  const auto linked = [&](std::size_t j) {
    if (weights.own[j] < kLeastSurface || weights.above[j] < 0) return false;
    const auto above = static_cast<std::size_t>(weights.above[j]);
    return children[above] == 1 &&
           weights.shared[j] >= kLeastShared * std::min(weights.own[j], weights.own[above]);
  };
  const auto origin = [&](std::size_t j) {
    return glm::dvec3(space.from_soup * glm::dvec4(skin.joints[j].origin, 1));
  };
  std::vector<std::vector<std::uint32_t>> chains;
  for (std::size_t j = 0; j < count; ++j) {
    if (weights.own[j] < kLeastSurface || linked(j)) continue;
    std::vector<std::uint32_t> chain{static_cast<std::uint32_t>(j)};
    // Bones go between joints that are far enough apart; `corner` is where in the chain the last one ends.
    std::size_t corner = 0;
    glm::dvec3 direction(0);
    const auto end = [&] {
      if (direction != glm::dvec3(0)) chains.push_back(chain);
    };
    for (std::size_t at = j; children[at] == 1 && linked(static_cast<std::size_t>(below[at]));) {
      at = static_cast<std::size_t>(below[at]);
      chain.push_back(static_cast<std::uint32_t>(at));
      const glm::dvec3 bone = origin(at) - origin(chain[corner]);
      if (glm::length(bone) < kLeastBone) continue;
      if (direction != glm::dvec3(0) && glm::dot(direction, glm::normalize(bone)) < kMostTurn) {
        const std::vector<std::uint32_t> rest(chain.begin() + static_cast<std::ptrdiff_t>(corner),
                                              chain.end());
        chain.resize(corner);
        if (chain.size() > 1) end();
        chain = rest;
      }
      direction = glm::normalize(bone);
      corner = chain.size() - 1;
    }
    end();
  }
  return chains;
}

void joinParts(const std::vector<bool>& inside, const SkinChain& chain, SkinLabels& labels) {
  SkinLabels joined;
  joined.parts = labels.parts;
  std::vector<std::uint32_t> place(inside.size());
  std::optional<std::uint32_t> swept;
  for (std::uint32_t p = 0; p < inside.size(); ++p) {
    place[p] = inside[p] && swept ? *swept : static_cast<std::uint32_t>(joined.joints.size());
    if (inside[p] && swept) continue;
    joined.joints.push_back(inside[p] ? chain.joints.front() : labels.joints[p]);
    joined.chains.push_back(inside[p] ? chain : labels.chains[p]);
    if (inside[p]) swept = place[p];
  }
  for (std::uint32_t& part : joined.parts) part = place[part];
  labels = std::move(joined);
}

void sweepChains(const SkinSamples& samples, const SourceSkin& skin, const SkinMoments& moments,
                 const SkinSpace& space, int threads, const StiffChains& stiff, SkinLabels& labels) {
  if (moments.size() == 0) return;
  const std::vector<bool> scaling = scalingJoints(skin, kSweptScale);
  // Where the end of a chain does not bend with it, as a foot on a leg, the rest may.
  for (std::vector<std::uint32_t>& chain : findChains(samples, skin, space))
    for (int tries = 0; tries < kMostTries && chain.size() > 1; ++tries) {
      // A swept part keeps its thickness.
      const bool scales = std::ranges::any_of(chain, [&](std::uint32_t joint) { return scaling[joint]; });
      if (!scales && !stiff.contains(chain.front()) &&
          sweepChain(samples, skin, moments, space, threads, chain, labels))
        break;
      chain.resize(chain.size() - std::max<std::size_t>(1, chain.size() / 4));
    }
}

}  // namespace kelp::bake
