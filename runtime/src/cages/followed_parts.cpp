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

glm::vec3 restOf(const PoseCages::Following& cage, std::size_t node) {
  return static_cast<float>(cage.side) * glm::vec3(latticePoint(cage.places[node]));
}
float weightOf(const Pose& pose, const Morph& morph) {
  return pose.motion(static_cast<int>(morph.part))->translation.x;
}
// By how much all morph targets move a node at rest.
glm::vec3 offsetOf(const Pose& pose, std::span<const Morph> morphs, std::size_t node) {
  glm::vec3 sum(0);
  for (const Morph& morph : morphs) {
    const auto at = std::lower_bound(morph.moved.begin(), morph.moved.end(), node,
                                     [](const MovedNode& one, std::size_t of) { return one.node < of; });
    if (at != morph.moved.end() && at->node == node) sum += weightOf(pose, morph) * at->offset;
  }
  return sum;
}

void addBent(const PoseCages& cages, const Pose& pose, int follower, std::size_t part,
             const PoseCages::Following& cage, glm::vec3* nodes) {
  const BentMap bent(posedPart(cages.rest[part], pose, static_cast<int>(part)));
  const glm::mat4 from = affine(cages.rest[static_cast<std::size_t>(follower)].to_object),
                  to_part = glm::affineInverse(affine(cages.rest[part].to_object)) * from,
                  back = glm::affineInverse(from) * cages.motions[part] * affine(cages.rest[part].to_object);
  for (std::size_t i = 0; i < cage.influences.size(); ++i)
    for (int k = 0; k < 4; ++k) {
      const Influences& its = cage.influences[i];
      if (its.weights[k] == 0 || its.parts[k] != part) continue;
      const glm::vec3 rest = restOf(cage, i) + offsetOf(pose, cage.morphs, i);
      const glm::vec3 at(back * glm::vec4(bent.place(glm::vec3(to_part * glm::vec4(rest, 1.0f))), 1.0f));
      nodes[i] += static_cast<float>(its.weights[k]) / 255.0f * at;
    }
}

}  // namespace

std::uint64_t PoseCages::stateOf(const Pose& pose) {
  return XXH3_64bits(const_cast<Pose&>(pose).state(), pose.stateBytes()) >> 2;
}

std::uint64_t PoseCages::sumOf(std::span<const Knot> knots) {
  return XXH3_64bits(knots.data(), knots.size_bytes()) >> 2;
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

bool PoseCages::follow(const Pose& pose, int part, const Following& cage, glm::vec3* nodes) {
  motionsOf(pose);
  const PoseCages& all = *pose.cages();
  const NodesInPose& in = *of(pose, part);
  const glm::mat4* const maps = in.maps.data();
  const std::uint16_t* const slots = in.slots.data();
  const std::size_t count = cage.influences.size();
  for (std::size_t i = 0; i < count; ++i) nodes[i] = restOf(cage, i);
  for (const Morph& morph : cage.morphs) {
    const float weight = weightOf(pose, morph);
    for (std::size_t i = 0; weight != 0 && i < morph.moved.size(); ++i)
      nodes[morph.moved[i].node] += weight * morph.moved[i].offset;
  }
  // Each node is written with one float more, the next one's.
  glm::vec3 next = nodes[0];
  for (std::size_t i = 0; i < count; ++i) {
    const Influences& its = cage.influences[i];
    const Lanes x = next.x, y = next.y, z = next.z;
    if (i + 1 < count) next = nodes[i + 1];
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
    if (bends(posedPart(all.rest[of], pose, of))) addBent(all, pose, part, of, cage, nodes);
  }
  if (!badNode(pose, part, nodes, count)) return true;
  for (std::size_t i = 0; i < count; ++i) nodes[i] = restOf(cage, i);
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
  glm::vec3 morphed(0);
  for (const Morph& morph : in.morphs) {
    const float weight = std::abs(weightOf(pose, morph));
    glm::vec3 farthest(0);
    for (std::size_t i = 0; weight != 0 && i < morph.moved.size(); ++i)
      farthest = glm::max(farthest, glm::abs(morph.moved[i].offset));
    morphed += weight * farthest;
  }
  Box all;
  for (std::size_t i = 0; i < in.followed.size(); ++i) {
    const Box box = transformed(in.maps[i], {in.boxes[i].min - morphed, in.boxes[i].max + morphed});
    if (badNode(pose, part, &box.min, 1) || badNode(pose, part, &box.max, 1)) return {};
    all.add(box.min);
    all.add(box.max);
  }
  return all;
}

}  // namespace kelp::runtime
