// SPDX-License-Identifier: MIT
// Nodes that follow parts: the motions of these, and where they take the nodes.
#include <algorithm>
#include <cmath>

#include <glm/glm.hpp>
#include <glm/gtc/matrix_inverse.hpp>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "../part_motion.h"
#include "kelp/simd/lanes.h"
#include "pose_nodes.h"

namespace kelp::runtime {
namespace {

using simd::Lanes;

bool bends(const PosedPart& posed) {
  return (posed.isSwept() && posed.roll != 0) ||
         std::any_of(posed.knots.begin(), posed.knots.end(), [](const Knot& knot) {
           return knot.position != glm::vec3(0, knot.at, 0) || knot.tangent != glm::vec3(0, 1, 0);
         });
}

// A part whose spline bends takes points above and below its box, too: straight on from its ends.
class BentMap {
 public:
  explicit BentMap(const PosedPart& posed) : posed_(posed), arcs_(arcsOf(posed, room_)) {}

  // Part space, at rest -> now.
  glm::vec3 place(const glm::vec3& rest) const {
    const auto height = static_cast<float>(posed_.part->size.y);
    const glm::vec3 end(rest.x, std::clamp(rest.y, 0.0f, height), rest.z);
    const glm::vec3 at =
        arcs_ ? sweepPoint(*arcs_, posed_.part->size, end) : shear(posed_.knots, posed_.part->size, end);
    return rest.y == end.y ? at : at + (rest.y - end.y) * along(end.y);
  }

 private:
  // By how much a point moves along the spline's end for each voxel.
  glm::vec3 along(float y) const {
    if (arcs_) return sectionAt(*arcs_, y)[1] / arcs_->arcs[y > 0 ? arcs_->count - 1 : 0].rise;
    const std::span<const Knot> knots = posed_.knots;
    const Knot& knot = y > 0 ? knots.back() : knots.front();
    const float rise = knots.back().position.y - knots.front().position.y;
    // A flat end has no direction.
    return knot.tangent.y > 1e-3f ? rise / knot.tangent.y * knot.tangent : glm::vec3(0, rise, 0);
  }

  const PosedPart posed_;
  ArcChain room_;
  const ArcChain* arcs_;
};

void addBent(const PoseCages& cages, const Pose& pose, int follower, std::size_t part,
             std::span<const Influences> influences, const std::uint32_t* places, float side,
             glm::vec3* nodes) {
  const BentMap bent(posedPart(cages.rest[part], pose, static_cast<int>(part)));
  const glm::mat4 from = affine(cages.rest[static_cast<std::size_t>(follower)].to_object),
                  to_part = glm::affineInverse(affine(cages.rest[part].to_object)) * from,
                  back = glm::affineInverse(from) * cages.motions[part] * affine(cages.rest[part].to_object);
  for (std::size_t i = 0; i < influences.size(); ++i)
    for (int k = 0; k < 4; ++k) {
      if (influences[i].weights[k] == 0 || influences[i].parts[k] != part) continue;
      const glm::vec3 rest = side * glm::vec3(latticePoint(places[i]));
      const glm::vec3 at(back * glm::vec4(bent.place(glm::vec3(to_part * glm::vec4(rest, 1.0f))), 1.0f));
      nodes[i] += static_cast<float>(influences[i].weights[k]) / 255.0f * at;
    }
}

}  // namespace

std::uint64_t PoseCages::stateOf(const Pose& pose) {
  return XXH3_64bits(const_cast<Pose&>(pose).state(), pose.stateBytes()) >> 2;
}

const glm::mat4* PoseCages::drivenTo(const Pose& pose, int part) {
  const PoseCages* const all = pose.cages();
  return all && all->any_driven && all->is_driven[static_cast<std::size_t>(part)]
             ? &all->driven[static_cast<std::size_t>(part)]
             : nullptr;
}

void PoseCages::drive(Pose& pose, int part, const glm::mat4& to) {
  PoseCages& all = *pose.cages();
  all.driven[static_cast<std::size_t>(part)] = to;
  all.is_driven[static_cast<std::size_t>(part)] = all.any_driven = true;
}

void PoseCages::release(Pose& pose) {
  PoseCages& all = *pose.cages();
  if (!all.any_driven) return;
  all.any_driven = false;
  std::fill(all.is_driven.begin(), all.is_driven.end(), false);
  forgetMotions(pose);
}

void PoseCages::forgetMotions(Pose& pose) {
  PoseCages& all = *pose.cages();
  all.moved.forget();
  for (int part = 0; part < pose.parts(); ++part)
    if (all.parts[static_cast<std::size_t>(part)].followsParts()) pose.forgetNodes(part);
}

void PoseCages::blendDriven(const Pose& to, float weight, std::span<const float> weights, Pose& pose) {
  if (!pose.cages()->any_driven && !to.cages()->any_driven) return;
  const std::span<const glm::mat4> mine = motionsOf(pose), theirs = motionsOf(to);
  for (std::size_t i = 0; i < mine.size(); ++i) {
    const int part = static_cast<int>(i);
    const float w = weights.empty() ? weight : weight * weights[i];
    if (w == 1 && !drivenTo(to, part))
      pose.cages()->is_driven[i] = false;
    else if (w > 0 && (drivenTo(pose, part) || drivenTo(to, part)))
      drive(pose, part, mine[i] + w * (theirs[i] - mine[i]));
  }
  forgetMotions(pose);
}

std::span<const glm::mat4> PoseCages::motionsOf(const Pose& pose) {
  PoseCages& all = *pose.cages();
  all.moved.make(stateOf(pose), [&] {
    PartMotions motions(all.rest, &pose);
    for (std::size_t i = 0; i < all.rest.size(); ++i) {
      const int parent = all.rest[i].parent;
      all.motions[i] = motions.below(
          parent < 0 ? glm::mat4(1) : all.motions[static_cast<std::size_t>(parent)], static_cast<int>(i));
    }
    for (std::size_t body = 0; body < all.parts.size(); ++body) {
      NodesInPose& nodes = all.parts[body];
      if (nodes.influences.empty()) continue;
      const glm::mat4 to_object = affine(all.rest[body].to_object),
                      from_object = glm::affineInverse(to_object);
      nodes.bent = false;
      for (std::size_t i = 0; i < nodes.followed.size(); ++i) {
        const std::uint16_t of = nodes.followed[i];
        const bool bent = bends(posedPart(all.rest[of], pose, of));
        nodes.maps[i] = bent ? glm::mat4(0) : product(from_object, product(all.motions[of], to_object));
        nodes.bent = nodes.bent || bent;
      }
      nodes.around = nodes.bent ? Box{} : boundsOfMaps(pose, static_cast<int>(body));
    }
    return true;
  });
  return all.motions;
}

bool PoseCages::follow(const Pose& pose, int part, std::span<const Influences> influences,
                       const std::uint32_t* places, int side, glm::vec3* nodes) {
  motionsOf(pose);
  const PoseCages& all = *pose.cages();
  const NodesInPose& in = *of(pose, part);
  const auto scale = static_cast<float>(side);
  const glm::mat4* const maps = in.maps.data();
  const std::uint16_t* const slots = in.slots.data();
  // Each node is written with one float more, which the next one overwrites.
  for (std::size_t i = 0; i < influences.size(); ++i) {
    const Influences& its = influences[i];
    const glm::vec3 rest = scale * glm::vec3(latticePoint(places[i]));
    const Lanes x = rest.x, y = rest.y, z = rest.z;
    Lanes at = 0.0f;
    for (int k = 0; k < 4 && its.weights[k] > 0; ++k) {
      const float* const map = &maps[slots[its.parts[k]]][0].x;
      at = at + static_cast<float>(its.weights[k]) * ((Lanes::load(map + 12) + x * Lanes::load(map)) +
                                                      (y * Lanes::load(map + 4) + z * Lanes::load(map + 8)));
    }
    (at * (1.0f / 255)).store(&nodes[i].x);
  }
  for (std::size_t i = 0; i < in.followed.size() && in.bent; ++i) {
    const std::uint16_t of = in.followed[i];
    if (bends(posedPart(all.rest[of], pose, of)))
      addBent(all, pose, part, of, influences, places, scale, nodes);
  }
  if (!badNode(pose, part, nodes, influences.size())) return true;
  for (std::size_t i = 0; i < influences.size(); ++i) nodes[i] = scale * glm::vec3(latticePoint(places[i]));
  return false;
}

Box PoseCages::followedBounds(const Pose& pose, int part) {
  motionsOf(pose);
  const NodesInPose& in = *of(pose, part);
  if (!in.bent) return in.around;
  Box all;
  if (!place(pose, part)) return all;
  for (std::uint32_t i = 0; i < in.cages[0].node_count; ++i) all.add(in.cages[0].nodes[i]);
  return all;
}

// Each node lies between the places to which its parts take it.
Box PoseCages::boundsOfMaps(const Pose& pose, int part) {
  const NodesInPose& in = *of(pose, part);
  Box all;
  for (std::size_t i = 0; i < in.followed.size(); ++i) {
    const Box box = transformed(in.maps[i], in.boxes[i]);
    if (badNode(pose, part, &box.min, 1) || badNode(pose, part, &box.max, 1)) return {};
    all.add(box.min);
    all.add(box.max);
  }
  return all;
}

}  // namespace kelp::runtime
