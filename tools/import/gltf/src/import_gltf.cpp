// SPDX-License-Identifier: MIT
// glTF 2.0: from nodes to parts.
#include "kelp/import/gltf/import_gltf.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <set>

#include "culled.h"
#include "gltf_parts.h"
#include "kelp/common/error.h"
#include "kelp/import/core/files_used.h"
#include "kelp/import/core/import_settings.h"
#include "kelp/import/core/outer_rig.h"
#include "kelp/import/core/source_model.h"
#include "kelp/import/mesh/soup.h"
#include "skins.h"

namespace kelp::bake {
namespace {

glm::mat4x3 toAffine(const glm::dmat4& matrix) { return glm::mat4x3(glm::dmat4x3(matrix)); }

void noteNonFinite(const GltfModel& model, const std::string& part, const SoupBuilder& soup) {
  if (soup.droppedNonFinite() > 0)
    model.note("part '" + part + "': " + std::to_string(soup.droppedNonFinite()) +
               " triangles with corners that are not finite are dropped");
}

// True if rounding to floats may have damaged the shape of a soup, or removed all of its triangles.
bool mayHaveLostItsShape(const TriangleSoup& soup) {
  if (soup.triangles.empty()) return soup.dropped > 0;
  glm::vec3 low = soup.positions[0], high = low;
  for (const glm::vec3& p : soup.positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  return isFar(glm::dvec3(low), glm::dvec3(high));
}

class GltfImporter {
 public:
  GltfImporter(const InputFiles& files, const ImportSettings& settings)
      : files_(files), settings_(settings), budget_(files, settings.max_memory) {}

  SourceModel import() {
    out_.format = "glTF 2.0";
    out_.outer = findOuterRig(files_, settings_);
    if (out_.outer && out_.outer->isWhole()) whole_ = out_.outer;
    model_ = readGltf(files_, budget_, settings_.scene, out_.notices);
    materials_ = readMaterials(model_, out_);
    animations_ = readAnimations(model_);
    channels_ = indexChannels(animations_);
    for (const GltfAnimation& animation : animations_) used_.emplace_back(animation.channels.size(), false);
    if (settings_.at) poseAt(model_, animations_, *settings_.at);
    if (bendsBySkin()) {
      makeSkinned();
    } else {
      makeParts();
    }
    if (out_.parts.empty()) explainEmptiness(model_);
    if (!settings_.at) noteUnusedMotion(model_, animations_, used_, settings_.parts, whole_.has_value());
    return std::move(out_);
  }

 private:
  bool hasOtherRig() const {
    if (whole_ || settings_.parts != Parts::kOne) return true;
    const std::vector<PartPlan> plans = planByRigs(model_, false);
    return plans.size() != 1 || plans[0].rig || !plans[0].knots.empty();
  }

  // True if the file's skins and morph targets are its rig: asked for, or the file has no other.
  bool bendsBySkin() const {
    const bool asked = settings_.rig_preset == kSkinRig, morphs = hasMorphs(model_),
               skins = morphs || hasSkins(model_);
    if (!asked) {
      if (!skins || settings_.at) return false;
      if (hasOtherRig()) {
        if (morphs)
          model_.note(
              "has morph targets, which are parts only without another rig and without --parts: its meshes "
              "are baked as they rest, or, with --at CLIP:SECONDS, as they are at a moment");
        return false;
      }
      if (morphs || movesJoints(model_, animations_) || (out_.outer && rigsJoints(model_, out_.outer->file)))
        return true;
      if (!animations_.empty())
        model_.note(
            "no animation moves the joints of its skin: it is baked at rest, as one part; --rig skin makes "
            "a part of each joint all the same");
      return false;
    }
    if (!skins)
      throw ToolError(Exit::kUsage,
                      "--rig skin: " + files_.input().filename().string() +
                          " has no mesh that bends by joints or morph targets; leave --rig out");
    if (settings_.at || settings_.parts != Parts::kOne)
      throw ToolError(Exit::kUsage, std::string("--rig skin: ") +
                                        (settings_.at ? "--at bakes one moment of the skin"
                                                      : "--parts nodes makes parts of nodes") +
                                        "; leave one of them out");
    return true;
  }

  void makeSkinned() {
    glm::dmat4 space(1);
    const std::size_t notices = out_.notices.size();
    const std::set<std::string> said = model_.said;
    for (const bool again : {false, true}) {
      std::vector<int> sockets;
      for (const int node : model_.order)
        if (isSocket(model_, node)) sockets.push_back(node);
      GltfSkins skins(model_, animations_, socketNames(model_, sockets, stemOf(files_)));
      SoupBuilder builder;
      std::vector<int> members;
      for (const int node : model_.order) {
        addMesh(model_, node, glm::inverse(space), materials_, builder, &skins);
        if (model_.node(node).mesh >= 0) members.push_back(node);
      }
      SourcePart part;
      part.name = stemOf(files_);
      noteNonFinite(model_, part.name, builder);
      part.soup = builder.take();
      // Far from the origin, as in makePart().
      if (!again && mayHaveLostItsShape(part.soup)) {
        model_.elements_read = 0;
        if (const std::optional<glm::dvec3> middle = middleOf(model_, members)) {
          space[3] = glm::dvec4(*middle, 1);
          out_.notices.resize(notices);
          model_.said = said;
          continue;
        }
      }
      if (part.soup.triangles.empty()) return;
      part.to_object = part.pivot = toAffine(space);
      part.rig_origin = "skin";
      part.skin = skins.take(space, used_);
      out_.parts.push_back(std::move(part));
      cull(out_.parts);
      return;
    }
  }

  void makeParts() {
    const std::vector<PartPlan> plans = settings_.parts == Parts::kNodes
                                            ? planByNodes(model_, animations_)
                                            : planByRigs(model_, whole_.has_value());
    checkPartCount(files_, plans.size(), "meshes");
    std::vector<int> part_of(plans.size(), -1);
    for (std::size_t p = 0; p < plans.size(); ++p) {
      if (std::optional<SourcePart> part = makePart(plans[p])) {
        // A parent without geometry is no part: then its own parent, if any, moves this part.
        int parent = plans[p].parent;
        while (parent >= 0 && part_of[static_cast<std::size_t>(parent)] < 0)
          parent = plans[static_cast<std::size_t>(parent)].parent;
        part->parent = parent < 0 ? -1 : part_of[static_cast<std::size_t>(parent)];
        part_of[p] = static_cast<int>(out_.parts.size());
        out_.parts.push_back(*std::move(part));
      }
    }
    if (out_.parts.size() > 1) cull(out_.parts);
    for (SourcePart& part : out_.parts)
      if (part.soup.triangles.empty()) makeEmpty(part);
    dropLoneParts();
    giveRigsByName();
    hangEmptyParts();
  }

  void cull(std::span<SourcePart> parts) {
    if (!settings_.keep_culled) removeCulled(parts, out_.materials, out_.notices);
  }

  // A unit cube around the place that the part moves about.
  static void makeEmpty(SourcePart& part) {
    part.grid.emplace();
    part.grid->size = glm::ivec3(1);
    part.grid->to_node[3] = glm::vec3(-0.5f);
  }

  std::optional<SourcePart> makePart(const PartPlan& plan) {
    SourcePart part;
    part.name = partName(plan.node);
    glm::dmat4 space(1);
    if (plan.node >= 0) {
      space = plan.rigid ? rigidSpace(model_, plan.node) : model_.world[static_cast<std::size_t>(plan.node)];
      if (std::abs(glm::determinant(glm::dmat3(space))) < 1e-30)
        model_.refuse(model_.nodeName(plan.node), "has a rig and a scale of zero; give it a size");
    }
    const bool whole = plan.node < 0 && plan.knots.empty();
    const std::size_t notices = out_.notices.size();
    const std::set<std::string> said = whole ? model_.said : std::set<std::string>();
    part.soup = readSoup(plan, space, part.name);
    // Far from the origin, floats cannot hold the shape: then the place of the mesh becomes the place of the
    // part. Not with knots at the top of the scene, which are read in the world.
    if (whole && mayHaveLostItsShape(part.soup)) {
      model_.elements_read = 0;
      if (const std::optional<glm::dvec3> middle = middleOf(model_, plan.members)) {
        space[3] = glm::dvec4(*middle, 1);
        out_.notices.resize(notices);
        model_.said = said;
        part.soup = readSoup(plan, space, part.name);
      }
    }
    cull({&part, 1});  // before the rig: an outline must not size it
    triangles_ += part.soup.triangles.size();
    if (triangles_ > kMaxTriangles)
      model_.refuse("scene", "has more than 64 million triangles; bake it in pieces");
    if (part.soup.triangles.empty()) {
      if (plan.rig || !plan.knots.empty()) model_.note(noTriangles(plan));
      if (!plan.rigid || plan.mover < 0) return std::nullopt;
      makeEmpty(part);
    }
    part.to_object = toAffine(space);
    const int mover = giveMotion(plan, part);
    if (plan.rig || !plan.knots.empty())
      readRig(plan, mover, part);
    else if (plan.rigid) {
      part.rig_origin = "straight";
      if (mover >= 0)
        addClips(model_, mover, {}, part.soup, part.name, animations_, channels_, used_, part.rig);
    }
    if (!part.isEmpty()) {
      giveRig(part, whole_, settings_);
      addSockets(model_, plan.sockets, space, part);
    }
    return part;
  }

  TriangleSoup readSoup(const PartPlan& plan, const glm::dmat4& space, const std::string& name) const {
    const glm::dmat4 from_world = glm::inverse(space);
    SoupBuilder soup;
    for (int node : plan.members) addMesh(model_, node, from_world, materials_, soup);
    noteNonFinite(model_, name, soup);
    return soup.take();
  }

  std::string partName(int node) const {
    if (node < 0) return stemOf(files_);
    const tinygltf::Node& source = model_.node(node);
    if (!source.name.empty()) return oneLine(source.name, 80);
    if (source.mesh >= 0 && settings_.parts == Parts::kNodes)
      if (const std::string& name = model_.data.meshes[static_cast<std::size_t>(source.mesh)].name;
          !name.empty())
        return oneLine(name, 80);
    return stemOf(files_);
  }

  // Sets the pivot. Returns the node whose animations move the part; -1, with a notice, if its pivot cannot
  // hold them.
  int giveMotion(const PartPlan& plan, SourcePart& part) const {
    const int node = plan.mover >= 0 ? plan.mover : plan.node;
    const glm::dmat4 pivot = pivotOf(model_, node);
    const double volume = std::abs(glm::determinant(glm::dmat3(pivot)));
    const double sides = glm::length(glm::dvec3(pivot[0])) * glm::length(glm::dvec3(pivot[1])) *
                         glm::length(glm::dvec3(pivot[2]));
    if (volume > 1e-7 * sides && volume > 1e-30) {
      part.pivot = toAffine(pivot);
      return plan.mover;
    }
    if (plan.mover >= 0)
      model_.note(model_.nodeName(plan.mover) +
                  " is animated below a scale of zero, which no part can follow: part '" + part.name +
                  "' does not move by it; give its parents a size at rest");
    return -1;
  }

  // Removes the empty parts that nothing follows: what they were there for had no triangles.
  void dropLoneParts() {
    for (std::size_t i = out_.parts.size(); i-- > 0;) {
      const auto index = static_cast<int>(i);
      const auto follows = [index](const SourcePart& part) { return part.parent == index; };
      if (!out_.parts[i].isEmpty() || std::ranges::any_of(out_.parts, follows)) continue;
      out_.parts.erase(out_.parts.begin() + index);
      for (SourcePart& part : out_.parts) part.parent -= part.parent > index;
    }
  }

  // Where an empty part stands between a part and the one that it hangs on, the empty part hangs there: it
  // takes along what follows it.
  void hangEmptyParts() {
    for (SourcePart& part : out_.parts) {
      SourcePart* hung = &part;
      while (hung->parent >= 0 && out_.parts[static_cast<std::size_t>(hung->parent)].isEmpty())
        hung = &out_.parts[static_cast<std::size_t>(hung->parent)];
      if (hung == &part || part.rig.parent_at == Part::kNotOnSpline) continue;
      if (hung->rig.parent_at != Part::kNotOnSpline && hung->rig.parent_at != part.rig.parent_at)
        model_.note("part '" + part.name +
                    "' hangs where another part that moves with it does: its own parent_at is not used");
      else
        hung->rig.parent_at = part.rig.parent_at;
      part.rig.parent_at = Part::kNotOnSpline;
    }
  }

  std::string noTriangles(const PartPlan& plan) const {
    if (plan.node < 0)
      return (plan.rig ? "extras.kelp of " + plan.rig->owner : std::string("the scene's knot empties")) +
             " bends nothing: all triangles belong to nodes with rigs of their own";
    return model_.nodeName(plan.node) +
           " has a rig but no triangles in its subtree: no part is made of it; " +
           (plan.rig ? "put extras.kelp on the mesh's node" : "parent the knots to the mesh");
  }

  // True if a rig says how the whole part bends, and has no knots, clips and sockets.
  static bool saysOnlyHow(const RigDescription& rig) {
    return rig.knots.empty() && rig.clips.empty() && rig.sockets.empty();
  }

  void readRig(const PartPlan& plan, int mover, SourcePart& part) {
    const std::string place = model_.nodeName(plan.node);
    std::vector<int> knots = plan.knots;
    RigDescription drawn;  // what is said of a rig that the knots draw
    drawn.axis = settings_.axis;
    drawn.bend = settings_.bend;
    drawn.caged = settings_.caged;
    std::string bends;
    if (plan.rig) {
      RigDescription written;
      try {
        written = parseRig(plan.rig->text);
      } catch (const RigError& error) {
        refuse(Exit::kInvalid, files_.input(), plan.rig->owner + ".extras.kelp", error.what());
      }
      const std::string origin = "extras.kelp of " + plan.rig->owner;
      if (!knots.empty() && saysOnlyHow(written)) {
        if (!written.axis) written.axis = drawn.axis;
        if (!written.bend) {
          written.bend = drawn.bend;
          written.caged = drawn.caged;
        }
        drawn = written;
        bends = ", which bend as " + origin + " says";
      } else {
        if (!knots.empty())
          model_.note(place + " has knot empties, and " + plan.rig->owner +
                      " has extras.kelp: extras.kelp is the rig");
        part.rig = std::move(written);
        part.rig_origin = origin;
        return addClips(model_, mover, {}, part.soup, part.name, animations_, channels_, used_, part.rig);
      }
    }
    if (plan.node < 0 && !lieBeside(model_, knots, part.soup)) {
      model_.note("the empties knot.0 to knot." + std::to_string(knots.size() - 1) +
                  " stand at the top of the scene, away from the mesh: no rig is made of them; move them "
                  "along the mesh and parent them to it");
      part.rig_origin = "straight (the knot empties of " + place + " make no rig)";
      knots.clear();
    } else if (std::optional<RigDescription> rig = knotRig(model_, plan.node, knots, part.soup, drawn)) {
      part.rig = *std::move(rig);
      part.rig_origin = std::to_string(knots.size()) + " knot empties of " + place + bends;
    } else {
      part.rig_origin = "straight (the knot empties of " + place + " make no rig)";
      knots.clear();
    }
    addClips(model_, mover, knots, part.soup, part.name, animations_, channels_, used_, part.rig);
  }

  // Makes the names of parts unique, and gives parts the rigs that the outer file has for them.
  void giveRigsByName() {
    PartNames names;
    for (SourcePart& part : out_.parts) {
      part.name = names.take(part.name);
      const RigDescription* const rig = out_.outer ? out_.outer->file.find(part.name) : nullptr;
      if (!rig) continue;
      if (part.isEmpty()) {  // no axis that settings could name
        part.rig = *rig;
        part.rig_origin = out_.outer->origin;
      } else {
        giveRig(part, out_.outer, settings_);
      }
    }
  }

  const InputFiles& files_;
  const ImportSettings& settings_;
  DataBudget budget_;
  SourceModel out_;
  std::optional<OuterRig> whole_;  // the outer rig, if it is that of the whole file
  GltfModel model_;
  std::vector<GltfMaterialUse> materials_;
  std::vector<GltfAnimation> animations_;
  GltfChannelIndex channels_;
  std::vector<std::vector<bool>> used_;
  std::size_t triangles_ = 0;
};

}  // namespace

SourceModel importGltf(const std::filesystem::path& path, const ImportSettings& settings, FilesUsed* used) {
  const InputFiles files(path, used);
  try {
    return GltfImporter(files, settings).import();
  } catch (const std::exception&) {
    refuseThrown(path);
  }
}

}  // namespace kelp::bake
