// SPDX-License-Identifier: MIT
// Springs and parts: which ones give way, and how others follow those on which they hang.
#include <algorithm>
#include <cmath>

#include <glm/gtc/matrix_inverse.hpp>

#include "cages/cage_map.h"
#include "cages/pose_nodes.h"
#include "kelp/runtime/spring.h"
#include "part_motion.h"

namespace kelp::runtime {
namespace {

// A matrix that is no more than a rotation with lengths: the rotation nearest to it, up to rounding.
glm::quat rotationOf(const glm::mat3& m) {
  const glm::vec3 x = glm::normalize(m[0]), y = glm::normalize(m[1] - glm::dot(m[1], x) * x);
  return glm::quat_cast(glm::mat3(x, y, glm::cross(x, y)));
}

// For each part the last one whose cage's nodes follow it; -1: none do.
Result<Buffer<int>> followersOf(std::span<const Part> parts, const Allocator& allocator) {
  Buffer<int> followers(allocator);
  if (const Result<void> made = followers.reset(parts.size()); !made) return made.error();
  std::fill(followers.begin(), followers.end(), -1);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i].cages.empty()) continue;
    for (const Influences& node : parts[i].cages[0].influences)
      for (int k = 0; k < 4 && node.weights[k] > 0; ++k) followers[node.parts[k]] = static_cast<int>(i);
  }
  return followers;
}

}  // namespace

// Of SpringOptions::parts.
Result<void> Spring::list(std::span<const Part> parts, std::span<const int> listed,
                          const Allocator& allocator) {
  if (listed.empty()) return Error{ErrorCode::kMisuse, "a spring's list of parts is empty"};
  for (std::size_t i = 0; i < listed.size(); ++i)
    if (listed[i] < 0 || listed[i] >= this->parts())
      return Error{ErrorCode::kMisuse, "a spring's list has a part that does not exist", i,
                   Error::Unit::kPart};
  const auto isListed = [&](int part) {
    return std::find(listed.begin(), listed.end(), part) != listed.end();
  };
  node_shares_ = Buffer<float>(allocator);
  if (!node_shares_.reset(node_swings_.size()))
    return Error{ErrorCode::kOutOfMemory, "no memory for a spring"};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    Body& body = bodies_[i];
    const bool whole = isListed(static_cast<int>(i));
    body.yields = body.yields && whole;
    float most = 0;
    for (std::uint32_t node = 0; node < body.nodes; ++node) {
      float& share = node_shares_[body.first_node + node] = whole ? 1.0f : 0.0f;
      const bool follows = !whole && !parts[i].cages[0].influences.empty();
      for (int k = 0; k < 4 && follows; ++k)
        if (const Influences& its = parts[i].cages[0].influences[node];
            its.weights[k] > 0 && isListed(its.parts[k]))
          share += static_cast<float>(its.weights[k]) / 255.0f;
      most = std::max(most, share);
    }
    body.yields = body.yields || most > 0;
    body.least_share = 0.5f * most;
  }
  return {};
}

Result<void> Spring::pushAway(const Instance& instance, const glm::vec3& center, float radius) {
  if (!instance.asset || !fits(*instance.asset) || (instance.pose && !fits(*instance.pose))) return foreign();
  if (!allFinite(center) || !std::isfinite(radius))
    return Error{ErrorCode::kMisuse, "a sphere is not finite"};
  if (!(radius > 0)) return {};
  const std::span<const Part> parts = instance.asset->pack().parts();
  Instance with = instance;
  bool moved = !hangs_.empty();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (!bodies_[i].yields) continue;
    const int part = static_cast<int>(i);
    if (moved && !hangs_.empty()) {
      if (!instance.pose) with_.reset();
      if (instance.pose && !with_.assign(*instance.pose)) return foreign();
      if (const Result<void> added = addTo(with_); !added) return added;
      with.pose = &with_;
    }
    const glm::mat4 to_world = matrixOf(with, part);
    if (!parts[i].cages.empty()) {
      const Result<bool> pushed = pushNodesAway(bodies_[i], instance, part, to_world, center, radius);
      if (!pushed) return pushed.error();
      moved = *pushed;
    } else {
      const std::span<const Knot> pose = knotsOf(instance, part);
      moved = pose.size() >= 2 && pushAway(bodies_[i], parts[i], pose, to_world, center, radius);
    }
  }
  return {};
}

// The parts that hang on others, and where.
Result<void> Spring::hang(const Asset& asset, const Allocator& allocator) {
  const std::span<const Part> parts = asset.pack().parts();
  const auto spotOn = [&](int part, const glm::vec3& in_object) {
    const Part& of = parts[static_cast<std::size_t>(part)];
    const glm::mat4 to_part = glm::affineInverse(affine(of.to_object));
    Spot spot;
    spot.part = part;
    // Pivots may lie anywhere.
    spot.rest = glm::clamp(glm::vec3(to_part * glm::vec4(in_object, 1)), glm::vec3(0), glm::vec3(of.size));
    spot.is_caged = !of.cages.empty();
    if (!spot.is_caged) return spot;
    const Cage& cage = of.cages[0];
    const std::uint32_t cell = cellNear(cage, glm::dvec3(spot.rest));
    spot.side = static_cast<float>(cage.side);
    spot.corner = glm::vec3(cage.side * cage.place(cell));
    const CageTetrahedron& kind =
        kCageTetrahedra[tetrahedronAt(glm::dvec3((spot.rest - spot.corner) / spot.side))];
    for (int k = 0; k < 4; ++k) spot.nodes[k] = cage.node(cell, kind.corners[k]);
    std::copy(std::begin(kind.axes), std::end(kind.axes), spot.axes);
    return spot;
  };
  hangs_ = Buffer<Hang>(allocator);
  constexpr Error kShort{ErrorCode::kOutOfMemory, "no memory for a spring"};
  const Result<Buffer<int>> followers = followersOf(parts, allocator);
  if (!followers || !hangs_.reset(parts.size())) return kShort;
  std::size_t count = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Part& part = parts[i];
    if (part.parent < 0 || part.kind == PartKind::kEmpty) continue;
    Hang& hang = hangs_[count++];
    hang.part = static_cast<int>(i);
    hang.parent = part.parent;
    hang.own = spotOn(hang.part, part.pivot[3]);
    bodies_[i].root = 2 * hang.own.rest.y > static_cast<float>(part.size.y) ? Root::kTop : Root::kBottom;
    const glm::vec3 pivot = part.to_object * glm::vec4(hang.own.rest, 1);
    const bool is_joint = parts[static_cast<std::size_t>(part.parent)].cages.empty();
    const int body = (*followers)[static_cast<std::size_t>(part.parent)];
    hang.holder = spotOn(is_joint && body >= 0 && body != hang.part ? body : part.parent, pivot);
    hang.is_on_spline = hangsOnSpline(part);
  }
  if (const Result<void> made = hangs_.reuse(count); !made) return kShort;
  if (count == 0) return {};
  Result<Pose> with = Pose::create(asset, allocator);
  if (!with) return with.error();
  with_ = *std::move(with);
  return {};
}

// Orthonormal; its origin is where the spot is, y runs along the spline; part space.
glm::mat4 Spring::frameAt(const Spot& spot, const Pose& pose) const {
  if (!spot.is_caged) {
    const PosedPart posed = posedPart(rest_[static_cast<std::size_t>(spot.part)], pose, spot.part);
    if (posed.knots.size() < 2) return glm::mat4(1);
    ArcChain room;
    return frameIn(posed, arcsOf(posed, room), glm::mat4(1), spot.rest);
  }
  const std::span<const glm::vec3> nodes = pose.nodes(spot.part);
  glm::mat3 gradient(1);
  for (int k = 0; k < 3; ++k)
    gradient[spot.axes[k]] = (nodes[spot.nodes[k + 1]] - nodes[spot.nodes[k]]) / spot.side;
  const glm::vec3 at = nodes[spot.nodes[0]] + gradient * (spot.rest - spot.corner);
  return frameOf(glm::mat4(1), glm::determinant(gradient) != 0 ? gradient : glm::mat3(1), at);
}

bool Spring::isStill(const Body& body) const {
  const std::span<const Swing> swings = swings_.span().subspan(body.first, body.knots);
  return body.moved == body.moved_end && std::all_of(swings.begin(), swings.end(), [](const Swing& swing) {
           return swing.offset == glm::vec3(0);
         });
}

void Spring::beforeKnots(const Pose& pose) const {
  for (Hang& hang : hangs_) {
    hang.moves = !PoseCages::drivenTo(pose, hang.part) &&
                 !(isStill(bodies_[static_cast<std::size_t>(hang.holder.part)]) &&
                   isStill(bodies_[static_cast<std::size_t>(hang.own.part)]));
    if (!hang.moves) continue;
    hang.own_before = glm::vec3(frameAt(hang.own, pose)[3]);
    hang.before = frameAt(hang.holder, pose);
  }
}

// The parent's knots already take along what hangs on its spline.
void Spring::beforeNodes(const Pose& pose) const {
  for (Hang& hang : hangs_)
    if (hang.moves && hang.is_on_spline) hang.before = frameAt(hang.holder, pose);
}

// Moves each part as the place where it hangs has moved, and so that this place on the part itself stays
// there.
void Spring::follow(Pose& pose) const {
  for (const Hang& hang : hangs_) {
    if (!hang.moves) continue;
    const glm::mat4 after = frameAt(hang.holder, pose);
    const glm::vec3 own_after(frameAt(hang.own, pose)[3]);
    if (after == hang.before && own_after == hang.own_before) continue;
    const Part& part = rest_[static_cast<std::size_t>(hang.part)];
    const glm::mat4 of_holder = affine(rest_[static_cast<std::size_t>(hang.holder.part)].to_object);
    // Object -> object, as the parent would see it without its own motion.
    glm::mat4 change = of_holder * after * glm::affineInverse(hang.before) * glm::affineInverse(of_holder);
    const glm::mat4 pivot = affine(part.pivot), to_pivot = glm::affineInverse(pivot),
                    to_object = affine(part.to_object);
    Motion& motion = *pose.motion(hang.part);
    const glm::mat3 scaled = glm::mat3_cast(motion.rotation) *
                             glm::mat3(motion.scale.x, 0, 0, 0, motion.scale.y, 0, 0, 0, motion.scale.z);
    glm::mat4 own(scaled);
    own[3] = glm::vec4(motion.translation, 1);
    own = pivot * own * to_pivot;
    PartMotions motions(rest_.span(), &pose);
    if (hang.holder.part != hang.parent) {
      const glm::mat4 between = glm::affineInverse(motions.of(hang.parent)) * motions.of(hang.holder.part);
      change = between * change * glm::affineInverse(between);
    }
    if (hang.is_on_spline) {
      const glm::mat4 on_spline =
          glm::affineInverse(motions.of(hang.parent)) * motions.of(hang.part) * glm::affineInverse(own);
      change = glm::affineInverse(on_spline) * change * on_spline;
    }
    const glm::vec3 goal(to_pivot * change * own * to_object * glm::vec4(hang.own_before, 1));
    const glm::quat turn = rotationOf(glm::mat3(to_pivot * change * pivot)) * motion.rotation;
    const glm::vec3 from(to_pivot * to_object * glm::vec4(own_after, 1));
    const glm::vec3 translation = goal - turn * (motion.scale * from);
    if (!allFinite(translation) || !allFinite({turn.x, turn.y, turn.z})) continue;
    motion.rotation = turn;
    motion.translation = translation;
  }
}

}  // namespace kelp::runtime
