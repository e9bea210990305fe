// SPDX-License-Identifier: MIT
#include "kelp/runtime/instance.h"

#include <algorithm>
#include <cmath>

#include <glm/glm.hpp>

#include "asset_impl.h"
#include "cages/cage_map.h"
#include "kelp/simd/bound_knots.h"
#include "part_motion.h"
#include "posed_part.h"

namespace kelp::runtime {
namespace {

bool isPart(const Instance& instance, int part) {
  return instance.asset && part >= 0 &&
         static_cast<std::size_t>(part) < instance.asset->pack().parts().size();
}

constexpr Error kForeignPose{ErrorCode::kMisuse, "the pose is of another asset"};

bool hasItsPose(const Instance& instance) {
  return !instance.pose ||
         static_cast<std::size_t>(instance.pose->parts()) == instance.asset->pack().parts().size();
}

// The part exists, and the pose is of this asset as far as its number of parts shows.
Result<void> checkPosed(const Instance& instance, int part) {
  if (!isPart(instance, part)) return Error{ErrorCode::kMisuse, "there is no such part"};
  if (!hasItsPose(instance)) return kForeignPose;
  return {};
}
Result<void> checkPosed(const Instance& instance, int part, const glm::vec3& rest) {
  if (!allFinite(rest)) return Error{ErrorCode::kMisuse, "a point that is not finite"};
  return checkPosed(instance, part);
}

const Part& partOf(const Instance& instance, int part) {
  return instance.asset->pack().parts()[static_cast<std::size_t>(part)];
}

// Empty if the part cannot be drawn.
Box boundsOfCage(const Instance& instance, std::size_t part) {
  const Result<PosedCage> posed = posedCage(instance, static_cast<int>(part), 0);
  return posed ? posed->bounds : Box{};
}

// Object space at rest -> part space at rest.
glm::vec3 toVoxels(const Instance& instance, int part, const glm::vec3& rest) {
  return glm::vec3(glm::inverse(affine(partOf(instance, part).to_object)) * glm::vec4(rest, 1.0f));
}

PartMotions motionsOf(const Instance& instance) { return {instance.asset->pack().parts(), instance.pose}; }

// partToWorld() of a part that exists, for several parts of one pose.
glm::mat4 partToWorld(const Instance& instance, int part, PartMotions& motions) {
  return instance.to_world * (motions.of(part) * affine(partOf(instance, part).to_object));
}

// In the world. rest: part space.
glm::mat4 frameInWorld(const Instance& instance, int part, const glm::vec3& rest) {
  const glm::mat4 to_world = matrixOf(instance, part);
  const Result<PosedCage> cage = posedCage(instance, part, 0);
  if (!cage) {
    const PosedPart posed = posedPart(instance, part);
    ArcChain room;
    return frameIn(posed, arcsOf(posed, room), to_world, rest);
  }
  const PosedTetrahedron t = tetrahedronFor(*cage, *instance.asset, part, glm::dvec3(rest));
  const glm::mat3 axes(t.gradient);
  const bool flat = !(std::abs(t.volume) > 0);
  return frameOf(to_world, flat ? glm::mat3(1) : axes, glm::vec3(t.place(glm::dvec3(rest))));
}

}  // namespace

PosedPart posedPart(const Part& part, const Pose& pose, int index) {
  const Motion* const motion = pose.motion(index);
  return {&part, pose.knots(index), part.roll + (motion ? motion->roll : 0.0f)};
}
PosedPart posedPart(const Instance& instance, int part) {
  const Part& of = partOf(instance, part);
  return instance.pose ? posedPart(of, *instance.pose, part) : PosedPart{&of, of.knots, of.roll};
}

Box boundsOf(const PosedPart& posed) {
  if (!posed.isSwept()) return simd::boundKnots(posed.knots, posed.part->size);
  ArcChain chain;
  return posed.arcs(chain) ? chain.bounds : Box{};
}

std::span<const Knot> knotsOf(const Instance& instance, int part) {
  return instance.pose ? instance.pose->knots(part)
                       : instance.asset->pack().parts()[static_cast<std::size_t>(part)].knots;
}

glm::vec3 toObject(const Instance& instance, int part, const glm::vec3& voxels) {
  return partOf(instance, part).to_object * glm::vec4(voxels, 1.0f);
}

glm::mat4 matrixOf(const Instance& instance, int part) {
  PartMotions motions = motionsOf(instance);
  return partToWorld(instance, part, motions);
}

Result<glm::mat4> partToWorld(const Instance& instance, int part) {
  if (const Result<void> posed = checkPosed(instance, part); !posed) return posed.error();
  return matrixOf(instance, part);
}

Result<void> partsToWorld(const Instance& instance, std::span<glm::mat4> out) {
  if (!out.empty() && !isPart(instance, static_cast<int>(out.size()) - 1))
    return Error{ErrorCode::kMisuse, "there are more matrices than parts"};
  if (!out.empty() && !hasItsPose(instance)) return kForeignPose;
  PartMotions motions = motionsOf(instance);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = partToWorld(instance, static_cast<int>(i), motions);
  return {};
}

Box bounds(const Instance& instance) {
  Box all;
  if (!instance.asset) return all;
  const std::span<const Part> parts = instance.asset->pack().parts();
  PartMotions motions = motionsOf(instance);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const PosedPart posed = posedPart(instance, static_cast<int>(i));
    if (posed.knots.size() < 2 || posed.part->kind == PartKind::kEmpty) continue;
    const Box box = transformed(partToWorld(instance, static_cast<int>(i), motions),
                                parts[i].cages.empty() ? boundsOf(posed) : boundsOfCage(instance, i));
    if (box.empty()) continue;
    all.add(box.min);
    all.add(box.max);
  }
  return all;
}

Result<glm::vec3> toWorld(const Instance& instance, int part, const glm::vec3& rest) {
  if (const Result<void> posed = checkPosed(instance, part, rest); !posed) return posed.error();
  const glm::vec3 at = toVoxels(instance, part, rest);
  const Result<PosedCage> cage = posedCage(instance, part, 0);
  const glm::vec3 bent =
      cage ? glm::vec3(tetrahedronFor(*cage, *instance.asset, part, glm::dvec3(at)).place(glm::dvec3(at)))
           : bend(posedPart(instance, part), at);
  return glm::vec3(matrixOf(instance, part) * glm::vec4(bent, 1.0f));
}

std::optional<glm::vec3> toRest(const Instance& instance, int part, const glm::vec3& world) {
  if (!checkPosed(instance, part)) return std::nullopt;
  const PosedPart posed = posedPart(instance, part);
  const glm::vec3 p = glm::vec3(glm::inverse(matrixOf(instance, part)) * glm::vec4(world, 1.0f));
  if (!posed.part->cages.empty()) {
    const Result<PosedCage> cage = posedCage(instance, part, 0, CageUse::kTree);
    if (!cage || !allFinite(p)) return std::nullopt;
    const auto rest = restInCage(*cage, *instance.asset, part, glm::dvec3(p));
    return rest ? std::optional(toObject(instance, part, glm::vec3(*rest))) : std::nullopt;
  }
  if (posed.isSwept()) {
    ArcChain chain;
    if (!posed.arcs(chain)) return std::nullopt;
    const std::optional<glm::vec3> rest = unsweepPoint(chain, posed.part->size, p);
    return rest ? std::optional(toObject(instance, part, *rest)) : std::nullopt;
  }
  const std::span<const Knot> knots = posed.knots;
  if (!checkKnots(knots)) return std::nullopt;
  const float height = static_cast<float>(partOf(instance, part).size.y);
  const float low = height * knots.front().position.y;
  const float high = height * knots.back().position.y;
  if (!(p.y >= low && p.y <= high)) return std::nullopt;
  const SplinePoint at = splineAtHeight(knots, height, p.y);
  const glm::vec3 s = evaluate(at.segment, at.t);
  return toObject(instance, part, {p.x - s.x, (p.y - low) / (high - low) * height, p.z - s.z});
}

Result<glm::mat4> frameAt(const Instance& instance, int part, const glm::vec3& rest) {
  if (const Result<void> posed = checkPosed(instance, part, rest); !posed) return posed.error();
  return frameInWorld(instance, part, toVoxels(instance, part, rest));
}

Result<int> findPart(const Asset& asset, std::string_view name) {
  const std::span<const Part> parts = asset.pack().parts();
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (parts[i].name == name) return static_cast<int>(i);
  return NameReader::absentPart(asset);
}

Result<int> findJoint(const Asset& asset, std::string_view name) {
  const std::span<const Joint> joints = asset.pack().joints();
  for (std::size_t i = 0; i < joints.size(); ++i)
    if (joints[i].name == name) return static_cast<int>(i);
  return NameReader::absentJoint(asset);
}

Result<int> findSocket(const Asset& asset, std::string_view name, int part) {
  const std::span<const Socket> sockets = asset.pack().sockets();
  for (std::size_t i = 0; i < sockets.size(); ++i) {
    if (sockets[i].name == name && (part < 0 || sockets[i].part == static_cast<std::uint32_t>(part)))
      return static_cast<int>(i);
  }
  return NameReader::absentSocket(asset);
}

Result<glm::mat4> socketToWorld(const Instance& instance, int socket) {
  const auto index = static_cast<std::size_t>(socket);
  if (!instance.asset || socket < 0 || index >= instance.asset->pack().sockets().size())
    return Error{ErrorCode::kMisuse, "there is no such socket"};
  const Socket& on = instance.asset->pack().sockets()[index];
  const int part = static_cast<int>(on.part);
  if (!hasItsPose(instance)) return kForeignPose;
  return frameInWorld(instance, part, onAxis(partOf(instance, part), on.at, on.offset)) *
         glm::mat4_cast(on.rotation);
}

}  // namespace kelp::runtime
