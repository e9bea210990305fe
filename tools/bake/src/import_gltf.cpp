// SPDX-License-Identifier: MIT
// glTF 2.0: which nodes become which parts.
#include <algorithm>
#include <cmath>
#include <new>
#include <set>

#include "import_gltf_model.h"
#include "import_rig.h"
#include "import_soup.h"

namespace kelp::bake {
namespace {

struct PartPlan {
  int node = -1;                 // the node with the rig; -1: all that belongs to no rigged node
  int parent = -1;               // plan
  std::optional<GltfRig> rig;
  std::vector<int> knots;
  std::vector<int> members;      // nodes
};

// Knots at the top of the scene are the likeliest slip: nobody parented them to the mesh. With one model in the file it is plain what they mean.
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
  model.note("the empties knot.0 to knot." + std::to_string(knots.size() - 1) + " stand at the top of the scene: no rig is made of them; parent them to the mesh that they bend");
  return {};
}

// Parts in an order in which parents come first. With `single`, the whole file is one part.
std::vector<PartPlan> planParts(const GltfModel& model, bool single) {
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
        plans.push_back({node, above > 0 ? above : -1, std::move(rigs.nodes[at]), std::move(knots), {}});
      }
    }
    plans[static_cast<std::size_t>(owner[at])].members.push_back(node);
  }
  plans[0].rig = std::move(rigs.file);
  if (!single) plans[0].knots = findLooseKnots(model, plans.size() > 1);
  return plans;
}

glm::mat4x3 toAffine(const glm::dmat4& matrix) { return glm::mat4x3(glm::dmat4x3(matrix)); }

void noteDropped(const GltfModel& model, const std::string& part, const SoupBuilder& soup) {
  if (soup.droppedNonFinite() > 0) model.note("part '" + part + "': " + std::to_string(soup.droppedNonFinite()) + " triangles with corners that are not finite are dropped");
}

class GltfImporter {
 public:
  GltfImporter(const InputFiles& files, const Settings& settings) : files_(files), settings_(settings) {}

  SourceModel import() {
    out_.format = "glTF 2.0";
    outer_ = findOuterRig(files_, settings_);
    model_ = parseGltf(files_, readGltfDocument(files_), out_.notices);
    materials_ = readMaterials(model_, out_);
    animations_ = readAnimations(model_);
    for (const GltfAnimation& animation : animations_) used_.emplace_back(animation.channels.size(), false);

    const std::vector<PartPlan> plans = planParts(model_, outer_.has_value());
    std::vector<int> part_of(plans.size(), -1);
    for (std::size_t p = 0; p < plans.size(); ++p) {
      if (std::optional<SourcePart> part = makePart(plans[p])) {
        // The parent may have had no geometry: then its parent moves this part, if there is one.
        int parent = plans[p].parent;
        while (parent >= 0 && part_of[static_cast<std::size_t>(parent)] < 0) parent = plans[static_cast<std::size_t>(parent)].parent;
        part->parent = parent < 0 ? -1 : part_of[static_cast<std::size_t>(parent)];
        part_of[p] = static_cast<int>(out_.parts.size());
        out_.parts.push_back(*std::move(part));
      }
    }
    if (out_.parts.empty()) model_.refuse("scene", "holds no triangles" + (out_.notices.empty() ? "" : " (" + out_.notices.back() + ")") + "; export a scene with at least one mesh");
    uniqueNames();
    noteUnusedAnimations();
    return std::move(out_);
  }

 private:
  std::optional<SourcePart> makePart(const PartPlan& plan) {
    SourcePart part;
    const bool main = plan.node < 0;
    const std::string& node_name = main ? std::string() : model_.data.nodes[static_cast<std::size_t>(plan.node)].name;
    part.name = main || node_name.empty() ? stemOf(files_) : oneLine(node_name, 80);
    glm::dmat4 world(1);
    if (!main) {
      world = model_.world[static_cast<std::size_t>(plan.node)];
      if (std::abs(glm::determinant(glm::dmat3(world))) < 1e-30) model_.refuse(model_.nodeName(plan.node), "has a rig and a scale of zero; give it a size");
    }
    const glm::dmat4 from_world = glm::inverse(world);
    SoupBuilder soup;
    for (int node : plan.members) addMesh(model_, node, from_world, materials_, soup);
    noteDropped(model_, part.name, soup);
    triangles_ += soup.triangles();
    if (triangles_ > kMaxTriangles) model_.refuse("scene", "has more than 64 million triangles; bake it in pieces");
    if (soup.triangles() == 0) {
      if (plan.rig || !plan.knots.empty()) model_.note(noTriangles(plan));
      return std::nullopt;
    }
    part.soup = soup.take();
    part.to_object = toAffine(world);
    part.pivot = toAffine(pivotOf(plan.node));
    if (plan.rig || !plan.knots.empty()) readRig(plan, part);
    giveRig(part, outer_, settings_);
    return part;
  }

  std::string noTriangles(const PartPlan& plan) const {
    if (plan.node < 0) return (plan.rig ? "extras.kelp of " + plan.rig->owner : std::string("the scene's knot empties")) + " bends nothing: all triangles belong to nodes with rigs of their own";
    return model_.nodeName(plan.node) + " has a rig but no triangles in its subtree: no part is made of it; " +
           (plan.rig ? "put extras.kelp on the mesh's node" : "parent the knots to the mesh");
  }

  // World of the parent, then the node's own place and turn at rest: where its animated translation, rotation and scale act.
  glm::dmat4 pivotOf(int node) const {
    if (node < 0) return glm::dmat4(1);
    const int parent = model_.parents[static_cast<std::size_t>(node)];
    GltfTransform rest = restTransform(model_.data.nodes[static_cast<std::size_t>(node)]);
    rest.scale = glm::dvec3(1);
    return (parent >= 0 ? model_.world[static_cast<std::size_t>(parent)] : glm::dmat4(1)) * rest.matrix();
  }

  void readRig(const PartPlan& plan, SourcePart& part) {
    const std::string place = model_.nodeName(plan.node);
    std::vector<int> knots = plan.knots;
    if (plan.rig) {
      try {
        part.rig = parseRig(plan.rig->text);
      } catch (const RigError& error) {
        refuse(Exit::kInvalid, files_.input(), plan.rig->owner + ".extras.kelp", error.what());
      }
      part.rig_origin = "extras.kelp of " + plan.rig->owner;
      if (!knots.empty()) model_.note(place + " has knot empties, and " + plan.rig->owner + " has extras.kelp: extras.kelp is the rig");
      knots.clear();
    } else if (plan.node < 0 && !lieBeside(model_, knots, part.soup)) {
      model_.note("the empties knot.0 to knot." + std::to_string(knots.size() - 1) + " stand at the top of the scene, away from the mesh: no rig is made of them; move them along the mesh and parent them to it");
      part.rig_origin = "straight (the knot empties of " + place + " make no rig)";
      knots.clear();
    } else if (std::optional<RigDescription> rig = knotRig(model_, plan.node, knots, part.soup, settings_.axis)) {
      part.rig = *std::move(rig);
      part.rig_origin = std::to_string(knots.size()) + " knot empties of " + place;
    } else {
      part.rig_origin = "straight (the knot empties of " + place + " make no rig)";
      knots.clear();
    }
    addClips(model_, plan.node, knots, part.soup, part.name, animations_, used_, part.rig);
  }

  void uniqueNames() {
    for (std::size_t i = 0; i < out_.parts.size(); ++i) {
      const std::string wanted = out_.parts[i].name;
      const auto taken = [&](const std::string& name) {
        return std::any_of(out_.parts.begin(), out_.parts.begin() + static_cast<std::ptrdiff_t>(i), [&](const SourcePart& part) { return part.name == name; });
      };
      for (int suffix = 2; taken(out_.parts[i].name); ++suffix) out_.parts[i].name = wanted + "." + std::to_string(suffix);
    }
  }

  void noteUnusedAnimations() const {
    for (std::size_t a = 0; a < animations_.size(); ++a) {
      const auto unused = std::count(used_[a].begin(), used_[a].end(), false);
      if (unused == 0) continue;
      const std::string name = "animation '" + animations_[a].name + "'";
      if (static_cast<std::size_t>(unused) == used_[a].size()) model_.note(name + " moves no rigged node and makes no clip");
      else model_.note(name + ": " + std::to_string(unused) + " of its " + std::to_string(used_[a].size()) + " channels move no rigged node and are left out");
    }
  }

  const InputFiles& files_;
  const Settings& settings_;
  SourceModel out_;
  std::optional<OuterRig> outer_;
  GltfModel model_;
  std::vector<GltfMaterialUse> materials_;
  std::vector<GltfAnimation> animations_;
  std::vector<std::vector<bool>> used_;
  std::size_t triangles_ = 0;
};

}  // namespace

SourceModel importGltf(const std::filesystem::path& path, const Settings& settings, std::vector<std::filesystem::path>* files_read) {
  const InputFiles files(path, files_read);
  try {
    return GltfImporter(files, settings).import();
  } catch (const BakeError&) {
    throw;
  } catch (const std::bad_alloc&) {
    refuse(Exit::kRuntime, path, "", "does not fit into memory");
  } catch (const std::exception& error) {
    refuse(Exit::kInvalid, path, "", std::string("can not be read: ") + error.what());
  }
}

}  // namespace kelp::bake
