// SPDX-License-Identifier: MIT
// Where a pose keeps what it has of cages and joints.
#include <algorithm>
#include <bitset>
#include <new>

#include "pose_nodes.h"

namespace kelp::runtime {
namespace {

// The places of a pose's arrays in one block: counted if there is no block.
struct Carver {
  std::byte* block;
  std::uint64_t used = 0;

  template <class T>
  T* take(std::uint64_t count, std::uint64_t more_bytes = 0) {
    T* const at = block ? reinterpret_cast<T*>(block + used) : nullptr;
    used += (count * sizeof(T) + more_bytes + 15) / 16 * 16;
    return at;
  }
};

// The first of `count` new values; null if nothing is placed yet.
template <class T>
std::span<T> takeNew(Carver& carver, std::uint64_t count) {
  T* const at = carver.take<T>(count);
  if (!at) return {};
  for (std::uint64_t i = 0; i < count; ++i) new (at + i) T{};
  return {at, static_cast<std::size_t>(count)};
}

void layCage(const Cage& from, Carver& carver, CageInPose* cage) {
  const std::uint32_t leaves = cageLeaves(from.cells());
  auto* const nodes = carver.take<glm::vec3>(from.nodes(), sizeof(float));
  auto* const tree = carver.take<Box>(2 * std::uint64_t{leaves});
  if (!cage) return;
  cage->nodes = nodes;
  cage->tree = tree;
  cage->node_count = from.nodes();
  cage->cell_count = from.cells();
  cage->leaves = leaves;
}

bool followsParts(const Part& part) { return !part.cages.empty() && !part.cages[0].influences.empty(); }

// For the nodes of a part that follow parts.
void layInfluences(const Cage& finest, std::size_t parts, Carver& carver, NodesInPose* nodes) {
  std::bitset<65536> is_followed;
  for (const Influences& node : finest.influences)
    for (int k = 0; k < 4 && node.weights[k] > 0; ++k) is_followed.set(node.parts[k]);
  auto* const influences = carver.take<Influences>(finest.nodes());
  const std::span<std::uint16_t> followed = takeNew<std::uint16_t>(carver, is_followed.count());
  const std::span<std::uint16_t> slots = takeNew<std::uint16_t>(carver, parts);
  const std::span<Box> boxes = takeNew<Box>(carver, is_followed.count());
  const std::span<glm::mat4> maps = takeNew<glm::mat4>(carver, is_followed.count());
  if (!nodes) return;
  std::copy(finest.influences.begin(), finest.influences.end(), influences);
  std::uint16_t slot = 0;
  for (std::size_t part = 0; part < parts; ++part) {
    if (!is_followed[part]) continue;
    followed[slot] = static_cast<std::uint16_t>(part);
    slots[part] = slot++;
  }
  for (std::uint32_t i = 0; i < finest.nodes(); ++i)
    for (int k = 0; k < 4 && influences[i].weights[k] > 0; ++k)
      boxes[slots[influences[i].parts[k]]].add(glm::vec3(finest.rest(i)));
  nodes->influences = {influences, finest.nodes()};
  nodes->followed = followed;
  nodes->slots = slots;
  nodes->boxes = boxes;
  nodes->maps = maps;
}

void layMorphs(std::span<const Morph> from, Carver& carver, NodesInPose* nodes) {
  const std::span<Morph> morphs = takeNew<Morph>(carver, from.size());
  for (std::size_t i = 0; i < from.size(); ++i) {
    const std::span<MovedNode> moved = takeNew<MovedNode>(carver, from[i].moved.size());
    if (!nodes) continue;
    std::copy(from[i].moved.begin(), from[i].moved.end(), moved.begin());
    morphs[i] = {from[i].part, moved};
  }
  if (nodes) nodes->morphs = morphs;
}

// For the motions of parts.
void layMotions(std::span<const Part> parts, Carver& carver, PoseCages* all) {
  const std::span<Part> rest = takeNew<Part>(carver, parts.size());
  const std::span<glm::mat4> motions = takeNew<glm::mat4>(carver, parts.size());
  const std::span<glm::mat4> driven = takeNew<glm::mat4>(carver, parts.size());
  const std::span<bool> is_driven = takeNew<bool>(carver, parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::span<Knot> knots = takeNew<Knot>(carver, parts[i].knots.size());
    if (!all) continue;
    std::copy(parts[i].knots.begin(), parts[i].knots.end(), knots.begin());
    rest[i] = parts[i];
    rest[i].name = {};
    rest[i].knots = knots;
    rest[i].fog = nullptr;
    rest[i].cages = {};
  }
  if (!all) return;
  all->rest = rest;
  all->motions = motions;
  all->driven = driven;
  all->is_driven = is_driven;
}

// Returns the bytes of the block.
std::uint64_t layAll(std::span<const Part> parts, bool motions, std::byte* block) {
  Carver carver{block};
  PoseCages* const all = takeNew<PoseCages>(carver, 1).data();
  const std::span<NodesInPose> each = takeNew<NodesInPose>(carver, parts.size());
  if (all) all->parts = each;
  if (motions) layMotions(parts, carver, all);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::span<const Cage> from = parts[i].cages;
    if (from.empty()) continue;
    const std::span<CageInPose> cages = takeNew<CageInPose>(carver, from.size());
    auto* const places = carver.take<std::uint32_t>(from[0].nodes());
    for (std::size_t c = 0; c < from.size(); ++c) layCage(from[c], carver, block ? &cages[c] : nullptr);
    if (followsParts(parts[i])) layInfluences(from[0], parts.size(), carver, block ? &each[i] : nullptr);
    layMorphs(from[0].morphs, carver, block ? &each[i] : nullptr);
    if (!block) continue;
    each[i].cages = cages;
    each[i].places = places;
    each[i].side = from[0].side;
    each[i].sections = parts[i].sections;
    std::copy(from[0].places.begin(), from[0].places.end(), places);
  }
  return carver.used;
}

}  // namespace

Result<void> PoseCages::create(std::span<const Part> parts, bool joints, const Allocator& allocator,
                               Pose& pose) {
  pose.cages_ = Buffer<std::byte>(allocator);
  const bool caged = std::any_of(parts.begin(), parts.end(), [](const Part& p) { return !p.cages.empty(); });
  if (!caged && !joints) return {};
  const bool motions = joints || std::any_of(parts.begin(), parts.end(), followsParts);
  if (!pose.cages_.reset(layAll(parts, motions, nullptr)))
    return Error{ErrorCode::kOutOfMemory, "no memory for the cages of a pose"};
  layAll(parts, motions, pose.cages_.data());
  return {};
}

}  // namespace kelp::runtime
