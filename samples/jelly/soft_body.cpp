// SPDX-License-Identifier: MIT
#include "soft_body.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

namespace runtime = kelp::runtime;

namespace {

constexpr float kGravity = 9.81f;
constexpr float kDensity = 1000;   // kg per cubic meter
constexpr float kEdgeHertz = 36;   // an edge alone, between two nodes of mean mass
constexpr float kShapeHertz = 10;  // a node that is held to the shape
constexpr float kDamping = 1.5f;   // a second: of motion against the body's middle
constexpr float kFriction = 0.4f;  // of sliding on the ground
constexpr int kSteps = 10;         // for each step() of a sixtieth of a second
constexpr float kTurn = 6.2831853f;

// The share of its way home that a spring takes in a time: a step of the implicit Euler method. In XPBD's
// words, the compliance of a constraint is its inverse mass over the square of its angular frequency.
float shareOf(float hertz, float seconds) {
  const float turn = kTurn * hertz * seconds;
  return turn * turn / (1 + turn * turn);
}

// The rotation nearest to a matrix, from a guess (Mueller et al. 2016, A robust method to extract the
// rotational part of deformations).
glm::quat rotationOf(const glm::mat3& m, glm::quat q) {
  for (int i = 0; i < 8; ++i) {
    const glm::mat3 r = glm::mat3_cast(q);
    const glm::vec3 turn =
        (glm::cross(r[0], m[0]) + glm::cross(r[1], m[1]) + glm::cross(r[2], m[2])) /
        (std::abs(glm::dot(r[0], m[0]) + glm::dot(r[1], m[1]) + glm::dot(r[2], m[2])) + 1e-12f);
    const float angle = glm::length(turn);
    if (!(angle > 1e-7f)) break;
    q = glm::normalize(glm::angleAxis(angle, turn / angle) * q);
  }
  return q;
}

}  // namespace

SoftBody::SoftBody(const runtime::Asset& asset, int part) : part_(part) {
  const kelp::Part& of = asset.pack().parts()[std::size_t(part)];
  const kelp::Cage& cage = of.cages[0];
  const runtime::Instance at_rest{&asset};
  voxel_ = glm::length(of.to_object[0]);
  to_part_ = glm::inverse(glm::mat4(of.to_object));
  std::vector<float> volumes(cage.nodes());
  nodeVolumes(asset, part, volumes).value();
  float all = 0;
  for (const float volume : volumes) all += volume;
  const float mean = all / float(cage.nodes());
  for (std::uint32_t i = 0; i < cage.nodes(); ++i) {
    Node node{};
    node.rest = of.to_object * glm::vec4(cage.rest(i), 1);
    // A node with hardly any solid would be too light to be steered.
    node.mass = kDensity * voxel_ * voxel_ * voxel_ * std::max(volumes[i], 0.2f * mean);
    node.inverse_mass = 1 / node.mass;
    node.to_solid = closestPoint(at_rest, node.rest).value().point - node.rest;
    mass_ += double(node.mass);
    rest_middle_ += node.mass * node.rest;
    at_.push_back(node);
  }
  rest_middle_ /= float(mass_);
  for (Node& node : at_) node.rest -= rest_middle_;
  const kelp::Buffer<runtime::NodeEdge> edges = runtime::nodeEdges(asset, part).value();
  for (const auto& [a, b] : edges.span()) edges_.push_back({a, b, glm::distance(at_[a].rest, at_[b].rest)});
  drop(0, 0);
}

void SoftBody::drop(float height, float tilt) {
  turn_ = glm::angleAxis(tilt, glm::normalize(glm::vec3(0.3f, 0, 1)));
  for (Node& node : at_) {
    node.at = node.before = turn_ * node.rest + rest_middle_ + glm::vec3(0, height, 0);
    node.velocity = glm::vec3(0);
  }
  findShape();
}

void SoftBody::fling(float speed) {
  for (Node& node : at_) node.velocity += speed * glm::normalize(node.rest);
}

void SoftBody::step(float seconds, runtime::Instances ground, const std::optional<runtime::Sphere>& finger) {
  findGround(ground, seconds);
  const float h = seconds / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    glm::vec3 drift(0);
    for (const Node& node : at_) drift += node.mass * node.velocity;
    drift /= float(mass_);
    for (Node& node : at_) {
      node.velocity += kDamping * h * (drift - node.velocity);
      node.velocity.y -= kGravity * h;
      node.before = node.at;
      node.at += h * node.velocity;
    }
    holdEdges(h);
    holdShape(h);
    if (finger) leave(*finger);
    stayAbove();
    for (Node& node : at_) node.velocity = (node.at - node.before) / h;
  }
}

// Asks where the ground is, once a frame for each node near it: a plane, for as far as a node flies in a
// frame. Neighbors may pull a node faster than it flew.
void SoftBody::findGround(runtime::Instances ground, float seconds) {
  std::vector<kelp::Box> boxes;
  for (const runtime::Instance& one : ground) boxes.push_back(bounds(one));
  for (Node& node : at_) {
    node.height = -INFINITY;
    const glm::vec3 at = node.at + turn_ * node.to_solid;
    const auto near = distance(ground, at, boxes);
    if (!near) continue;  // a node that flew away is no point of the world
    if (near->bound > 0.05f + 2 * seconds * glm::length(node.velocity)) continue;
    node.normal = near->away;
    node.height = glm::dot(node.normal, at) - near->bound;
  }
}

void SoftBody::holdEdges(float seconds) {
  const float share = shareOf(kEdgeHertz, seconds);
  for (const Edge& edge : edges_) {
    Node &a = at_[edge.a], &b = at_[edge.b];
    const glm::vec3 way = b.at - a.at;
    const float length = glm::length(way);
    if (!(length > 0)) continue;
    const float push = share * (1 - edge.length / length) / (a.inverse_mass + b.inverse_mass);
    a.at += push * a.inverse_mass * way;
    b.at -= push * b.inverse_mass * way;
  }
}

// The middle and the turn of the body as it is.
void SoftBody::findShape() {
  glm::vec3 sum(0);
  for (const Node& node : at_) sum += node.mass * node.at;
  middle_ = sum / float(mass_);
  glm::mat3 moments(0);
  for (const Node& node : at_) moments += glm::outerProduct(node.mass * (node.at - middle_), node.rest);
  turn_ = rotationOf(moments, turn_);
}

void SoftBody::holdShape(float seconds) {
  findShape();
  const float share = shareOf(kShapeHertz, seconds);
  for (Node& node : at_) node.at += share * (middle_ + turn_ * node.rest - node.at);
}

void SoftBody::stayAbove() {
  for (Node& node : at_) {
    const float below = node.height - glm::dot(node.normal, node.at + turn_ * node.to_solid);
    if (!(below > 0)) continue;
    node.at += below * node.normal;
    const glm::vec3 way = node.at - node.before, slid = way - glm::dot(way, node.normal) * node.normal;
    const float far = glm::length(slid);
    if (far > 0) node.at -= std::min(kFriction * below / far, 1.0f) * slid;
  }
}

void SoftBody::leave(const runtime::Sphere& finger) {
  for (Node& node : at_) {
    const glm::vec3 away = node.at - finger.center;
    const float distance = glm::length(away);
    if (distance > 0 && distance < finger.radius) node.at += (finger.radius / distance - 1) * away;
  }
}

void SoftBody::write(runtime::Pose& pose) const {
  const std::span<glm::vec3> nodes = pose.nodes(part_);
  for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i] = to_part_ * glm::vec4(at_[i].at, 1);
}

double SoftBody::energy() const {
  const double hold = double(kTurn) * double(kShapeHertz);
  double sum = 0;
  for (const Node& node : at_) {
    const glm::dvec3 v(node.velocity), off(middle_ + turn_ * node.rest - node.at);
    sum += double(node.mass) * (0.5 * glm::dot(v, v) + double(kGravity) * double(node.at.y) +
                                0.5 * hold * hold * glm::dot(off, off));
  }
  for (const Edge& edge : edges_) {
    const double off = double(glm::distance(at_[edge.a].at, at_[edge.b].at)) - double(edge.length);
    const double swing = double(kTurn) * double(kEdgeHertz) * off;
    sum += 0.5 * swing * swing / double(at_[edge.a].inverse_mass + at_[edge.b].inverse_mass);
  }
  return sum;
}

double SoftBody::strain() const {
  float most = 0;
  for (const Node& node : at_) most = std::max(most, glm::distance(middle_ + turn_ * node.rest, node.at));
  return double(most / voxel_);
}
