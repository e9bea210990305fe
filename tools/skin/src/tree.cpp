// SPDX-License-Identifier: MIT
#include "tree.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "collapse.h"
#include "moments.h"

namespace kelp::bake {
namespace {

constexpr std::uint32_t kNobody = 0xffffffffu;

int topOf(const SourceSkin& skin, int joint) {
  while (skin.joints[static_cast<std::size_t>(joint)].parent >= 0)
    joint = skin.joints[static_cast<std::size_t>(joint)].parent;
  return joint;
}

// The largest part of each joint that has one; of those that a part is for together, that part.
std::vector<std::uint32_t> mainParts(const std::vector<double>& areas, const SkinLabels& labels,
                                     std::size_t joints) {
  std::vector<std::uint32_t> main(joints, kNobody);
  for (std::uint32_t p = 0; p < labels.joints.size(); ++p) {
    std::uint32_t& of = main[labels.joints[p]];
    if (of == kNobody || areas[p] > areas[of]) of = p;
  }
  for (std::uint32_t p = 0; p < labels.joints.size(); ++p)
    for (const std::uint32_t joint : labels.chains[p].joints) main[joint] = main[labels.joints[p]];
  return main;
}

std::vector<int> parentsOf(const SourceSkin& skin, const std::vector<double>& areas, const SkinLabels& labels,
                           const std::vector<Seam>& seams, const std::vector<std::uint32_t>& main) {
  const std::size_t count = labels.joints.size();
  std::vector<int> parents(count, -1);
  std::vector<bool> hangs(count, false);
  std::map<int, std::uint32_t> roots;  // of each skeleton: the largest part that has no part above
  for (std::uint32_t p = 0; p < count; ++p) {
    if (main[labels.joints[p]] != p) continue;
    hangs[p] = true;
    int above = skin.joints[labels.joints[p]].parent;
    while (above >= 0 && main[static_cast<std::size_t>(above)] == kNobody)
      above = skin.joints[static_cast<std::size_t>(above)].parent;
    if (above >= 0) {
      parents[p] = static_cast<int>(main[static_cast<std::size_t>(above)]);
    } else {
      const auto [at, fresh] = roots.emplace(topOf(skin, static_cast<int>(labels.joints[p])), p);
      if (!fresh && areas[p] > areas[at->second]) at->second = p;
    }
  }
  for (std::uint32_t p = 0; p < count; ++p) {
    if (!hangs[p] || parents[p] >= 0) continue;
    const std::uint32_t root = roots[topOf(skin, static_cast<int>(labels.joints[p]))];
    if (root != p) parents[p] = static_cast<int>(root);
  }
  // The longest seam between a part that hangs and one that does not; again and again.
  for (;;) {
    const Seam* best = nullptr;
    for (const Seam& seam : seams)
      if (hangs[seam.a] != hangs[seam.b] && (!best || seam.length > best->length)) best = &seam;
    if (!best) break;
    const std::uint32_t child = hangs[best->a] ? best->b : best->a;
    parents[child] = static_cast<int>(hangs[best->a] ? best->a : best->b);
    hangs[child] = true;
  }
  for (std::uint32_t p = 0; p < count; ++p)
    if (!hangs[p]) parents[p] = static_cast<int>(main[labels.joints[p]]);
  return parents;
}

// Renames parts so that parents come first; otherwise in their order.
void sortParts(SkinLabels& labels, std::vector<int>& parents) {
  const std::size_t count = parents.size();
  std::vector<std::uint32_t> order, place(count, kNobody);
  while (order.size() < count) {
    for (std::uint32_t p = 0; p < count; ++p) {
      if (place[p] != kNobody) continue;
      if (parents[p] >= 0 && place[static_cast<std::size_t>(parents[p])] == kNobody) continue;
      place[p] = static_cast<std::uint32_t>(order.size());
      order.push_back(p);
    }
  }
  SkinLabels sorted{labels.parts, {}, {}};
  std::vector<int> sorted_parents;
  for (const std::uint32_t p : order) {
    sorted.joints.push_back(labels.joints[p]);
    sorted.chains.push_back(std::move(labels.chains[p]));
    sorted_parents.push_back(parents[p] < 0 ? -1
                                            : static_cast<int>(place[static_cast<std::size_t>(parents[p])]));
  }
  for (std::uint32_t& part : sorted.parts) part = place[part];
  labels = std::move(sorted);
  parents = std::move(sorted_parents);
}

float placeOnParent(const PartTree& tree, std::size_t part) {
  if (tree.parents[part] < 0) return Part::kNotOnSpline;
  const std::optional<SkinSweep>& parent = tree.sweeps[static_cast<std::size_t>(tree.parents[part])];
  if (!parent) return Part::kNotOnSpline;
  const float y = parent->straightened(parent->toPart(tree.pivots[part])).y;
  return std::clamp(y / static_cast<float>(parent->size.y), 0.0f, 1.0f);
}

std::vector<double> areasOf(const SkinSamples& samples, const SkinLabels& labels) {
  std::vector<double> areas(labels.joints.size(), 0);
  for (std::size_t i = 0; i < samples.size(); ++i) areas[labels.parts[i]] += samples.areas[i];
  return areas;
}

}  // namespace

std::vector<bool> scalingParts(const SkinSamples& samples, const SourceSkin& skin, const SkinLabels& labels) {
  const std::vector<bool> scaling = scalingJoints(skin);
  std::vector<double> scaled(labels.joints.size(), 0), all(labels.joints.size(), 0);
  for (std::size_t i = 0; i < samples.size(); ++i)
    for (std::size_t k = samples.first_weighted[i]; k < samples.first_weighted[i + 1]; ++k) {
      const SkinSamples::Weighted& its = samples.weighted[k];
      all[labels.parts[i]] += samples.areas[i] * its.x.w;
      if (scaling[its.joint]) scaled[labels.parts[i]] += samples.areas[i] * its.x.w;
    }
  std::vector<bool> out;
  for (std::size_t p = 0; p < all.size(); ++p)
    out.push_back(!labels.chains[p].swept() && scaled[p] > 0 && scaled[p] >= kScaledShare * all[p]);
  return out;
}

std::vector<Seam> findSeams(const SkinSamples& samples, const SkinLabels& labels) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, Seam> seams;
  for (std::uint32_t e = 0; e < samples.edges.size(); ++e) {
    const SkinSamples::Edge& edge = samples.edges[e];
    const auto [a, b] = std::minmax(labels.parts[edge.a], labels.parts[edge.b]);
    if (a == b) continue;
    Seam& seam = seams[{a, b}];
    seam.a = a;
    seam.b = b;
    seam.length += edge.width;
    seam.middle += 0.5 * edge.width * (samples.positions[edge.a] + samples.positions[edge.b]);
    seam.edges.push_back(e);
  }
  std::vector<Seam> list;
  for (auto& [key, seam] : seams) {
    seam.middle /= seam.length;
    list.push_back(std::move(seam));
  }
  return list;
}

PartTree hangParts(const SkinSamples& samples, const SourceSkin& skin, const SkinSpace& space,
                   SkinLabels& labels) {
  PartTree tree;
  const std::vector<double> unsorted = areasOf(samples, labels);
  tree.parents = parentsOf(skin, unsorted, labels, findSeams(samples, labels),
                           mainParts(unsorted, labels, skin.joints.size()));
  const std::vector<bool> scaling = scalingParts(samples, skin, labels);
  for (int& parent : tree.parents)
    while (parent >= 0 && scaling[static_cast<std::size_t>(parent)])
      parent = tree.parents[static_cast<std::size_t>(parent)];
  sortParts(labels, tree.parents);
  const std::vector<double> areas = areasOf(samples, labels);
  const std::vector<std::uint32_t> main = mainParts(areas, labels, skin.joints.size());
  for (std::size_t joint = 0; joint < skin.joints.size(); ++joint) {
    int above = static_cast<int>(joint);
    while (above >= 0 && main[static_cast<std::size_t>(above)] == kNobody)
      above = skin.joints[static_cast<std::size_t>(above)].parent;
    tree.part_of_joint.push_back(above < 0 ? 0 : main[static_cast<std::size_t>(above)]);
  }
  std::map<std::pair<std::uint32_t, std::uint32_t>, glm::dvec3> middles;
  for (const Seam& seam : findSeams(samples, labels)) middles[{seam.a, seam.b}] = seam.middle;
  std::vector<glm::dvec3> centers(labels.joints.size(), glm::dvec3(0));
  for (std::size_t i = 0; i < samples.size(); ++i)
    centers[labels.parts[i]] += samples.areas[i] / areas[labels.parts[i]] * samples.positions[i];

  std::set<std::string> names;
  const std::vector<std::vector<std::uint32_t>> members = labels.members();
  for (std::uint32_t p = 0; p < labels.joints.size(); ++p) {
    const SourceSkin::Joint& joint = skin.joints[labels.joints[p]];
    glm::dvec3 pivot(space.from_soup * glm::dvec4(joint.origin, 1));
    tree.sweeps.emplace_back();
    if (labels.chains[p].swept())
      tree.sweeps[p] = makeSweep(samples, skin, space, members[p], labels.chains[p]);
    if (tree.sweeps[p]) {
      pivot = tree.sweeps[p]->toSkin(tree.sweeps[p]->corner());
    } else if (main[labels.joints[p]] != p) {
      const auto parent = static_cast<std::uint32_t>(std::max(0, tree.parents[p]));
      const auto seam = middles.find({std::min(p, parent), std::max(p, parent)});
      pivot = seam == middles.end() ? centers[p] : seam->second;
    }
    tree.pivots.push_back(pivot);
    tree.places.push_back(placeOnParent(tree, p));
    std::string name = joint.name;
    for (int k = 2; !names.insert(name).second; ++k) name = joint.name + "." + std::to_string(k);
    tree.names.push_back(name);
  }
  return tree;
}

glm::dmat4x3 motionFromParent(const PartTree& tree, std::size_t part, const SkinPose& parent) {
  if (tree.places[part] < 0) return parent.motion;
  const SkinSweep& sweep = *tree.sweeps[static_cast<std::size_t>(tree.parents[part])];
  return PosedSweep(sweep, parent).sectionMotion(static_cast<double>(tree.places[part]) * sweep.height());
}

}  // namespace kelp::bake
