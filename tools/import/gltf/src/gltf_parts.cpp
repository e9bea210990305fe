// SPDX-License-Identifier: MIT
#include "gltf_parts.h"

#include <algorithm>
#include <set>

#include "kelp/formats/pack.h"

namespace kelp::bake {
namespace {

// Knots at the top of the scene are the most likely slip: they were not parented to the mesh. With one model
// in the file it is clear what they bend.
std::vector<int> findLooseKnots(const GltfModel& model, bool other_rigs) {
  std::vector<int> knots = findKnots(model, -1);
  if (knots.empty()) return knots;
  std::vector<int> root(model.data.nodes.size(), -1);
  std::set<int> models;  // roots with triangles below
  for (int node : model.order) {
    const auto at = static_cast<std::size_t>(node);
    root[at] = model.parents[at] >= 0 ? root[static_cast<std::size_t>(model.parents[at])] : node;
    if (model.data.nodes[at].mesh >= 0) models.insert(root[at]);
  }
  if (!other_rigs && models.size() == 1) return knots;
  model.note(
      "the empties knot.0 to knot." + std::to_string(knots.size() - 1) +
      " stand at the top of the scene: no rig is made of them; parent them to the mesh that they bend");
  return {};
}

class NodePlanner {
 public:
  NodePlanner(const GltfModel& model, const std::vector<GltfAnimation>& animations)
      : model_(model), animated_(model.data.nodes.size(), false), seat_(model.data.nodes.size(), -1) {
    for (const GltfAnimation& animation : animations)
      for (const GltfChannel& channel : animation.channels)
        if (moves(model, channel)) animated_[static_cast<std::size_t>(channel.node)] = true;
  }

  std::vector<PartPlan> plan() {
    collect();
    checkPartCount(*model_.files, plans_.size(), "meshes");  // the ways up take their time
    addEmptyParts();
    for (std::size_t p = 0; p < plans_.size(); ++p) {
      const Way way = wayUp(p);
      plans_[p].mover = way.movers.empty() ? -1 : way.movers.front();
      plans_[p].parent = way.seat;
    }
    return parentsFirst();
  }

 private:
  struct Way {
    std::vector<int> movers;  // animated nodes from the part's own up to, but without, the seat above
    int seat = -1;            // plan
  };

  int parentOf(int node) const { return model_.parents[static_cast<std::size_t>(node)]; }

  void collect() {
    GltfRigs rigs = findRigs(model_);
    std::vector<std::vector<int>> knots(model_.data.nodes.size());
    bool any_rig = false;
    for (int node : model_.order) {
      const auto at = static_cast<std::size_t>(node);
      knots[at] = findKnots(model_, node);
      any_rig = any_rig || rigs.nodes[at] || !knots[at].empty();
      // knots bend the part; they move nothing below them
      for (int knot : knots[at]) animated_[static_cast<std::size_t>(knot)] = false;
    }
    std::vector<int> loose = findLooseKnots(model_, any_rig);
    for (int knot : loose) animated_[static_cast<std::size_t>(knot)] = false;
    int scene = -1;  // the plan of the scene's own rig
    if (rigs.file || !loose.empty()) {
      scene = 0;
      plans_.push_back({-1, -1, -1, std::move(rigs.file), std::move(loose), {}, {}, false});
      anchors_.push_back(-1);
    }
    std::vector<int> bound(model_.data.nodes.size(), -1);  // the plan whose rig bends a node
    for (int node : model_.order) {
      const auto at = static_cast<std::size_t>(node);
      if (rigs.nodes[at] || !knots[at].empty()) {
        bound[at] = seat_[at] = static_cast<int>(plans_.size());
        plans_.push_back({node, -1, -1, std::move(rigs.nodes[at]), std::move(knots[at]), {}, {node}, false});
        anchors_.push_back(node);
        continue;
      }
      const int above = parentOf(node) >= 0 ? bound[static_cast<std::size_t>(parentOf(node))] : scene;
      bound[at] = animated_[at] ? -1 : above;
      if (model_.node(node).mesh < 0) continue;
      if (bound[at] >= 0) {
        plans_[static_cast<std::size_t>(bound[at])].members.push_back(node);
        continue;
      }
      const int skin = model_.node(node).skin;
      if (skin < 0) seat_[at] = static_cast<int>(plans_.size());
      plans_.push_back({node, -1, -1, std::nullopt, {}, {}, {node}, true});
      // more than the limit is an error anyway
      anchors_.push_back(skin < 0 || plans_.size() > PackLimits{}.max_parts ? node
                                                                            : skinAnchor(model_, skin));
    }
    for (int node : model_.order)
      if (isSocket(model_, node)) giveSocket(node, bound, scene);
  }

  // A socket belongs to the nearest part above it, else to that of the scene.
  void giveSocket(int node, const std::vector<int>& bound, int scene) {
    int plan = -1;
    for (int at = node; at >= 0 && plan < 0; at = parentOf(at))
      plan = std::max(bound[static_cast<std::size_t>(at)], seat_[static_cast<std::size_t>(at)]);
    if (plan < 0) plan = plans_.size() == 1 ? 0 : scene;
    if (plan >= 0)
      plans_[static_cast<std::size_t>(plan)].sockets.push_back(node);
    else
      model_.note(model_.nodeName(node) +
                  " is below no part: no socket is made of it; parent it to the mesh that it moves with");
  }

  Way wayUp(std::size_t plan) const {
    Way way;
    for (int node = anchors_[plan]; node >= 0; node = parentOf(node)) {
      const auto at = static_cast<std::size_t>(node);
      if (seat_[at] >= 0 && seat_[at] != static_cast<int>(plan)) {
        way.seat = seat_[at];
        break;
      }
      if (animated_[at]) way.movers.push_back(node);
    }
    return way;
  }

  void addEmptyParts() {
    std::set<int> movers;  // those without a mesh between two that move
    for (std::size_t p = 0; p < plans_.size(); ++p) {
      const Way way = wayUp(p);
      if (way.movers.size() > 1) movers.insert(way.movers.begin() + 1, way.movers.end());
    }
    for (int node : movers) {
      seat_[static_cast<std::size_t>(node)] = static_cast<int>(plans_.size());
      plans_.push_back({node, -1, -1, std::nullopt, {}, {}, {}, true});
      anchors_.push_back(node);
    }
  }

  std::vector<PartPlan> parentsFirst() {
    std::vector<int> place(plans_.size(), -1);
    std::vector<PartPlan> sorted;
    std::vector<int> chain;
    for (std::size_t p = 0; p < plans_.size(); ++p) {
      chain.clear();
      for (int at = static_cast<int>(p); at >= 0 && place[static_cast<std::size_t>(at)] < 0;
           at = plans_[static_cast<std::size_t>(at)].parent)
        chain.push_back(at);
      for (auto at = chain.rbegin(); at != chain.rend(); ++at) {
        place[static_cast<std::size_t>(*at)] = static_cast<int>(sorted.size());
        PartPlan& plan = sorted.emplace_back(std::move(plans_[static_cast<std::size_t>(*at)]));
        plans_[static_cast<std::size_t>(*at)].parent = plan.parent;  // still asked for by those below
        if (plan.parent >= 0) plan.parent = place[static_cast<std::size_t>(plan.parent)];
      }
    }
    return sorted;
  }

  const GltfModel& model_;
  std::vector<bool> animated_;  // of each node
  std::vector<int> seat_;       // of each node: the plan whose motion is the node's; -1: none
  std::vector<int> anchors_;    // of each plan: the node that it hangs on; -1: the scene
  std::vector<PartPlan> plans_;
};

}  // namespace

std::vector<PartPlan> planByRigs(const GltfModel& model, bool single) {
  std::vector<PartPlan> plans(1);
  std::vector<int> owner(model.data.nodes.size(), 0);  // plans
  GltfRigs rigs;
  if (!single) rigs = findRigs(model);
  for (int node : model.order) {
    const auto at = static_cast<std::size_t>(node);
    const int above = model.parents[at] >= 0 ? owner[static_cast<std::size_t>(model.parents[at])] : 0;
    owner[at] = above;
    if (!single) {
      std::vector<int> knots = findKnots(model, node);
      if (rigs.nodes[at] || !knots.empty()) {
        owner[at] = static_cast<int>(plans.size());
        plans.push_back(
            {node, above > 0 ? above : -1, node, std::move(rigs.nodes[at]), std::move(knots), {}, {}, false});
      }
    }
    PartPlan& plan = plans[static_cast<std::size_t>(owner[at])];
    plan.members.push_back(node);
    if (isSocket(model, node)) plan.sockets.push_back(node);
  }
  plans[0].rig = std::move(rigs.file);
  if (!single) plans[0].knots = findLooseKnots(model, plans.size() > 1);
  return plans;
}

std::vector<PartPlan> planByNodes(const GltfModel& model, const std::vector<GltfAnimation>& animations) {
  return NodePlanner(model, animations).plan();
}

glm::dmat4 rigidSpace(const GltfModel& model, int node) {
  if (model.node(node).skin >= 0) return glm::dmat4(1);
  glm::dquat turn(1, 0, 0, 0);
  for (int at = node; at >= 0; at = model.parents[static_cast<std::size_t>(at)])
    turn = restTransform(model.node(at)).rotation * turn;
  glm::dmat4 space = glm::mat4_cast(glm::normalize(turn));
  space[3] = model.world[static_cast<std::size_t>(node)][3];
  return space;
}

glm::dmat4 pivotOf(const GltfModel& model, int node) {
  if (node < 0) return glm::dmat4(1);
  const int parent = model.parents[static_cast<std::size_t>(node)];
  GltfTransform rest = restTransform(model.node(node));
  rest.scale = glm::dvec3(1);
  return (parent >= 0 ? model.world[static_cast<std::size_t>(parent)] : glm::dmat4(1)) * rest.matrix();
}

int skinAnchor(const GltfModel& model, int skin) {
  const std::size_t count = model.parents.size();
  std::vector<int> above;                   // the first joint and all above it, upwards
  std::vector<int> place(count, -1);        // in `above`
  std::vector<std::size_t> seen(count, 0);  // by which joint's way up, counted from 1
  std::size_t common = 0;                   // the first in `above` that all joints so far have
  std::size_t way = 0;
  for (int joint : model.data.skins[static_cast<std::size_t>(skin)].joints) {
    ++way;
    int node = joint;
    while (node >= 0 && static_cast<std::size_t>(node) < count) {
      const auto at = static_cast<std::size_t>(node);
      if (seen[at] > 0) break;  // from here on the way is known
      seen[at] = way;
      if (way == 1) {
        place[at] = static_cast<int>(above.size());
        above.push_back(node);
      }
      node = model.parents[at];
    }
    if (way == 1) continue;
    if (node < 0 || static_cast<std::size_t>(node) >= count) return -1;
    if (const int at = place[static_cast<std::size_t>(node)]; at >= 0)
      common = std::max(common, static_cast<std::size_t>(at));
  }
  return above.empty() ? -1 : above[common];
}

void noteUnusedMotion(const GltfModel& model, const std::vector<GltfAnimation>& animations,
                      const std::vector<std::vector<bool>>& used, Parts parts, bool single) {
  // Nodes above meshes that they move, and above joints that bend meshes.
  std::vector<bool> places(model.data.nodes.size(), false), bends(model.data.nodes.size(), false),
      seen(model.data.skins.size(), false);
  for (int node : model.order) {
    const tinygltf::Node& source = model.node(node);
    if (source.mesh < 0) continue;
    if (source.skin < 0) {
      places[static_cast<std::size_t>(node)] = true;
    } else if (const auto skin = static_cast<std::size_t>(source.skin); !seen[skin]) {
      seen[skin] = true;
      for (int joint : model.data.skins[skin].joints)
        if (joint >= 0 && joint < static_cast<int>(bends.size()))
          bends[static_cast<std::size_t>(joint)] = true;
    }
  }
  for (auto node = model.placed.rbegin(); node != model.placed.rend(); ++node) {
    const int parent = model.parents[static_cast<std::size_t>(*node)];
    if (parent < 0) continue;
    for (auto* below : {&places, &bends})
      if ((*below)[static_cast<std::size_t>(*node)]) (*below)[static_cast<std::size_t>(parent)] = true;
  }
  std::vector<std::string> moving, shaping;
  for (std::size_t a = 0; a < animations.size(); ++a) {
    bool nodes = false, shapes = false;
    for (std::size_t c = 0; c < animations[a].channels.size(); ++c) {
      const GltfChannel& channel = animations[a].channels[c];
      if (used[a][c] || !moves(model, channel)) continue;
      const auto at = static_cast<std::size_t>(channel.node);
      nodes = nodes || (places[at] && parts == Parts::kOne);
      shapes = shapes || bends[at];
    }
    if (nodes) moving.push_back(animations[a].name);
    if (shapes) shaping.push_back(animations[a].name);
  }
  const auto list = [](const std::vector<std::string>& names) {
    std::string text = names.size() == 1 ? "animation " : "animations ";
    for (std::size_t i = 0; i < names.size() && i < 6; ++i)
      text += (i == 0 ? "'" : i + 1 == names.size() ? " and '" : ", '") + names[i] + "'";
    return names.size() > 6 ? text + " and " + std::to_string(names.size() - 6) + " more" : text;
  };
  const auto s = [](const std::vector<std::string>& names) { return names.size() == 1 ? "s" : ""; };
  if (!moving.empty())
    model.note(
        list(moving) + " move" + s(moving) + " nodes within one part, and no clip is made of that; " +
        (single ? "the rig is that of the whole file"
                : "--parts nodes makes clips of it, --at '" + moving.front() + ":SECONDS' bakes a moment"));
  if (!shaping.empty())
    model.note(list(shaping) + " change" + s(shaping) +
               " shapes by skins, of which clips are made only without another rig and without --parts; they "
               "are baked at rest, or at a moment with --at '" +
               shaping.front() + ":SECONDS'");
}

}  // namespace kelp::bake
