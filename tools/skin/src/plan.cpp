// SPDX-License-Identifier: MIT
#include "plan.h"

#include <algorithm>
#include <set>
#include <utility>

#include "chains.h"
#include "kelp/common/parallel.h"
#include "partition.h"
#include "sweep_fit.h"

namespace kelp::bake {
namespace {

constexpr int kRoundsOfPlan = 8, kRoundsOfPiece = 4;

std::string placeOfGroup(std::size_t group) { return "/skin/parts/" + std::to_string(group); }

[[noreturn]] void failAtJoint(std::size_t group, std::size_t joint, const std::string& what) {
  throw RigError(placeOfGroup(group) + "/joints/" + std::to_string(joint) + ": " + what);
}

// Some of the names, for a message.
std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 12;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i) text += (i ? ", '" : "'") + names[i] + "'";
  if (names.size() > kMost) text += " and " + std::to_string(names.size() - kMost) + " more";
  return text;
}

bool isBelow(const SourceSkin& skin, std::uint32_t joint, std::uint32_t above) {
  int at = skin.joints[joint].parent;
  while (at >= 0 && at != static_cast<int>(above)) at = skin.joints[static_cast<std::size_t>(at)].parent;
  return at >= 0;
}

std::vector<int> depthsOf(const SourceSkin& skin) {
  std::vector<int> depths;
  for (const SourceSkin::Joint& joint : skin.joints)
    depths.push_back(joint.parent < 0 ? 0 : depths[static_cast<std::size_t>(joint.parent)] + 1);
  return depths;
}

// The part of each sample is that of the group which moves it most.
SkinLabels seedsOf(const SkinSamples& samples, const SkinPlan& plan) {
  constexpr std::uint32_t kNone = 0xffffffffu;
  std::vector<std::uint32_t> part_of(plan.lead.size(), kNone);
  SkinLabels labels;
  std::map<std::uint32_t, double> weights;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    weights.clear();
    for (std::size_t k = samples.first_weighted[i]; k < samples.first_weighted[i + 1]; ++k)
      weights[plan.lead[samples.weighted[k].joint]] += samples.weighted[k].x.w;
    const std::uint32_t lead =
        std::max_element(weights.begin(), weights.end(), [](const auto& a, const auto& b) {
          return a.second < b.second;
        })->first;
    if (part_of[lead] == kNone) {
      part_of[lead] = static_cast<std::uint32_t>(labels.joints.size());
      labels.joints.push_back(lead);
    }
    labels.parts.push_back(part_of[lead]);
  }
  return labels;
}

SkinLabels withGroups(SkinLabels labels, const SkinPlan& plan) {
  labels.chains.clear();
  for (const std::uint32_t joint : labels.joints) {
    const SkinPlan::Group& group = plan.groups[plan.group_of[joint]];
    labels.chains.push_back(group.knots > 0 ? SkinChain() : SkinChain{group.joints, 0});
  }
  return labels;
}

std::vector<std::size_t> countParts(const SkinPlan& plan, const SkinLabels& labels) {
  std::vector<std::size_t> counts(plan.groups.size(), 0);
  for (const std::uint32_t joint : labels.joints) ++counts[plan.group_of[joint]];
  return counts;
}

}  // namespace

std::vector<std::string> jointNames(const SourceSkin& skin) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  std::map<std::string, int> last;
  for (const SourceSkin::Joint& joint : skin.joints) {
    std::string name = joint.name;
    while (!taken.insert(name).second)
      name = joint.name + "." + std::to_string(++last.try_emplace(joint.name, 1).first->second);
    names.push_back(std::move(name));
  }
  return names;
}

SkinPlan planOf(const SourceSkin& skin, const std::vector<RigDescription::SkinGroup>& groups) {
  const std::vector<std::string> names = jointNames(skin);
  std::map<std::string, std::uint32_t> numbers;
  for (std::uint32_t joint = 0; joint < names.size(); ++joint) numbers.emplace(names[joint], joint);
  const std::vector<int> depths = depthsOf(skin);
  SkinPlan plan;
  plan.group_of.assign(names.size(), 0);
  plan.lead.assign(names.size(), 0);
  plan.named.assign(names.size(), false);
  for (std::uint32_t g = 0; g < groups.size(); ++g) {
    SkinPlan::Group& group = plan.groups.emplace_back();
    group.knots = static_cast<std::size_t>(groups[g].knots);
    group.pieces = static_cast<std::size_t>(groups[g].pieces);
    for (std::size_t k = 0; k < groups[g].joints.size(); ++k) {
      const std::string& name = groups[g].joints[k];
      const auto found = numbers.find(name);
      if (found == numbers.end())
        failAtJoint(g, k, "the file's skin has no joint '" + name + "'; it has " + listed(names));
      if (group.knots > 0 && k > 0 && !isBelow(skin, found->second, group.joints.back()))
        failAtJoint(g, k,
                    "the joint '" + name + "' is not below '" + groups[g].joints[k - 1] +
                        "'; a swept part runs along joints each below the one before: name them in "
                        "that order, or take \"knots\" out");
      group.joints.push_back(found->second);
      plan.named[found->second] = true;
      plan.group_of[found->second] = g;
    }
    group.top = *std::min_element(group.joints.begin(), group.joints.end(),
                                  [&](std::uint32_t a, std::uint32_t b) { return depths[a] < depths[b]; });
    for (const std::uint32_t joint : group.joints) plan.lead[joint] = group.knots > 0 ? joint : group.top;
  }
  for (std::uint32_t joint = 0; joint < names.size(); ++joint) {
    if (plan.named[joint]) continue;
    const int above = skin.joints[joint].parent;  // done before
    const std::uint32_t with = above < 0 ? plan.groups.front().top : static_cast<std::uint32_t>(above);
    plan.group_of[joint] = above < 0 ? 0 : plan.group_of[with];
    plan.lead[joint] = plan.lead[with];
  }
  return plan;
}

SkinLabels decomposeAsPlanned(const SkinSamples& samples, const SkinMoments& moments, const SkinPlan& plan,
                              int threads, const std::function<void(double)>& step) {
  SkinLabels first = seedsOf(samples, plan);
  if (moments.size() == 0) return withGroups(std::move(first), plan);
  Partition partition(samples, moments, std::move(first), threads, &plan);
  partition.improve(kRoundsOfPlan);
  std::size_t wanted = 0;
  for (const SkinPlan::Group& group : plan.groups) wanted += group.pieces;
  std::vector<bool> given_up(plan.groups.size(), false);
  // A cut may cost a neighbor a part, so that there may be more cuts than pieces.
  for (std::size_t cuts = 0; cuts < 2 * wanted; ++cuts) {
    const std::vector<std::size_t> counts = countParts(plan, partition.labels());
    const auto lacks = [&](std::size_t part) {
      const std::uint32_t group = plan.group_of[partition.labels().joints[part]];
      return plan.groups[group].knots == 0 && counts[group] < plan.groups[group].pieces && !given_up[group];
    };
    std::vector<std::size_t> lacking;
    for (std::size_t p = 0; p < partition.parts(); ++p)
      if (lacks(p)) lacking.push_back(p);
    if (lacking.empty()) break;
    step(std::min(1.0, static_cast<double>(partition.parts()) / static_cast<double>(wanted)));
    partition.findCuts();
    const std::size_t best = *std::max_element(lacking.begin(), lacking.end(), [&](auto a, auto b) {
      return partition.cutOf(a).gain < partition.cutOf(b).gain;
    });
    if (!(partition.cutOf(best).gain > 0)) break;
    const std::uint32_t group = plan.group_of[partition.labels().joints[best]];
    partition.split(best, std::vector<std::uint32_t>(partition.cutOf(best).half));
    partition.improve(kRoundsOfPiece);
    given_up[group] = countParts(plan, partition.labels())[group] <= counts[group];
  }
  return withGroups(partition.labels(), plan);
}

void sweepAsPlanned(const SkinSamples& samples, const SourceSkin& skin, const SkinMoments& moments,
                    const SkinSpace& space, const SkinPlan& plan, int threads, StiffChains& stiff,
                    SkinLabels& labels) {
  const std::vector<bool> scaling = scalingJoints(skin, kSweptScale);
  for (std::uint32_t g = 0; g < plan.groups.size(); ++g) {
    const SkinPlan::Group& group = plan.groups[g];
    if (group.knots == 0 || stiff.contains(group.top)) continue;
    if (std::ranges::any_of(group.joints, [&](std::uint32_t joint) { return scaling[joint]; })) {
      stiff.emplace(group.top, "a clip scales its joints, and a swept part keeps its thickness");
      continue;
    }
    const SkinChain chain{group.joints, group.knots};
    std::vector<bool> inside;
    for (const std::uint32_t joint : labels.joints) inside.push_back(plan.group_of[joint] == g);
    std::vector<std::uint32_t> along;
    for (std::uint32_t i = 0; i < samples.size(); ++i)
      if (inside[labels.parts[i]]) along.push_back(i);
    if (along.empty()) continue;
    const std::optional<SkinSweep> sweep = makeSweep(samples, skin, space, along, chain);
    if (!sweep) {
      stiff.emplace(group.top, "it would fold in the bind pose, or its joints are in one place");
      continue;
    }
    const SweepFit::Poses poses = SweepFit(samples, *sweep, along).poses(moments, threads);
    if (poses.fold())
      stiff.emplace(group.top,
                    "it would fold in clip '" + skin.clips[moments.clips[poses.folding]].name + "'");
    else
      joinParts(inside, chain, labels);
  }
}

std::vector<std::string> departures(const SkinPlan& plan, const SourceSkin& skin, const SkinLabels& labels,
                                    const PartTree& tree, const StiffChains& stiff) {
  const std::vector<std::string> names = jointNames(skin);
  const std::vector<std::size_t> counts = countParts(plan, labels);
  std::vector<bool> swept(plan.groups.size(), false);
  for (std::size_t p = 0; p < labels.joints.size(); ++p)
    if (tree.sweeps[p]) swept[plan.group_of[labels.joints[p]]] = true;
  std::vector<std::string> lines;
  for (std::size_t g = 0; g < plan.groups.size(); ++g) {
    const SkinPlan::Group& group = plan.groups[g];
    std::string who = placeOfGroup(g) + " ('" + names[group.joints.front()] + "'";
    if (group.joints.size() > 1) who += " to '" + names[group.joints.back()] + "'";
    who += "): ";
    if (counts[g] == 0) {
      lines.push_back(who + "no part is made of it: it moves too little of the surface; take the entry out");
    } else if (group.knots > 0 && !swept[g]) {
      const auto why = stiff.find(group.top);
      lines.push_back(who + "rigid parts, not one that is swept: " +
                      (why == stiff.end() ? "it would fold in the bind pose" : why->second) +
                      "; give it other knots or fewer joints, or take \"knots\" out");
    } else if (group.knots == 0 && counts[g] < group.pieces) {
      lines.push_back(who + std::to_string(counts[g]) + " of its " + std::to_string(group.pieces) +
                      " pieces: further ones would be too small, or move as these do");
    }
  }
  return lines;
}

}  // namespace kelp::bake
