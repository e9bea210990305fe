// SPDX-License-Identifier: MIT
// Springs on the nodes of cages.
#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "../posed_part.h"
#include "cage_map.h"
#include "kelp/runtime/spring.h"
#include "kelp/simd/lanes.h"
#include "pose_nodes.h"

namespace kelp::runtime {

// A sphere, and the way between its space (the world, from its center) and a part.
struct Spring::Ball {
  float radius = 0;
  glm::mat3 turn{1}, to_part{1};
  float most = 0;  // of a push: limit() would cut more than this anyway
};

namespace {

// Nodes that swing less, in heights of the part, are at rest.
constexpr float kStill = 0x1p-20f;
// How far a push reaches around a contact, in radii or tetrahedra. Sides of a weight of (1 - x^2)^2 are less
// steep than 1.54 over that, so a push by a radius folds nothing.
constexpr float kRange = 2.5f;

float lengthSquared(const glm::vec3& v) { return glm::dot(v, v); }

// The point of a cage that is nearest to the origin.
struct CageContact {
  float distance = 0;
  glm::vec3 at{0};
  float tetrahedron = 0;  // its longest edge there
  bool within = false;    // the origin lies in the cells, or in the middle of the solid
};

// The point lies on a face of its cell beyond which the solid goes on, without a cell.
bool isAtInside(const Cage& cage, std::uint32_t cell, const glm::dvec3& rest) {
  const glm::dvec3 in_cell = rest - glm::dvec3(cage.side * cage.place(cell));
  for (int axis = 0; axis < 3; ++axis) {
    const double near = 1e-6 * cage.side;
    if (in_cell[axis] < near && cage.beyond(cell, 2 * axis) == kCageInside) return true;
    if (in_cell[axis] > cage.side - near && cage.beyond(cell, 2 * axis + 1) == kCageInside) return true;
  }
  return false;
}

// Nearer than best.distance, of a cell.
void nearestOfCell(const Cage& cage, std::uint32_t cell, std::span<const glm::vec3> places, bool mirrored,
                   CageContact& best) {
  using simd::Lanes;
  Lanes low = INFINITY, high = -INFINITY;
  for (int i = 0; i < 8; ++i) {
    const Lanes at = Lanes::load(&places[cage.node(cell, i)].x);
    low = min(at, low);
    high = max(at, high);
  }
  const Lanes off = max(max(low, 0.0f - high), 0.0f);
  float to_box[4];
  off.store(to_box);
  if (!(lengthSquared({to_box[0], to_box[1], to_box[2]}) < best.distance * best.distance)) return;
  glm::dvec3 corners[8];
  for (int i = 0; i < 8; ++i) corners[i] = glm::dvec3(places[cage.node(cell, i)]);
  for (const CageTetrahedron& kind : kCageTetrahedra) {
    const PosedTetrahedron t = runtime::tetrahedronBy(kind, cage, cell, corners);
    if (!((mirrored ? -t.volume : t.volume) > 0)) continue;
    const NearestPoint nearest = nearestPoint(t, glm::dvec3(0));
    if (!(nearest.distance < static_cast<double>(best.distance))) continue;
    double edge2 = 0;
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < i; ++k) {
        const glm::dvec3 edge = t.corners[i] - t.corners[k];
        edge2 = std::max(edge2, glm::dot(edge, edge));
      }
    best = {static_cast<float>(nearest.distance), glm::vec3(nearest.at), static_cast<float>(std::sqrt(edge2)),
            nearest.distance == 0 || isAtInside(cage, cell, nearest.rest)};
  }
}

// The cells that a sphere meets. The others go along as far as their nodes give way: if a sphere met these,
// it would push them again and again.
struct Yielding {
  std::span<const float> shares;  // of nodes; empty: all give way
  float least;

  bool holds(const Cage& cage, std::uint32_t cell) const {
    for (int i = 0; i < 8 && !shares.empty(); ++i)
      if (shares[cage.node(cell, i)] < least) return false;
    return true;
  }
};

// Nearer than the radius, or around the origin.
CageContact contactOf(const Cage& cage, std::span<const glm::vec3> places, const Yielding& yielding,
                      bool mirrored, float radius) {
  Box box;
  for (const glm::vec3& place : places) box.add(place);
  const bool is_in_box = box.min == glm::min(box.min, 0.0f) && box.max == glm::max(box.max, 0.0f);
  CageContact best{radius};
  for (int turn = 0; turn < (is_in_box ? 2 : 1) && best.distance >= radius; ++turn) {
    best.distance = turn == 0 ? radius : INFINITY;
    for (std::uint32_t cell = 0; cell < cage.cells() && best.distance > 0; ++cell)
      if (yielding.holds(cage, cell)) nearestOfCell(cage, cell, places, mirrored, best);
  }
  return best;
}

// The nearest point of the cage's surface that may move.
glm::vec3 nearestWayOut(const Cage& cage, std::span<const glm::vec3> places, const Yielding& yielding,
                        bool bottom_fixed, bool top_fixed) {
  NearestPoint best;
  best.distance = INFINITY;
  for (std::uint32_t i = 0; i < cage.faces(); ++i) {
    const std::uint32_t word = cage.face(i), cell = word >> 5;
    const CageTetrahedron& kind = kCageTetrahedra[word >> 2 & 7];
    const int face = static_cast<int>(word & 3);
    const bool at_bottom = kind.axes[2] == 1 && face == 3 && cage.place(cell).y == 0,
               at_top = kind.axes[0] == 1 && face == 0 && cage.place(cell).y + 1 == cage.grid.y;
    if ((bottom_fixed && at_bottom) || (top_fixed && at_top) || !yielding.holds(cage, cell)) continue;
    glm::dvec3 corners[8];
    for (int k = 0; k < 8; ++k) corners[k] = glm::dvec3(places[cage.node(cell, k)]);
    const NearestPoint nearest =
        nearestOfFace(runtime::tetrahedronBy(kind, cage, cell, corners), face, glm::dvec3(0));
    if (nearest.distance < best.distance) best = nearest;
  }
  return glm::vec3(best.at);
}

// Where the sections of a lattice are by a part's spline: axes and places, as of sectionAt().
class Sections {
 public:
  explicit Sections(const PosedPart& posed)
      : posed_(posed), sound_(posed.check() && (!posed.isSwept() || posed.arcs(chain_))) {}
  bool areSound() const { return sound_; }
  glm::mat4x3 at(float y) const {
    if (posed_.isSwept()) return sectionAt(chain_, y);
    glm::mat4x3 level(1);
    level[3] = shear(posed_.knots, posed_.part->size, {0, y, 0});
    return level;
  }

 private:
  const PosedPart& posed_;
  ArcChain chain_;
  bool sound_;
};

// The weight of a push at a node whose squared distance from the contact is so many squared ranges.
float weightAt(float range2) {
  const float left = std::max(1 - range2, 0.0f);
  return left * left;
}

}  // namespace

std::span<const Swing> Spring::nodes(int part) const {
  if (part < 0 || part >= parts()) return {};
  const Body& body = bodies_[static_cast<std::size_t>(part)];
  return node_swings_.span().subspan(body.first_node, body.nodes);
}

// How the knots' offsets move the sections of a lattice: in each, a node that is (x, z) from the middle moves
// by the move times (x, 0, z, 1), voxels. followed: the part as it is bent without the spring; null: nodes
// are the host's. False: no knot is moved.
bool Spring::movesOf(const Body& body, int side, const PosedPart* followed,
                     std::span<glm::mat4x3> moves) const {
  std::fill(moves.begin(), moves.end(), glm::mat4x3(0));
  const std::span<const Swing> swings = swings_.span().subspan(body.first, body.knots);
  const bool still = std::all_of(swings.begin(), swings.end(),
                                 [](const Swing& swing) { return swing.offset == glm::vec3(0); });
  if (still || body.knots < 2) return false;
  Knot room[kMaxKnots];
  const std::span<Knot> knots(room, body.knots);
  const auto heightOf = [&](std::size_t i) {
    return std::min(static_cast<float>(side) * static_cast<float>(i), body.height);
  };
  if (followed) {
    std::copy(followed->knots.begin(), followed->knots.end(), knots.begin());
    addTo(body, knots);
    PosedPart moved = *followed;
    moved.knots = knots;
    const Sections before(*followed), after(moved);
    for (std::size_t i = 0; i < moves.size() && before.areSound() && after.areSound(); ++i)
      moves[i] = after.at(heightOf(i)) - before.at(heightOf(i));
    return true;
  }
  for (std::uint32_t i = 0; i < body.knots; ++i) knots[i] = {at_rest_[body.first + i].at};
  addTo(body, knots);
  std::size_t k = 0;
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const float at = heightOf(i) / body.height;
    while (k + 2 < knots.size() && at > knots[k + 1].at) ++k;
    moves[i][3] = evaluate(makeSegment(knots[k], knots[k + 1], body.height),
                           (at - knots[k].at) / (knots[k + 1].at - knots[k].at));
  }
  return true;
}

Result<bool> Spring::pushNodesAway(Body& body, const Instance& instance, int part, const glm::mat4& to_world,
                                   const glm::vec3& center, float radius) {
  const Result<PosedCage> posed = posedCage(instance, part, 0, CageUse::kBounds);
  if (!posed) return posed.error().code == ErrorCode::kOutOfMemory ? Result<bool>(posed.error()) : false;
  const Cage& cage = *posed->cage;
  glm::mat4 to_ball = to_world;
  to_ball[3] -= glm::vec4(center, 0);
  Ball ball{radius, glm::mat3(to_ball), glm::inverse(glm::mat3(to_ball))};
  // The part has no extent.
  if (!allFinite(ball.to_part[0]) || !allFinite(ball.to_part[1]) || !allFinite(ball.to_part[2])) return false;
  const float scale =
      std::sqrt(lengthSquared(ball.turn[0]) + lengthSquared(ball.turn[1]) + lengthSquared(ball.turn[2]));
  ball.most = 4 * scale * options_.reach * body.height;

  glm::mat4x3 room[kMostCageCells + 1];
  const std::span<glm::mat4x3> moves(room, static_cast<std::size_t>(cage.grid.y) + 1);
  const bool is_hosts = instance.pose && PoseCages::of(*instance.pose, part)->written;
  const PosedPart followed = posedPart(instance, part);
  // Nodes that follow other parts do not move with this one's knots.
  const bool follows = !is_hosts && !cage.influences.empty();
  if (follows) std::fill(moves.begin(), moves.end(), glm::mat4x3(0));
  const bool knots_move = !follows && movesOf(body, cage.side, is_hosts ? nullptr : &followed, moves);
  const std::span<Swing> swings = node_swings_.span().subspan(body.first_node, body.nodes);
  // Most parts are far away. How far are nodes from the pose?
  float far2 = 0, far_by_knots = 0;
  for (std::uint32_t i = body.moved; i < body.moved_end; ++i)
    far2 = std::max(far2, lengthSquared(swings[i].offset));
  for (const glm::mat4x3& move : moves) {
    const glm::vec2 beside = glm::vec2(body.middle.x, body.middle.z) + static_cast<float>(cage.side);
    far_by_knots = std::max(far_by_knots, beside.x * glm::length(move[0]) + beside.y * glm::length(move[2]) +
                                              glm::length(move[3]));
  }
  const Box& box = posed->bounds;
  const glm::vec3 middle(to_ball * glm::vec4(0.5f * (box.min + box.max), 1));
  const float extent = 0.5f * glm::distance(box.min, box.max) + std::sqrt(far2) * body.height + far_by_knots;
  if (!(glm::length(middle) <= radius + scale * extent)) return false;

  const std::span<glm::vec3> places = node_places_.span().first(body.nodes);
  const PosedCage near = posedCage(instance, part, 0).value();  // its pose was good when it was bounded
  for (std::uint32_t i = 0; i < body.nodes; ++i) {
    glm::vec3 off = body.height * swings[i].offset;
    if (knots_move) {
      const glm::vec3 from_middle = glm::vec3(cage.rest(i)) - body.middle;
      off += moves[cage.places[i] >> 10 & 1023] * glm::vec4(from_middle.x, 0, from_middle.z, 1);
    }
    places[i] = glm::vec3(to_ball * glm::vec4(near.nodes[i] + off, 1));
  }
  const bool mirrored = glm::determinant(ball.turn) < 0;
  Yielding yielding{{}, body.least_share};
  if (!node_shares_.empty()) yielding.shares = node_shares_.span().subspan(body.first_node, body.nodes);
  constexpr int kRounds = 8;
  for (int round = 0; round < kRounds; ++round) {
    const CageContact contact = contactOf(cage, places, yielding, mirrored, radius);
    if (!contact.within && !(contact.distance < 0.999f * radius)) return round > 0;
    // From where, by how much and whereto nodes go.
    glm::vec3 from = contact.at, direction = contact.at;
    float way = radius - contact.distance;
    if (contact.within) {
      direction = -nearestWayOut(cage, places, yielding, body.root == Root::kBottom, body.root == Root::kTop);
      way = radius + glm::length(direction);
      from = glm::vec3(0);
    }
    const float length = glm::length(direction);
    direction = length > 1e-6f * radius ? direction / length : glm::normalize(ball.turn[0]);
    pushNodes(body, cage, ball, from, std::min(way, ball.most) * direction,
              kRange * std::max({radius, way, contact.tetrahedron}));
  }
  return true;
}

// Pushes the nodes around a place by at most `out`.
void Spring::pushNodes(Body& body, const Cage& cage, const Ball& ball, const glm::vec3& at,
                       const glm::vec3& out, float range) {
  const glm::vec3 offset = ball.to_part * out / body.height;
  const glm::vec3 normal = glm::normalize(glm::transpose(ball.turn) * out);
  if (!allFinite(offset) || !allFinite(normal)) return;
  const std::span<Swing> swings = node_swings_.span().subspan(body.first_node, body.nodes);
  for (std::uint32_t i = 0; i < body.nodes; ++i) {
    float share = shareOfNode(body, static_cast<float>(cage.rest(i).y) / body.height);
    if (!node_shares_.empty()) share *= node_shares_[body.first_node + i];
    glm::vec3& place = node_places_[i];
    const float weight = share * weightAt(lengthSquared((place - at) / range));
    if (!(weight > 0)) continue;
    Swing& swing = swings[i];
    const Swing before = swing;
    swing.offset += weight * offset;
    swing.velocity -= weight * std::min(glm::dot(swing.velocity, normal), 0.0f) * normal;
    limit(swing, glm::vec3(0), options_.reach * share, energyOf(before, glm::vec3(0)));
    place += ball.turn * (body.height * (swing.offset - before.offset));
    body.moved = body.moved == body.moved_end ? i : std::min(body.moved, i);
    body.moved_end = std::max(body.moved_end, i + 1);
  }
}

// offset = a offset + b velocity, velocity = c offset + d velocity.
void Spring::stepNodes(Body& body, float a, float b, float c, float d) {
  const std::span<Swing> moved =
      node_swings_.span().subspan(body.first_node + body.moved, body.moved_end - body.moved);
  float most = 0;
  for (Swing& swing : moved) {
    const Swing before = swing;
    swing.offset = a * before.offset + b * before.velocity;
    swing.velocity = c * before.offset + d * before.velocity;
    most = std::max(most, energyOf(swing, glm::vec3(0)));
  }
  if (most > kStill * kStill) return;
  std::fill(moved.begin(), moved.end(), Swing{});
  body.moved = body.moved_end = 0;
}

// True: the nodes are the host's from now on.
bool Spring::addToNodes(const Body& body, int part, Pose& pose) const {
  const NodesInPose* const in = PoseCages::of(pose, part);
  if (!in) return false;
  const std::uint32_t* const places = in->places;
  glm::mat4x3 moves[kMostCageCells + 1];
  const bool knots_move = in->written && movesOf(body, in->side, nullptr, moves);
  if (!knots_move && body.moved == body.moved_end) return false;
  const std::span<glm::vec3> nodes = pose.nodes(part);
  if (knots_move)
    for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i] += moves[places[i] >> 10 & 1023][3];
  const std::span<const Swing> swings = node_swings_.span().subspan(body.first_node, body.nodes);
  for (std::uint32_t i = body.moved; i < body.moved_end; ++i)
    if (swings[i].offset != glm::vec3(0)) nodes[i] += body.height * swings[i].offset;
  return true;
}

}  // namespace kelp::runtime
