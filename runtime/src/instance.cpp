// SPDX-License-Identifier: MIT
#include "kelp/runtime/instance.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/glm.hpp>
#include <glm/gtc/matrix_inverse.hpp>

#include "asset_impl.h"
#include "cages/cage_map.h"
#include "kelp/simd/bound_knots.h"
#include "posed_part.h"

namespace kelp::runtime {
namespace {

// The motion of a part about its pivot, object -> object.
glm::mat4 motionMatrix(const Part& part, const Motion& motion) {
  const glm::mat4 pivot = affine(part.pivot);
  glm::mat4 trs = glm::mat4_cast(motion.rotation);
  for (int i = 0; i < 3; ++i) trs[i] *= motion.scale[i];
  trs[3] = glm::vec4(motion.translation, 1.0f);
  return pivot * trs * glm::inverse(pivot);
}

// Segment and parameter at a height in rest space, where y = size.y (Sy(t) - Sy(0)) / (Sy(1) - Sy(0)).
struct SplinePoint {
  Segment segment;
  float t = 0;
};

SplinePoint splineAtHeight(std::span<const Knot> knots, float height, float y) {
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    if (y <= height * knots[i + 1].position.y || i + 2 == knots.size()) {
      const Segment segment = makeSegment(knots[i], knots[i + 1], height);
      const float t = trace::kelpSplineParameter(asTrace(segment), y - segment.p0.y, segment.p1.y - y);
      return {segment, t};
    }
  }
  return {};
}

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
  const Result<PosedCage> posed = posedCage(instance, static_cast<int>(part), 0, CageUse::kBounds);
  return posed ? posed->bounds : Box{};
}

// Object space at rest -> part space at rest.
glm::vec3 toVoxels(const Instance& instance, int part, const glm::vec3& rest) {
  return glm::vec3(glm::inverse(affine(partOf(instance, part).to_object)) * glm::vec4(rest, 1.0f));
}

// The height of a rest point in the deformed part, voxels.
float bentHeight(std::span<const Knot> knots, const glm::ivec3& size, float rest_y) {
  const float low = knots.front().position.y;
  return static_cast<float>(size.y) * low + rest_y * (knots.back().position.y - low);
}

// The arcs of a part, made in `room`; null if it is not swept, or cannot be drawn.
const ArcChain* arcsOf(const PosedPart& posed, ArcChain& room) {
  return posed.isSwept() && posed.arcs(room) ? &room : nullptr;
}

// Orthonormal and right-handed: y runs along the second column of `axes`, x by the first, or by the third
// where that is parallel to y. All in a space that `to_space` takes to another; so does the origin, `at`.
glm::mat4 frameOf(const glm::mat4& to_space, const glm::mat3& axes, const glm::vec3& at) {
  const glm::mat3 turned = glm::mat3(to_space) * axes;
  const glm::vec3 y = glm::normalize(turned[1]);
  glm::vec3 across = turned[0] - glm::dot(turned[0], y) * y;
  if (!(glm::dot(across, across) > 1e-12f * glm::dot(turned[0], turned[0])))
    across = turned[2] - glm::dot(turned[2], y) * y;
  across = glm::normalize(across);
  return glm::mat4(glm::vec4(across, 0), glm::vec4(y, 0), glm::vec4(glm::cross(across, y), 0),
                   to_space * glm::vec4(at, 1.0f));
}

// The frame of a rest point (part space) of a part that `to_space` takes to some space. y points along the
// spline. `arcs`: those of the part.
glm::mat4 frameIn(const PosedPart& posed, const ArcChain* arcs, const glm::mat4& to_space,
                  const glm::vec3& rest) {
  glm::vec3 along(0, 1, 0), x(1, 0, 0), z(0, 0, 1), at = rest;
  if (arcs) {
    const glm::mat4x3 section = sectionAt(*arcs, rest.y);
    along = section[1];
    x = section[0];
    z = section[2];
    at = sweepPoint(*arcs, posed.part->size, rest);
  } else if (!posed.isSwept()) {
    const SplinePoint on = splineAtHeight(posed.knots, static_cast<float>(posed.part->size.y),
                                          bentHeight(posed.knots, posed.part->size, rest.y));
    const glm::vec3 slope = derivative(on.segment, glm::clamp(on.t, 1e-4f, 1.0f - 1e-4f));
    if (glm::dot(slope, slope) > 0) along = slope;
    at = bend(posed, rest);
  }
  return frameOf(to_space, glm::mat3(x, along, z), at);
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

// The rest point at a place of the axis, `offset` heights from the middle line; part space.
glm::vec3 onAxis(const Part& part, float at, const glm::vec2& offset) {
  const glm::vec3 size(part.size);
  return {0.5f * size.x + offset.x * size.y, at * size.y, 0.5f * size.z + offset.y * size.y};
}

// How parts of one pose of an instance move with the splines on which they hang: worked out once a part, and
// the arcs of a spline once for the parts on it that follow one another. Kept on the stack; allocates
// nothing.
class Hangings {
 public:
  Hangings() { parts_.fill(-1); }
  // Of a part that hangs on its parent's spline; object space.
  const glm::mat4& of(const Instance& instance, int part);

 private:
  static constexpr std::size_t kPlaces = 32;  // a part's is its index modulo this
  std::array<int, kPlaces> parts_;
  std::array<glm::mat4, kPlaces> matrices_;
  int parent_ = -1;  // whose arcs these are, as posed and at rest; null: not swept, or it cannot be drawn
  ArcChain posed_, rest_;
  const ArcChain *posed_arcs_ = nullptr, *rest_arcs_ = nullptr;
};
const glm::mat4& Hangings::of(const Instance& instance, int part) {
  const std::size_t place = static_cast<std::size_t>(part) % kPlaces;
  if (parts_[place] == part) return matrices_[place];
  const Part& hanging = partOf(instance, part);
  const PosedPart posed = posedPart(instance, hanging.parent);
  const PosedPart rest{posed.part, posed.part->knots, posed.part->roll};
  if (parent_ != hanging.parent) {
    posed_arcs_ = arcsOf(posed, posed_);
    rest_arcs_ = arcsOf(rest, rest_);
    parent_ = hanging.parent;
  }
  const glm::mat4 to_object = affine(posed.part->to_object);
  const glm::vec3 at = onAxis(*posed.part, hanging.parent_at, glm::vec2(0));
  parts_[place] = part;
  matrices_[place] = frameIn(posed, posed_arcs_, to_object, at) *
                     glm::affineInverse(frameIn(rest, rest_arcs_, to_object, at));
  return matrices_[place];
}

// partToWorld() of a part that exists, for several parts of one pose.
glm::mat4 partToWorld(const Instance& instance, int part, Hangings& hangings) {
  const std::span<const Part> parts = instance.asset->pack().parts();
  glm::mat4 matrix = affine(parts[static_cast<std::size_t>(part)].to_object);
  if (!instance.pose || part >= instance.pose->parts()) return instance.to_world * matrix;
  for (int i = part; i >= 0; i = parts[static_cast<std::size_t>(i)].parent) {
    const Part& moved = parts[static_cast<std::size_t>(i)];
    const Motion& motion = *instance.pose->motion(i);
    if (motion != Motion{}) matrix = motionMatrix(moved, motion) * matrix;
    if (hangsOnSpline(moved)) matrix = hangings.of(instance, i) * matrix;
  }
  return instance.to_world * matrix;
}

}  // namespace

glm::vec3 bend(const PosedPart& posed, const glm::vec3& rest) {
  const Part& part = *posed.part;
  if (posed.isSwept()) {
    ArcChain chain;
    return posed.arcs(chain) ? sweepPoint(chain, part.size, rest) : rest;
  }
  return shear(posed.knots, part.size, rest);
}

glm::vec3 shear(std::span<const Knot> knots, const glm::ivec3& size, const glm::vec3& rest) {
  const float y = bentHeight(knots, size, rest.y);
  const SplinePoint at = splineAtHeight(knots, static_cast<float>(size.y), y);
  const glm::vec3 s = evaluate(at.segment, at.t);
  return {rest.x + s.x, y, rest.z + s.z};
}

PosedPart posedPart(const Instance& instance, int part) {
  const Part& of = partOf(instance, part);
  const Motion* motion = instance.pose ? instance.pose->motion(part) : nullptr;
  return {&of, knotsOf(instance, part), of.roll + (motion ? motion->roll : 0.0f)};
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
  Hangings hangings;
  return partToWorld(instance, part, hangings);
}

Result<glm::mat4> partToWorld(const Instance& instance, int part) {
  if (const Result<void> posed = checkPosed(instance, part); !posed) return posed.error();
  return matrixOf(instance, part);
}

Result<void> partsToWorld(const Instance& instance, std::span<glm::mat4> out) {
  if (!out.empty() && !isPart(instance, static_cast<int>(out.size()) - 1))
    return Error{ErrorCode::kMisuse, "there are more matrices than parts"};
  if (!out.empty() && !hasItsPose(instance)) return kForeignPose;
  Hangings hangings;
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = partToWorld(instance, static_cast<int>(i), hangings);
  return {};
}

Box bounds(const Instance& instance) {
  Box all;
  if (!instance.asset) return all;
  const std::span<const Part> parts = instance.asset->pack().parts();
  Hangings hangings;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const PosedPart posed = posedPart(instance, static_cast<int>(i));
    if (posed.knots.size() < 2 || posed.part->kind == PartKind::kEmpty) continue;
    const Box box = transformed(partToWorld(instance, static_cast<int>(i), hangings),
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
