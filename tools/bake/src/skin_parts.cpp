// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "kelp/import/core/padding.h"
#include "part_frames.h"
#include "steps.h"

namespace kelp::bake {
namespace {

// A warning above this distance of 95 % of the surface, as a share of the longest side: 4 voxels of 128.
// Farther off, joints look broken.
constexpr double kPoorFit = 1.0 / 32;

// The pivot, moved to `at` in its own space.
glm::mat4x3 movedTo(const glm::mat4x3& pivot, const glm::dvec3& at) {
  glm::mat4x3 moved = pivot;
  moved[3] = glm::vec3(glm::dmat4x3(pivot) * glm::dvec4(at, 1));
  return moved;
}

std::uint64_t countSolid(const VoxelGrid& grid) {
  return static_cast<std::uint64_t>(
      std::count_if(grid.solid.begin(), grid.solid.end(), [](std::uint8_t voxel) { return voxel != 0; }));
}

// Distances in hundredths of a voxel: finer than anybody needs, and the same on every machine.
std::string infoOf(const std::vector<SkinPart>& parts, const std::optional<OuterRig>& outer) {
  const auto rounded = [](double distance) { return std::round(100 * distance) / 100; };
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const SkinPart& part : parts) {
    nlohmann::ordered_json& line = list.emplace_back();
    line["joints"] = part.joints;
    if (part.swept) line["knots"] = part.rig.knots.size();
    if (outer && outer->file.find(part.name)) line["rig"] = true;  // is from the rig file
    line["fit"] = {
        {"mean", rounded(part.fit.mean)}, {"p95", rounded(part.fit.p95)}, {"max", rounded(part.fit.max)}};
  }
  return nlohmann::ordered_json{{"parts", list}}.dump(-1, ' ', false,
                                                      nlohmann::ordered_json::error_handler_t::replace);
}

// The joints as a pack holds them: all or, with a notice, none.
std::vector<RawJoint> jointsOf(const SourcePart& whole, const SkinParts& divided, Report& report) {
  const glm::dmat4 from_object = glm::inverse(glm::dmat4(glm::dmat4x3(whole.to_object)));
  std::vector<RawJoint> joints;
  for (std::size_t j = 0; j < whole.skin->joints.size(); ++j) {
    const SourceSkin::Joint& from = whole.skin->joints[j];
    RawJoint& joint = joints.emplace_back();
    joint.name = from.name;
    joint.parent = from.parent;
    const glm::dmat4 bind = from.inverse_bind * from_object;
    joint.inverse_bind = glm::mat4x3(glm::dmat4x3(bind));
    joint.parts = divided.parts_of_joints[j];
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

// The whole's line becomes one for each part; the mesh and its repairs stay in the first.
void reportParts(const std::vector<SourcePart>& parts, Report& report) {
  Report::Part whole = std::move(report.parts.front());
  report.parts.clear();
  for (const SourcePart& part : parts) {
    Report::Part& line = report.parts.emplace_back();
    if (report.parts.size() == 1) line = whole;
    line.name = part.name;
    line.rig_origin = part.rig_origin;
    line.fill = whole.fill;
    line.closed = whole.closed;
    line.voxel_size = whole.voxel_size;
    line.size = part.grid->size;
    line.parent_at = part.rig.parent_at;
    for (const RigDescription::Socket& socket : part.rig.sockets) line.sockets.push_back(socket.name);
    line.swept = part.rig.bend == Bend::kSweep;
    line.caged = part.rig.caged;
    line.solid_voxels = countSolid(*part.grid);
    line.surface_voxels = part.grid->surface.size();
    if (part.parent >= 0) line.parent = parts[static_cast<std::size_t>(part.parent)].name;
  }
}

}  // namespace

void requirePlan(const SourcePart& part, const std::filesystem::path& input) {
  try {
    if (!part.rig.skin.empty()) checkSkinRig(part);
  } catch (const RigError& error) {
    throw ToolError(Exit::kInvalid,
                    fmt::format("{} ({}): {}", partPlace(input, part), part.rig_origin, error.what()));
  }
}

DividedSkin divideSkinnedPart(SourceModel& model, const Frame& frame, int pad, int threads,
                              const Progress& progress, Report& report) {
  const SourcePart whole = std::move(model.parts.front());
  SkinParts divided = divideSkin(model, whole, frame, *whole.grid, threads, progress);
  DividedSkin out{std::move(divided.fits), std::move(divided.sockets), infoOf(divided.parts, model.outer),
                  jointsOf(whole, divided, report)};
  std::ranges::move(divided.notices, std::back_inserter(report.notices));
  model.parts.clear();
  for (SkinPart& its : divided.parts) {
    SourcePart& part = model.parts.emplace_back();
    part.name = std::move(its.name);
    part.parent = its.parent;
    part.to_object = whole.to_object;
    part.pivot = movedTo(whole.pivot, its.pivot);
    part.rig_origin = whole.rig_origin;
    if (const RigDescription* given = model.outer ? model.outer->file.find(part.name) : nullptr) {
      its.rig = *given;
      part.rig_origin = model.outer->origin;
    }
    part.rig = std::move(its.rig);
    if (!part.rig.bend) part.rig.bend = its.swept ? Bend::kSweep : whole.rig.bend;
    if (part.rig.parent_at >= 0 && part.parent >= 0)
      model.parts[static_cast<std::size_t>(part.parent)].carries = true;
    part.grid = std::move(its.grid);
  }
  // A swept part has room beside its voxels already; more would make it fold sooner.
  for (SourcePart& part : model.parts)
    if (part.rig.bend != Bend::kSweep) padGrid(*part.grid, paddingOf(part, pad));
  reportParts(model.parts, report);
  return out;
}

void countSkin(const SourceSkin& skin, PartSize& size) {
  // The most that real files have (README.md of tools/skin).
  constexpr double kMoreSurface = 2, kMoreVoxels = 2;
  size.source_bytes = skinBytes(size.voxels(), skin.joints.size()) + kMoreVoxels * size.voxels();
  size.surface_voxels = std::min(kMoreSurface * size.surface_voxels, kMoreVoxels * size.voxels());
}

void reportFits(const DividedSkin& divided, const Frame& frame, Report& report) {
  const std::vector<SkinFit>& fits = divided.fits;
  const double poor = kPoorFit * std::max({frame.size.x, frame.size.y, frame.size.z});
  std::map<std::string, const SkinFit*> by_clip;
  for (const SkinFit& fit : fits) by_clip[fit.clip] = &fit;
  for (Report::Clip& clip : report.clips)
    if (const auto found = by_clip.find(clip.name); found != by_clip.end()) {
      const SkinDistances& its = found->second->distances;
      clip.fit = {its.mean, its.p95, its.max, found->second->joint};
    }
  for (const SkinFit& fit : fits)
    if (fit.distances.p95 > poor)
      report.notices.push_back(fmt::format(
          "clip '{}': a twentieth of the surface is more than {:.1f} voxels from where the skin "
          "would draw it, most ({:.1f}) at joint '{}'; rigid parts do not follow it closely there",
          fit.clip, fit.distances.p95, fit.distances.max, fit.joint));
  for (const SocketFit& fit : divided.sockets)
    if (fit.most > poor)
      report.notices.push_back(
          fmt::format("socket '{}' is up to {:.1f} voxels from where its joint takes it in clip '{}': it "
                      "moves by itself, "
                      "and here with part '{}'",
                      fit.socket, fit.most, fit.clip, fit.part));
}

}  // namespace kelp::bake
