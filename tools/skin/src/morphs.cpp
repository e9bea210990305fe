// SPDX-License-Identifier: MIT
#include "morphs.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "key_choice.h"

namespace kelp::bake {
namespace {

// The weights of a morph target at all times of a clip.
std::vector<float> weightsOf(const SourceSkin& skin, const SourceSkin::Clip& clip, std::size_t morph) {
  std::vector<float> weights;
  for (std::size_t i = morph; i < clip.weights.size(); i += skin.morphs.size())
    weights.push_back(clip.weights[i]);
  return weights;
}

// By how much each weight may be off: where several move a node, they share what it may be off.
std::vector<double> tolerancesOf(const SourceSkin& skin, const SourceSkin::Clip& clip,
                                 const std::vector<RawMorph>& moves, double tolerance) {
  const auto lengthOf = [](const RawMorph& morph, std::size_t i) {
    return static_cast<double>(morph.step) * glm::length(glm::dvec3(morph.offsets[i]));
  };
  std::vector<double> all;  // of each node: how far it moves if the weights of all that move are 1
  for (std::size_t m = 0; m < moves.size(); ++m) {
    const std::vector<float> weights = weightsOf(skin, clip, m);
    const bool rests = std::all_of(weights.begin(), weights.end(), [](float weight) { return weight == 0; });
    if (rests || moves[m].nodes.empty()) continue;
    all.resize(std::max<std::size_t>(all.size(), moves[m].nodes.back() + 1), 0);
    for (std::size_t i = 0; i < moves[m].nodes.size(); ++i) all[moves[m].nodes[i]] += lengthOf(moves[m], i);
  }
  std::vector<double> tolerances;
  for (const RawMorph& morph : moves) {
    double most = 0;
    for (const std::uint32_t node : morph.nodes)
      if (node < all.size()) most = std::max(most, all[node]);
    tolerances.push_back(most > 0 ? tolerance / most : 0);
  }
  return tolerances;
}

void noteStill(const SourceSkin& skin, const std::vector<RawMorph>& moves,
               std::vector<std::string>& notices) {
  constexpr std::size_t kMostNames = 6;
  std::size_t count = 0;
  std::string names;
  for (std::size_t m = 0; m < moves.size(); ++m)
    if (moves[m].nodes.empty() && ++count <= kMostNames)
      names += (names.empty() ? "'" : ", '") + skin.morphs[m].name + "'";
  if (count > kMostNames) names += fmt::format(" and {} more", count - kMostNames);
  if (count > 0)
    notices.push_back(
        fmt::format("morph targets that move nothing by a fiftieth of a voxel at this resolution, or "
                    "something out of all "
                    "sight, are left out: {}",
                    names));
}

}  // namespace

void limitMorphs(SourceSkin& skin, std::size_t most, std::vector<std::string>& notices) {
  const std::size_t count = skin.morphs.size();
  if (count <= most) return;
  std::vector<double> moves;
  for (const SourceSkin::Morph& morph : skin.morphs)
    moves.push_back(
        std::accumulate(morph.offsets.begin(), morph.offsets.end(), 0.0,
                        [](double sum, const glm::vec3& by) { return sum + glm::length(glm::dvec3(by)); }));
  std::vector<std::size_t> kept(count);
  std::iota(kept.begin(), kept.end(), std::size_t{0});
  std::stable_sort(kept.begin(), kept.end(),
                   [&](std::size_t a, std::size_t b) { return moves[a] > moves[b]; });
  kept.resize(most);
  std::sort(kept.begin(), kept.end());
  skin.keepMorphs(kept);
  notices.push_back(
      fmt::format("the file has {} morph targets, and a pack holds {} beside its joints: those that move "
                  "least are left out",
                  count, most));
}

std::vector<SkinMorph> morphsOfSkin(const SourceSkin& skin, std::vector<RawMorph> moves,
                                    std::vector<SkinFit> fits, double tolerance,
                                    std::vector<std::string>& notices) {
  noteStill(skin, moves, notices);
  std::vector<SkinMorph> out(moves.size());
  for (std::size_t m = 0; m < moves.size(); ++m) {
    out[m].name = skin.morphs[m].name;
    out[m].fit = std::move(fits[m]);
  }
  for (const SourceSkin::Clip& clip : skin.clips) {
    const std::vector<double> tolerances = tolerancesOf(skin, clip, moves, tolerance);
    for (std::size_t m = 0; m < moves.size(); ++m)
      if (tolerances[m] > 0)
        out[m].rig.clips.push_back({clip.name,
                                    clip.duration,
                                    {},
                                    chooseWeightTrack(weightsOf(skin, clip, m), clip.times, tolerances[m])});
  }
  for (std::size_t m = 0; m < moves.size(); ++m) out[m].moves = std::move(moves[m]);
  std::erase_if(out, [](const SkinMorph& morph) { return morph.moves.nodes.empty(); });
  return out;
}

}  // namespace kelp::bake
