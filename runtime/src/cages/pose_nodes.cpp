// SPDX-License-Identifier: MIT
#include "pose_nodes.h"

#include <algorithm>
#include <cmath>

#include <glm/glm.hpp>

#include "../posed_part.h"
#include "kelp/cages/posed_cage.h"
#include "kelp/simd/lanes.h"

namespace kelp::runtime {
namespace {

constexpr Error kFollowsNowhere{
    ErrorCode::kMisuse,
    "a part that the nodes of a cage follow, or a morph target, has a motion of no finite numbers, or "
    "takes them farther away than 2^20 times the part's longest side"};
constexpr Error kBadSection{ErrorCode::kMisuse,
                            "a section has a width or a twist that is no finite number, or far too large"};
constexpr Error kBadNode{ErrorCode::kMisuse,
                         "a node that was written is no finite number, or farther away than 2^20 times the "
                         "part's longest side",
                         0, Error::Unit::kNode};

// Every coordinate of a node must be below this, up to sign.
float endOfNodes(const glm::ivec3& size) {
  return std::nextafter(0x1p20f * static_cast<float>(std::max({size.x, size.y, size.z})), INFINITY);
}

// A level section of the lattice: a node at (x, z) from its middle goes to at + x * this->x + z * this->z.
// inward: where it is swept, (x, z) lie dot(inward, (x, z)) times as far towards the center of the sharpest
// curvature in the cells at the section as that is away.
struct Section {
  glm::vec3 x{1, 0, 0}, z{0, 0, 1}, at;
  glm::vec2 inward{0};
  glm::mat2 across{1};  // first takes (x, z) there: its width and twist

  // The lattice may end beside the part, by less than a cell. There nodes stay where nothing folds.
  glm::vec3 place(glm::vec2 node) const {
    node = across * node;
    constexpr auto kMost = static_cast<float>(kMostCurved);
    const float curved = glm::dot(inward, node);
    if (curved > kMost) node -= (curved - kMost) / glm::dot(inward, inward) * inward;
    return at + node.x * x + node.y * z;
  }
};

constexpr int kMostSections = kMostCageCells + 1;

void sectionsAtRest(const glm::vec3& middle, int side, std::span<Section> sections) {
  for (std::size_t i = 0; i < sections.size(); ++i)
    sections[i].at = {middle.x, static_cast<float>(side * static_cast<int>(i)), middle.z};
}

// The lattice may end above the part, by less than a cell. There the map goes on straight.
Result<void> shearSections(std::span<const Knot> knots, const glm::ivec3& size, const glm::vec3& middle,
                           int side, std::span<Section> sections) {
  if (Result<void> sound = checkKnots(knots); !sound) return sound;
  const auto at = [&](float y) { return shear(knots, size, {middle.x, y, middle.z}); };
  sectionsAtRest(middle, side, sections);
  for (Section& section : sections.first(sections.size() - 1)) section.at = at(section.at.y);
  const int below = side * (static_cast<int>(sections.size()) - 2);
  const glm::vec3 from = sections[sections.size() - 2].at, top = at(static_cast<float>(size.y));
  const float share = static_cast<float>(side) / static_cast<float>(size.y - below);
  sections.back().at = share == 1.0f ? top : from + share * (top - from);
  return {};
}

Result<void> sweepSections(std::span<const Knot> knots, const glm::ivec3& size, float roll, int side,
                           std::span<Section> sections) {
  ArcChain chain;
  if (Result<void> made = makeArcs(knots, size, roll, kArcTolerance, chain); !made) return made;
  const auto height = static_cast<float>(size.y);
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const auto y = static_cast<float>(side * static_cast<int>(i));
    const glm::mat4x3 section = sectionAt(chain, std::min(y, height));
    sections[i] = {section[0], section[2], section[3]};
    float sharpest = 0;
    for (int a = 0; a < chain.count; ++a) {
      const bool is_near = chain.joints[a].y < y + static_cast<float>(side) &&
                           chain.joints[a + 1].y > y - static_cast<float>(side);
      if (!is_near || chain.arcs[a].curvature <= sharpest) continue;
      sharpest = chain.arcs[a].curvature;
      sections[i].inward = sharpest * chain.arcs[a].bend;
    }
    if (y > height) sections[i].at += (y - height) / chain.arcs[chain.count - 1].rise * section[1];
  }
  return {};
}

// At a height, 0 to 1, of the knots of a section part: linear between them.
PartSection sectionAtHeight(std::span<const Knot> knots, float at) {
  std::size_t above = 1;
  while (above + 1 < knots.size() && knots[above].at < at) ++above;
  const Knot &low = knots[above - 1], &high = knots[above];
  const PartSection a = sectionOf(low), b = sectionOf(high);
  const float t = glm::clamp((at - low.at) / (high.at - low.at), 0.0f, 1.0f);
  return {glm::mix(a.width, b.width, t), glm::mix(a.twist, b.twist, t),
          glm::mix(a.keep_volume, b.keep_volume, t)};
}

// Gives the sections of a posed lattice their widths and twists. By how much the spline is longer at a
// section is taken from its neighbors.
void widen(std::span<const Knot> knots, int height, Bend bend, int side, std::span<Section> sections) {
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const std::size_t low = i > 0 ? i - 1 : 0, high = std::min(i + 1, sections.size() - 1);
    const glm::vec3 rise = sections[high].at - sections[low].at;
    const float longer = (bend == Bend::kSweep ? glm::length(rise) : rise.y) /
                         static_cast<float>(side * static_cast<int>(high - low));
    const PartSection its =
        sectionAtHeight(knots, static_cast<float>(side * static_cast<int>(i)) / static_cast<float>(height));
    const float volume = its.width.x * its.width.y * glm::clamp(longer, 1.0f / 64, 64.0f);
    const float keep = volume > 0 ? std::pow(volume, -0.5f * glm::clamp(its.keep_volume, 0.0f, 1.0f)) : 1.0f;
    const glm::vec2 width = keep * its.width;
    const float c = std::cos(its.twist), s = std::sin(its.twist);
    sections[i].across = {{width.x * c, -width.x * s}, {width.y * s, width.y * c}};
  }
}

}  // namespace

NodesInPose* PoseCages::of(const Pose& pose, int part) {
  PoseCages* const all = pose.cages();
  if (!all || part < 0 || part >= pose.parts()) return nullptr;
  NodesInPose& found = all->parts[static_cast<std::size_t>(part)];
  return found.cages.empty() ? nullptr : &found;
}

std::uint64_t PoseCages::placedFor(const Pose& pose, int part) {
  const NodesInPose& nodes = *of(pose, part);
  if (nodes.followsParts()) return stateOf(pose);
  if (nodes.written) return 0;
  const std::uint64_t sections = nodes.sections >= 0 ? sumOf(pose.knots(nodes.sections)) : 0;
  if (const_cast<Pose&>(pose).shapes()[part].bend != Bend::kSweep) return sections;
  return sections ^ glm::floatBitsToUint(pose.motion(part)->roll);
}

std::uint64_t PoseCages::madeFor(const Pose& pose, int part) {
  const NodesInPose& nodes = *of(pose, part);
  return nodes.followsParts() ? stateOf(pose) : nodes.placements;
}

bool PoseCages::place(const Pose& pose, int part) {
  NodesInPose& nodes = *of(pose, part);
  if (nodes.written) return true;
  if (nodes.followsParts())
    return nodes.cages[0].placed.make(placedFor(pose, part), [&] {
      nodes.failure = kFollowsNowhere;
      return follow(pose, part, {nodes.influences, nodes.morphs, nodes.places, nodes.side},
                    nodes.cages[0].nodes);
    });
  return nodes.cages[0].placed.make(placedFor(pose, part), [&] {
    ++nodes.placements;
    const Pose::Shape& shape = const_cast<Pose&>(pose).shapes()[part];
    const glm::vec3 middle = 0.5f * glm::vec3(shape.size);
    Section room[kMostSections];
    const auto count = static_cast<std::size_t>(cageGrid(shape.size, nodes.side).y) + 1;
    const std::span<Section> sections(room, count);
    const std::span<const Knot> knots = pose.knots(part);
    const Result<void> placed =
        shape.bend == Bend::kSweep
            ? sweepSections(knots, shape.size, shape.roll + pose.motion(part)->roll, nodes.side, sections)
            : shearSections(knots, shape.size, middle, nodes.side, sections);
    if (!placed) {
      nodes.failure = placed.error();
      std::fill(sections.begin(), sections.end(), Section{});
      sectionsAtRest(middle, nodes.side, sections);
    }
    if (placed && nodes.sections >= 0)
      widen(pose.knots(nodes.sections), shape.size.y, shape.bend, nodes.side, sections);
    const CageInPose& cage = nodes.cages[0];
    const auto side = static_cast<float>(nodes.side);
    for (std::uint32_t i = 0; i < cage.node_count; ++i) {
      const std::uint32_t place = nodes.places[i];
      const Section& section = sections[place >> 10 & 1023];
      const float x = side * static_cast<float>(place & 1023) - middle.x;
      const float z = side * static_cast<float>(place >> 20) - middle.z;
      cage.nodes[i] = section.place({x, z});
    }
    if (nodes.sections < 0 || !badNode(pose, part, cage.nodes, cage.node_count)) return bool(placed);
    nodes.failure = kBadSection;
    for (std::uint32_t i = 0; i < cage.node_count; ++i)
      cage.nodes[i] = side * glm::vec3(latticePoint(nodes.places[i]));
    return false;
  });
}

bool PoseCages::fits(const Pose& pose, std::span<const Part> parts) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const NodesInPose* const mine = of(pose, static_cast<int>(i));
    const std::span<const Cage> cages = parts[i].cages;
    if ((mine ? mine->cages.size() : 0) != cages.size()) return false;
    for (std::size_t c = 0; c < cages.size(); ++c)
      if (mine->cages[c].node_count != cages[c].nodes() || mine->cages[c].cell_count != cages[c].cells())
        return false;
  }
  return true;
}

bool PoseCages::alike(const Pose& a, const Pose& b) {
  if (!a.cages() || !b.cages()) return a.cages() == b.cages();
  if (a.cages()->rest.size() != b.cages()->rest.size()) return false;
  for (int part = 0; part < a.parts(); ++part) {
    const NodesInPose *const one = of(a, part), *const other = of(b, part);
    if (!one || !other) {
      if (one != other) return false;
    } else if (one->cages[0].node_count != other->cages[0].node_count ||
               one->influences.size() != other->influences.size() ||
               one->morphs.size() != other->morphs.size()) {
      return false;
    }
  }
  return true;
}

void PoseCages::reset(Pose& pose) {
  release(pose);
  for (int part = 0; part < pose.parts(); ++part) {
    if (NodesInPose* const nodes = of(pose, part)) nodes->written = false;
    pose.forgetNodes(part);
  }
}

void PoseCages::assign(const Pose& from, Pose& to) {
  release(to);
  for (int part = 0; part < to.parts(); ++part)
    if (const glm::mat4* const driven = drivenTo(from, part)) drive(to, part, *driven);
  if (to.cages()->any_driven) forgetMotions(to);
  for (int part = 0; part < to.parts(); ++part) {
    NodesInPose* const nodes = of(to, part);
    if (!nodes) continue;
    nodes->written = of(from, part)->written;
    if (nodes->written)
      std::copy_n(of(from, part)->cages[0].nodes, nodes->cages[0].node_count, nodes->cages[0].nodes);
    to.forgetNodes(part);
  }
}

void PoseCages::blend(const Pose& to, int part, float weight, Pose& pose) {
  NodesInPose* const nodes = of(pose, part);
  if (!nodes) return;
  const bool written = of(to, part)->written;
  if (!nodes->written && !written) return;
  if (weight == 1.0f && !written) {
    nodes->written = false;
    return;
  }
  const std::span<glm::vec3> mine = pose.nodes(part);
  const std::span<const glm::vec3> theirs = to.nodes(part);
  for (std::size_t i = 0; i < mine.size(); ++i)
    mine[i] = weight == 1.0f ? theirs[i] : mine[i] + weight * (theirs[i] - mine[i]);
}

std::optional<std::size_t> PoseCages::badNode(const Pose& pose, int part, const glm::vec3* nodes,
                                              std::size_t node_count) {
  using namespace simd;
  const float limit = endOfNodes(const_cast<Pose&>(pose).shapes()[part].size);
  const float* const numbers = &nodes->x;
  const std::size_t count = 3 * node_count, whole = count & ~std::size_t{3};
  unsigned good = 15;
  for (std::size_t i = 0; i < whole; i += 4) good &= lessBits(abs(Lanes::load(numbers + i)), limit);
  const auto isGood = [limit](float number) { return std::abs(number) < limit; };
  if (good == 15 && std::all_of(numbers + whole, numbers + count, isGood)) return std::nullopt;
  return static_cast<std::size_t>(std::find_if_not(numbers, numbers + count, isGood) - numbers) / 3;
}

Result<void> PoseCages::check(const Pose& pose, int part) {
  const NodesInPose* const in = of(pose, part);
  if (!in) return {};
  if (in->followsParts())
    return followedBounds(pose, part).empty() ? Result<void>(kFollowsNowhere) : Result<void>();
  if (!in->written) return {};
  const auto isBounded = [in](const CageInPose& cage) { return cage.bounded.isMade(in->placements); };
  if (std::any_of(in->cages.begin(), in->cages.end(), isBounded)) return {};  // it was checked then
  const std::optional<std::size_t> bad = badNode(pose, part, in->cages[0].nodes, in->cages[0].node_count);
  if (!bad) return {};
  Error error = kBadNode;
  error.offset = *bad;
  return error;
}

Result<void> PoseCages::checkSections(const Pose& pose, int part) {
  constexpr float kMost = 0x1p16f;
  const NodesInPose* const in = of(pose, part);
  if (!in || in->sections < 0 || in->written) return {};
  for (const Knot& knot : pose.knots(in->sections)) {
    const PartSection its = sectionOf(knot);
    const float most = std::max({std::abs(its.width.x), std::abs(its.width.y), std::abs(its.twist)});
    if (!(most < kMost) || std::isnan(its.width.x + its.width.y + its.twist + its.keep_volume))
      return kBadSection;
  }
  return {};
}

void PoseCages::clamp(Pose& pose, int part) {
  const NodesInPose& in = *of(pose, part);
  const float limit = endOfNodes(pose.shapes()[part].size);
  const std::span<glm::vec3> nodes = pose.nodes(part);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (glm::all(glm::lessThan(glm::abs(nodes[i]), glm::vec3(limit)))) continue;
    nodes[i] = static_cast<float>(in.side) * glm::vec3(latticePoint(in.places[i]));
  }
}

PoseCages* Pose::cages() const {
  return cages_.empty() ? nullptr : reinterpret_cast<PoseCages*>(const_cast<Pose*>(this)->cages_.data());
}

void Pose::forgetFollowing(int part) {
  const NodesInPose* const nodes = PoseCages::of(*this, part);
  if (nodes && !nodes->written && !nodes->followsParts()) forgetNodes(part);
}

void Pose::forgetNodes(int part) {
  NodesInPose* const nodes = PoseCages::of(*this, part);
  if (!nodes) return;
  for (CageInPose& cage : nodes->cages) {
    cage.placed.forget();
    cage.bounded.forget();
    cage.grown.forget();
  }
}

std::span<glm::vec3> Pose::nodes(int part) {
  NodesInPose* const nodes = PoseCages::of(*this, part);
  if (!nodes) return {};
  PoseCages::place(*this, part);
  nodes->written = true;
  forgetNodes(part);
  return {nodes->cages[0].nodes, nodes->cages[0].node_count};
}

std::span<const glm::vec3> Pose::nodes(int part) const {
  const NodesInPose* const nodes = PoseCages::of(*this, part);
  if (!nodes) return {};
  PoseCages::place(*this, part);
  return {nodes->cages[0].nodes, nodes->cages[0].node_count};
}

}  // namespace kelp::runtime
