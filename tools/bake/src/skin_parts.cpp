// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "kelp/formats/pack.h"
#include "kelp/import/core/outer_rig.h"
#include "part_frames.h"
#include "steps.h"

namespace kelp::bake {
namespace {

// A warning above this distance of 95 % of the surface, in voxels: joints may look wrong.
constexpr double kPoorFit = 2;
// Readers take 4,096 parts by default. Joints and morph targets together.
constexpr std::size_t kMostJoints = 4000;

// The joints as a pack holds them, joint j with part 1 + j: all or, with a notice, none.
std::vector<RawJoint> jointsOf(const SourceSkin& skin, const glm::mat4x3& to_object, Report& report) {
  const glm::dmat4 from_object = glm::inverse(glm::dmat4(glm::dmat4x3(to_object)));
  std::vector<RawJoint> joints;
  for (const SourceSkin::Joint& from : skin.joints) {
    RawJoint& joint = joints.emplace_back();
    joint.name = from.name;
    joint.parent = from.parent;
    const glm::dmat4 bind = from.inverse_bind * from_object;
    joint.inverse_bind = glm::mat4x3(glm::dmat4x3(bind));
    joint.parts = {static_cast<std::uint32_t>(joints.size())};
    const double volume = std::abs(glm::determinant(glm::dmat3(bind))),
                 sides = glm::length(glm::dvec3(bind[0])) * glm::length(glm::dvec3(bind[1])) *
                         glm::length(glm::dvec3(bind[2]));
    if (volume > 1e-7 * sides && isInvertible(joint.inverse_bind)) continue;
    report.notices.push_back(fmt::format(
        "the pack holds no joints, so a game cannot move its skeleton: the inverse bind matrix of joint '{}' "
        "has no inverse that 32-bit floats can hold; clips are not concerned",
        from.name));
    return {};
  }
  return joints;
}

// An empty part that moves as a joint does. Its box is the body's, longer where sockets need it.
SourcePart jointPart(SkinJoint joint, const SourcePart& body) {
  SourcePart part;
  part.name = std::move(joint.name);
  if (part.name == body.name) part.name += ".joint";
  part.parent = joint.parent < 0 ? -1 : 1 + joint.parent;
  part.to_object = body.to_object;
  part.pivot = glm::mat4x3(glm::dmat4x3(glm::dmat4(glm::dmat4x3(body.to_object)) * glm::dmat4(joint.pivot)));
  part.rig = std::move(joint.rig);
  part.rig.bend = Bend::kShear;
  part.rig_origin = body.rig_origin;
  VoxelGrid& box = part.grid.emplace();
  box.size = body.grid->size + glm::ivec3(0, joint.grow.x + joint.grow.y, 0);
  box.to_node = body.grid->to_node;
  box.to_node[3] = body.grid->to_node * glm::vec4(0, static_cast<float>(-joint.grow.x), 0, 1);
  return part;
}

// An empty part whose translation along x is the weight of a morph target.
SourcePart morphPart(SkinMorph& morph, const std::string& name, const SourcePart& body) {
  SourcePart part;
  part.name = name;
  part.to_object = body.to_object;
  part.rig = std::move(morph.rig);
  part.rig.bend = Bend::kShear;
  part.rig_origin = "morph target";
  VoxelGrid& box = part.grid.emplace();
  box.size = glm::ivec3(1);
  box.to_node = body.grid->to_node;
  return part;
}

void giveOuterRig(const OuterRig& outer, const std::optional<Bend>& bend, SourcePart& part) {
  const RigDescription* const given = outer.file.find(part.name);
  if (!given) return;
  part.rig = *given;
  part.rig_origin = outer.origin;
  if (!part.rig.bend) part.rig.bend = bend.value_or(kDefaultBend);
}

Report::Fit fitOf(const SkinFit& fit) {
  return {fit.distances.mean, fit.distances.p95, fit.distances.max, fit.joint};
}

}  // namespace

SkinnedBody divideSkinnedPart(SourceModel& model, const Frame& frame, const Settings& settings, int threads,
                              const Progress& progress, Report& report) {
  SourcePart& body = model.parts.front();
  SourceSkin skin = *std::exchange(body.skin, std::nullopt);
  SkinCage made = cageOfSkin(std::exchange(body.soup, {}), skin, frame, *body.grid, settings.cell.value_or(0),
                             levelCount(body.grid->size, settings.levels), threads, progress);
  std::ranges::move(made.notices, std::back_inserter(report.notices));
  if (settings.bend && !settings.caged)
    report.notices.push_back(
        fmt::format("a skin bends as its joints move: --bend {} is left out", toString(*settings.bend)));
  SkinnedBody out{std::move(made.fits),
                  made.cell,
                  std::move(made.cages),
                  std::move(made.influences),
                  jointsOf(skin, body.to_object, report),
                  {},
                  {}};
  for (Influences& node : out.influences)
    for (int i = 0; i < 4; ++i)
      if (node.weights[i] != 0) ++node.parts[i];
  PartNames names;
  names.take(body.name);
  std::vector<SourcePart> followed;
  for (SkinJoint& joint : made.joints) {
    followed.push_back(jointPart(std::move(joint), body));
    names.take(followed.back().name);
  }
  for (SkinMorph& morph : made.morphs) {
    followed.push_back(morphPart(morph, names.take(morph.name), body));
    morph.moves.part = static_cast<std::uint32_t>(followed.size());
    out.morphs.push_back(std::move(morph.moves));
    out.morph_fits.push_back(std::move(morph.fit));
  }
  if (model.outer)
    for (SourcePart& part : followed) giveOuterRig(*model.outer, settings.bend, part);
  std::ranges::move(followed, std::back_inserter(model.parts));
  for (const SourcePart& part : model.parts)
    if (part.rig.parent_at >= 0 && part.parent >= 0)
      model.parts[static_cast<std::size_t>(part.parent)].carries = true;
  return out;
}

void limitSkin(SourceModel& model, Report& report) {
  SourceSkin& skin = *model.parts.front().skin;
  limitJoints(skin, kMostJoints, report.notices);
  limitMorphs(skin, kMostJoints - skin.joints.size(), report.notices);
}

void countSkin(const SourceSkin& skin, PartSize& size) { size.source_bytes = skinBytes(size.voxels(), skin); }

void reportFits(const SkinnedBody& body, Report& report) {
  const std::vector<SkinFit>& fits = body.fits;
  std::map<std::string, const SkinFit*> by_clip;
  for (const SkinFit& fit : fits) by_clip[fit.clip] = &fit;
  for (Report::Clip& clip : report.clips)
    if (const auto found = by_clip.find(clip.name); found != by_clip.end()) clip.fit = fitOf(*found->second);
  for (std::size_t m = 0; m < body.morphs.size(); ++m) {
    Report::Part& line = report.parts[body.morphs[m].part];
    line.fill = "empty: its translation along x is the weight of a morph target";
    line.fit = fitOf(body.morph_fits[m]);
  }
  const auto notePoor = [&](const char* kind, const SkinFit& fit) {
    if (fit.distances.p95 > kPoorFit)
      report.notices.push_back(fmt::format(
          "{} '{}': a twentieth of the surface is more than {:.1f} voxels from where the skin would draw "
          "it, most ({:.1f}) at joint '{}'; smaller cells (--cell) follow the skin more closely",
          kind, fit.clip, fit.distances.p95, fit.distances.max, fit.joint));
  };
  for (const SkinFit& fit : fits) notePoor("clip", fit);
  for (const SkinFit& fit : body.morph_fits) notePoor("morph target", fit);
}

}  // namespace kelp::bake
