// SPDX-License-Identifier: MIT
// The parts that a rig asks for (RigDescription::skin), instead of those that serve best.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "decompose.h"
#include "kelp/rig/rig.h"
#include "moments.h"
#include "samples.h"
#include "tree.h"

namespace kelp::bake {

struct SkinPlan {
  struct Group {
    std::vector<std::uint32_t> joints;  // as named
    std::uint32_t top = 0;              // the uppermost of them
    std::size_t knots = 0;              // 0: rigid
    std::size_t pieces = 1;
  };
  std::vector<Group> groups;
  // Of each joint:
  std::vector<std::uint32_t> group_of;
  // SkinLabels::joints of the parts that may have its surface. In a rigid group the uppermost joint; in a
  // swept one each named joint has a part until all of them become one.
  std::vector<std::uint32_t> lead;
  std::vector<bool> named;
};

// Chains that are not swept, by their first joints, and why.
using StiffChains = std::map<std::uint32_t, std::string>;

// The joints' names as rigs have them: the second one of a name is "name.2".
std::vector<std::string> jointNames(const SourceSkin& skin);

// RigError for joints that there are not, and for chains whose joints are not below each other.
SkinPlan planOf(const SourceSkin& skin, const std::vector<RigDescription::SkinGroup>& groups);

// Starts with the group that moves each sample most, then improves the parts by Lloyd's iteration, within
// what the plan allows, then cuts rigid groups until they have their pieces.
SkinLabels decomposeAsPlanned(const SkinSamples& samples, const SkinMoments& moments, const SkinPlan& plan,
                              int threads, const std::function<void(double)>& step);

// Makes one swept part of each group that has knots. Those that fold, or whose joints scale, are added to
// `stiff` and stay rigid.
void sweepAsPlanned(const SkinSamples& samples, const SourceSkin& skin, const SkinMoments& moments,
                    const SkinSpace& space, const SkinPlan& plan, int threads, StiffChains& stiff,
                    SkinLabels& labels);

// One line for each group that became something else than the plan says.
std::vector<std::string> departures(const SkinPlan& plan, const SourceSkin& skin, const SkinLabels& labels,
                                    const PartTree& tree, const StiffChains& stiff);

}  // namespace kelp::bake
