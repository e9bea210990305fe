// SPDX-License-Identifier: MIT
#include "kelp/runtime/spring.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "cages/pose_nodes.h"
#include "kelp/simd/bound_knots.h"
#include "pose_writer.h"
#include "posed_part.h"

namespace kelp::runtime {
namespace {

constexpr float kHighestFrequency = 10000;
// The lowest height of a load. A beam that is loaded lower would bend beyond all bounds.
constexpr float kLowestLoad = 0.25f;

float squared(const glm::vec3& v) { return glm::dot(v, v); }

// The deflection at `at` of a beam that is clamped at 0, under an even load, relative to that of its free
// end at 1 (Euler and Bernoulli).
float evenLoad(float at) { return at * at * (at * (at - 4) + 6) / 3; }
// Its deflection at `at` under a load at `load`, relative to that at the load.
float pointLoad(float at, float load) {
  const float a = std::max(load, kLowestLoad);
  return at < a ? at * at * (3 * a - at) / (2 * a * a * a) : (3 * at - a) / (2 * a);
}

// The way from the end that is fixed to a place of the axis.
float fromRoot(bool from_top, float at) { return from_top ? 1 - at : at; }

// A damped harmonic oscillator after some time: offset = a offset + b velocity, velocity = c offset + d
// velocity.
struct Advance {
  float a, b, c, d;
};

Advance advanceBy(double seconds, double omega, double damping) {
  const double decay = damping * omega;
  // Squared angular frequency of the damped swing; negative if it is overdamped.
  const double k2 = omega * omega * (1 - damping * damping);
  double sine, cosine;  // e^(-decay t) times sin(k t) / k and cos(k t)
  if (const double x = k2 * seconds * seconds; std::abs(x) < 1e-4) {
    // Near critical damping: the series, accurate to the last digit.
    const double e = std::exp(-decay * seconds);
    sine = e * seconds * (1 - x / 6 * (1 - x / 20 * (1 - x / 42)));
    cosine = e * (1 - x / 2 * (1 - x / 12 * (1 - x / 30)));
  } else if (k2 > 0) {
    const double k = std::sqrt(k2), e = std::exp(-decay * seconds);
    sine = e * std::sin(k * seconds) / k;
    cosine = e * std::cos(k * seconds);
  } else {
    // Both exponents without overflow and cancellation: their product is omega^2.
    const double k = std::sqrt(-k2), fast = decay + k, slow = omega * omega / fast;
    const double e_slow = std::exp(-slow * seconds), e_fast = std::exp(-fast * seconds);
    sine = (e_slow - e_fast) / (2 * k);
    cosine = (e_slow + e_fast) / 2;
  }
  return {static_cast<float>(cosine + decay * sine), static_cast<float>(sine),
          static_cast<float>(-omega * omega * sine), static_cast<float>(cosine - decay * sine)};
}

// The point of the curve, moved by `middle`, that is nearest to a point in the world. The curve is
// approximated by straight pieces.
struct Nearest {
  float distance = HUGE_VALF;
  glm::vec3 from{0};  // from the point to the curve; world
  float at = 0;       // along the axis
};

Nearest nearestTo(const glm::vec3& point, std::span<const Knot> knots, float height, const glm::vec3& middle,
                  const glm::mat4& to_world) {
  constexpr int kPieces = 8;
  Nearest nearest;
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    const Segment segment = makeSegment(knots[i], knots[i + 1], height);
    glm::vec3 begin(0);
    for (int piece = 0; piece <= kPieces; ++piece) {
      const float t = static_cast<float>(piece) / kPieces;
      const glm::vec3 end = glm::vec3(to_world * glm::vec4(evaluate(segment, t) + middle, 1)) - point;
      if (piece > 0) {
        const glm::vec3 chord = end - begin;
        const float length = squared(chord);
        const float along = length > 0 ? std::clamp(-glm::dot(begin, chord) / length, 0.0f, 1.0f) : 0.0f;
        const glm::vec3 from = begin + along * chord;
        if (const float distance = glm::length(from); distance < nearest.distance) {
          const float parameter = t + (along - 1) / kPieces;
          nearest = {distance, from, knots[i].at + parameter * (knots[i + 1].at - knots[i].at)};
        }
      }
      begin = end;
    }
  }
  return nearest;
}

std::uint32_t nodesOf(const Part& part) { return part.cages.empty() ? 0 : part.cages[0].nodes(); }

constexpr Error kNoPart{ErrorCode::kMisuse, "there is no part of that index"};

}  // namespace

Error Spring::foreign() { return {ErrorCode::kMisuse, "the spring does not fit this asset or pose"}; }

Result<Spring> Spring::create(const Asset& asset, const SpringOptions& options, const Allocator& allocator) {
  if (!(options.frequency > 0 && options.frequency <= kHighestFrequency))
    return Error{ErrorCode::kMisuse, "a spring's frequency is out of range"};
  if (!(options.damping >= 0) || !std::isfinite(options.damping))
    return Error{ErrorCode::kMisuse, "a spring's damping is out of range"};
  if (!(options.reach > 0 && options.reach <= 1000))
    return Error{ErrorCode::kMisuse, "a spring's reach is out of range"};
  const std::span<const Part> parts = asset.pack().parts();
  std::size_t total = 0, nodes = 0, most_nodes = 0;
  for (const Part& part : parts) {
    total += part.knots.size();
    const std::size_t of_part = nodesOf(part);
    nodes += of_part;
    most_nodes = std::max(most_nodes, of_part);
  }
  Spring spring;
  spring.options_ = options;
  spring.options_.parts.reset();
  spring.omega_ = static_cast<float>(2 * std::numbers::pi * double{options.frequency});
  spring.bodies_ = Buffer<Body>(allocator);
  spring.swings_ = Buffer<Swing>(allocator);
  spring.rest_ = Buffer<Part>(allocator);
  spring.at_rest_ = Buffer<Knot>(allocator);
  spring.node_swings_ = Buffer<Swing>(allocator);
  spring.node_places_ = Buffer<glm::vec3>(allocator);
  // Four floats are read of the last place.
  if (!spring.bodies_.reset(parts.size()) || !spring.swings_.reset(total) ||
      !spring.rest_.reset(parts.size()) || !spring.at_rest_.reset(total) ||
      !spring.node_swings_.reset(nodes) || !spring.node_places_.reset(nodes == 0 ? 0 : most_nodes + 1)) {
    return Error{ErrorCode::kOutOfMemory, "no memory for a spring"};
  }
  std::uint32_t n = 0, node = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const glm::vec3 size(parts[i].size);
    spring.bodies_[i] = {n,
                         static_cast<std::uint32_t>(parts[i].knots.size()),
                         size.y,
                         {0.5f * size.x, 0, 0.5f * size.z},
                         glm::vec3(0),
                         node,
                         nodesOf(parts[i])};
    node += spring.bodies_[i].nodes;
    const std::span<Knot> knots = spring.at_rest_.span().subspan(n, parts[i].knots.size());
    std::copy(parts[i].knots.begin(), parts[i].knots.end(), knots.begin());
    n += spring.bodies_[i].knots;
    Part& rest = spring.rest_[i] = parts[i];
    rest.name = {};
    rest.knots = knots;
    rest.fog = nullptr;
    rest.cages = {};
    spring.bodies_[i].yields = parts[i].kind != PartKind::kEmpty;
    spring.bodies_[i].root = options.rooted ? Root::kBottom : Root::kNone;
  }
  if (options.parts)
    if (const Result<void> listed = spring.list(parts, *options.parts, allocator); !listed)
      return listed.error();
  if (const Result<void> hung = spring.hang(asset, allocator); !hung) return hung.error();
  return spring;
}

std::span<const Swing> Spring::knots(int part) const {
  if (part < 0 || part >= parts()) return {};
  const Body& body = bodies_[static_cast<std::size_t>(part)];
  return swings_.span().subspan(body.first, body.knots);
}

void Spring::reset() {
  std::fill(swings_.begin(), swings_.end(), Swing{});
  std::fill(node_swings_.begin(), node_swings_.end(), Swing{});
  for (Body& body : bodies_) {
    body.lean = glm::vec3(0);
    body.moved = body.moved_end = 0;
  }
}

bool Spring::fits(const Asset& asset) const {
  const std::span<const Part> parts = asset.pack().parts();
  return std::equal(parts.begin(), parts.end(), bodies_.begin(), bodies_.end(),
                    [](const Part& part, const Body& body) {
                      return part.knots.size() == body.knots && nodesOf(part) == body.nodes;
                    });
}

bool Spring::fits(const Pose& pose) const {
  if (pose.parts() != parts()) return false;
  for (int part = 0; part < parts(); ++part) {
    const Body& body = bodies_[static_cast<std::size_t>(part)];
    const NodesInPose* const in = PoseCages::of(pose, part);
    if (pose.knots(part).size() != body.knots || (in ? in->cages[0].node_count : 0) != body.nodes)
      return false;
  }
  return true;
}

// The share of a push to the free end that a knot gets.
float Spring::share(const Body& body, std::uint32_t knot) const {
  const float at = at_rest_[body.first + knot].at;
  return body.root == Root::kNone ? 1.0f : evenLoad(fromRoot(body.root == Root::kTop, at));
}

// The share of its reach that a node has. at: its height in the part, in heights.
float Spring::shareOfNode(const Body& body, float at) const {
  const float low = std::clamp(fromRoot(body.root == Root::kTop, at) / kLowestLoad, 0.0f, 1.0f);
  return body.root == Root::kNone ? 1.0f : low * low * (3 - 2 * low);
}

// Squared amplitude of the undamped swing about the place where the wind holds it.
float Spring::energyOf(const Swing& swing, const glm::vec3& held) const {
  return squared(swing.offset - held) + squared(swing.velocity / omega_);
}

// Cuts what a push added beyond the reach, or beyond the energy before the push.
void Spring::limit(Swing& swing, const glm::vec3& held, float reach, float energy_before) const {
  const float most = std::max(reach * reach, energy_before);
  glm::vec3 away = swing.offset - held;
  if (const float far = glm::length(away); far * far > most) {
    away *= std::sqrt(most) / far;
    swing.offset = held + away;
  }
  const float fastest = omega_ * std::sqrt(std::max(most - squared(away), 0.0f));
  if (const float fast = glm::length(swing.velocity); fast > fastest) swing.velocity *= fastest / fast;
}

Result<void> Spring::push(int part, const glm::vec3& velocity) {
  if (part < 0 || part >= parts()) return kNoPart;
  if (!allFinite(velocity)) return Error{ErrorCode::kMisuse, "a push is not finite"};
  const Body& body = bodies_[static_cast<std::size_t>(part)];
  // So that squares do not overflow. limit() cuts more than this anyway.
  const float most = 4 * omega_ * options_.reach;
  const glm::vec3 change = glm::clamp(velocity, glm::vec3(-most), glm::vec3(most));
  for (std::uint32_t i = 0; i < body.knots; ++i) {
    Swing& swing = swings_[body.first + i];
    const float of_push = share(body, i);
    const float before = energyOf(swing, of_push * body.lean);
    swing.velocity += of_push * change;
    limit(swing, of_push * body.lean, options_.reach * of_push, before);
  }
  return {};
}

Result<void> Spring::setWind(int part, const glm::vec3& acceleration) {
  if (part < 0 || part >= parts()) return kNoPart;
  if (!allFinite(acceleration)) return Error{ErrorCode::kMisuse, "wind is not finite"};
  Body& body = bodies_[static_cast<std::size_t>(part)];
  const double reach = options_.reach;
  const glm::dvec3 lean = glm::dvec3(acceleration) / (double{omega_} * double{omega_});
  const double length = glm::length(lean);
  body.lean = glm::vec3(length > reach ? lean * (reach / length) : lean);
  return {};
}

// A vector in the world, in heights of the part and in its axes.
Result<glm::vec3> Spring::fromWorld(const Instance& instance, int part, const glm::vec3& vector) const {
  if (!instance.asset || !fits(*instance.asset) || (instance.pose && !fits(*instance.pose))) return foreign();
  if (part < 0 || part >= parts()) return kNoPart;
  const glm::mat3 to_part = glm::inverse(glm::mat3(matrixOf(instance, part)));
  const glm::vec3 mapped = to_part * vector / bodies_[static_cast<std::size_t>(part)].height;
  if (!allFinite(mapped))
    return Error{ErrorCode::kMisuse, "a world vector is not finite, or the part has no extent in the world"};
  return mapped;
}

Result<void> Spring::pushInWorld(const Instance& instance, int part, const glm::vec3& velocity) {
  const Result<glm::vec3> mapped = fromWorld(instance, part, velocity);
  return mapped ? push(part, *mapped) : Result<void>(mapped.error());
}

Result<void> Spring::setWindInWorld(const Instance& instance, int part, const glm::vec3& acceleration) {
  const Result<glm::vec3> mapped = fromWorld(instance, part, acceleration);
  return mapped ? setWind(part, *mapped) : Result<void>(mapped.error());
}

Result<void> Spring::step(float seconds) {
  if (!(seconds >= 0) || !std::isfinite(seconds))
    return Error{ErrorCode::kMisuse, "a time step is negative or not finite"};
  const Advance by = advanceBy(double{seconds}, double{omega_}, double{options_.damping});
  for (Body& body : bodies_) {
    if (body.moved < body.moved_end) stepNodes(body, by.a, by.b, by.c, by.d);
    for (std::uint32_t i = 0; i < body.knots; ++i) {
      Swing& swing = swings_[body.first + i];
      const glm::vec3 held = share(body, i) * body.lean, away = swing.offset - held,
                      velocity = swing.velocity;
      swing.offset = held + (by.a * away + by.b * velocity);
      swing.velocity = by.c * away + by.d * velocity;
    }
  }
  return {};
}

void Spring::addTo(const Body& body, std::span<Knot> knots) const {
  const std::size_t n = knots.size();
  if (n < 2) return;
  const std::span<const Swing> swings = swings_.span().subspan(body.first, n);
  const auto secant = [&](std::size_t i) {
    return (swings[i + 1].offset - swings[i].offset) / (knots[i + 1].at - knots[i].at);
  };
  // At an inner knot: the slope of the parabola through it and its neighbors.
  const auto inner = [&](std::size_t i) {
    const float below = knots[i].at - knots[i - 1].at, above = knots[i + 1].at - knots[i].at;
    return (above * secant(i - 1) + below * secant(i)) / (below + above);
  };
  // At a free end: the slope without curvature there, given the slope at the other end of the segment.
  const auto free_end = [](const glm::vec3& slope, const glm::vec3& other) {
    return 0.5f * (3.0f * slope - other);
  };
  // The slope is 0 where the part is fixed.
  glm::vec3 first(0), last(0);
  if (body.root != Root::kBottom) {
    const glm::vec3 next = n > 2 ? inner(1) : body.root == Root::kTop ? last : secant(0);
    first = free_end(secant(0), next);
  }
  if (body.root != Root::kTop) last = free_end(secant(n - 2), n == 2 ? first : inner(n - 2));
  for (std::size_t i = 0; i < n; ++i) {
    knots[i].position += swings[i].offset;
    knots[i].tangent += i == 0 ? first : i + 1 == n ? last : inner(i);
  }
}

Result<void> Spring::addTo(Pose& pose) const {
  if (!fits(pose)) return foreign();
  beforeKnots(pose);
  for (int part = 0; part < parts(); ++part)
    addTo(bodies_[static_cast<std::size_t>(part)], PoseWriter::knots(pose, part));
  pose.clamp();
  beforeNodes(pose);
  bool moved = false;
  for (int part = 0; part < parts(); ++part)
    moved |= addToNodes(bodies_[static_cast<std::size_t>(part)], part, pose);
  if (moved) pose.clamp();
  follow(pose);
  return {};
}

bool Spring::pushAway(const Body& body, const Part& part, std::span<const Knot> pose,
                      const glm::mat4& to_world, const glm::vec3& center, float radius) {
  const glm::mat3 turn(to_world);
  const glm::mat3 to_part = glm::inverse(turn);
  // The part has no extent.
  if (!allFinite(to_part[0]) || !allFinite(to_part[1]) || !allFinite(to_part[2])) return false;
  // An upper bound of how much a vector grows.
  const float scale = std::sqrt(squared(turn[0]) + squared(turn[1]) + squared(turn[2]));
  // The contact moves less than the knots do, so repeat until the part is outside.
  constexpr int kRounds = 8;
  for (int round = 0; round < kRounds; ++round) {
    Knot bent[kMaxKnots];
    std::copy(pose.begin(), pose.end(), bent);
    const std::span<Knot> knots(bent, pose.size());
    addTo(body, knots);
    if (round == 0) {
      // Most parts are far away: compare bounding spheres first.
      Box box = simd::boundKnots(knots, part.size);
      if (part.bend == Bend::kSweep) {  // its sections turn
        const float reach = 0.5f * static_cast<float>(part.size.x + part.size.z);
        box.add(box.min - reach);
        box.add(box.max + reach);
      }
      const glm::vec3 middle(to_world * glm::vec4(0.5f * (box.min + box.max), 1));
      if (!(glm::distance(middle, center) <= radius + 0.5f * scale * glm::distance(box.min, box.max)))
        return false;
    }
    const Nearest nearest = nearestTo(center, knots, body.height, body.middle, to_world);
    if (!(nearest.distance < 0.999f * radius)) return round > 0;
    const glm::vec3 direction =
        nearest.distance > 1e-6f * radius ? nearest.from / nearest.distance : glm::normalize(turn[0]);
    // limit() would cut more than this anyway.
    const float most = 4 * scale * options_.reach * body.height;
    const glm::vec3 out = to_part * (std::min(radius - nearest.distance, most) * direction) / body.height;
    if (!allFinite(out)) return round > 0;
    const glm::vec3 normal = glm::normalize(glm::transpose(turn) * direction);
    for (std::uint32_t i = 0; i < body.knots; ++i) {
      const bool top = body.root == Root::kTop;
      const float weight = body.root == Root::kNone ? 1.0f
                                                    : pointLoad(fromRoot(top, at_rest_[body.first + i].at),
                                                                fromRoot(top, nearest.at));
      if (weight == 0) continue;
      Swing& swing = swings_[body.first + i];
      const glm::vec3 held = share(body, i) * body.lean;
      const float before = energyOf(swing, held);
      swing.offset += weight * out;
      swing.velocity -= std::min(glm::dot(swing.velocity, normal), 0.0f) * normal;
      limit(swing, held, options_.reach * share(body, i), before);
    }
  }
  return true;
}

}  // namespace kelp::runtime
