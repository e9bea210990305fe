// SPDX-License-Identifier: MIT
#include "reference/posed_trial.h"

#include <cmath>

#include "support/traced_level.h"

namespace kelp::reference {
namespace {

using glm::dvec3;
using glm::ivec3;

std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

const std::uint8_t* residentBrick(const void* user, std::uint32_t cell, int level) {
  return isResident(cell, level)
             ? test::tracedLevel(*static_cast<const RawLevel*>(user), ivec3(8)).brick(user, cell)
             : nullptr;
}

}  // namespace

trace::KelpHit walkCaged(const trace::Context& context, std::span<const CageTruth::Start> starts,
                         const glm::vec3& o, const glm::vec3& r, float s_max, double& s) {
  trace::KelpHit best = trace::kelpNoHit(s_max);
  int steps = 0, tetrahedra = 0;
  s = 1e30;
  for (const CageTruth::Start& start : starts) {
    if (start.s >= s) break;
    const glm::vec3 from(dvec3(o) + start.s * dvec3(r));
    const trace::KelpHit hit = trace::kelpWalkCaged(context, start.face, from, r, 0.0f, s_max);
    steps += hit.steps;
    tetrahedra += hit.clips;
    if (!hit.found || start.s + double{hit.s} >= s) continue;
    best = hit;
    s = start.s + double{hit.s};
  }
  best.steps = steps;
  best.clips = tetrahedra;
  return best;
}

bool isResident(std::uint32_t cell, int level) {
  return !isStoredCell(cell) || mixed(std::uint64_t{cell} << 8 | static_cast<unsigned>(level)) % 2 != 0;
}

PosedTrial::PosedTrial(const CagedVolume& volume, const CagePose& pose, unsigned seed)
    : volume_(volume), pose_(pose), seed_(seed) {
  for (std::uint32_t i = 0; i < cage().nodes(); ++i) {
    nodes_.push_back(shaken(dvec3(cage().rest(i)), i));
    bounds_.add(nodes_.back());
  }
  makeLevels();
  makeTruth();
  context_.cage_words = cage().words.data();
  context_.nodes = nodes_.data();
  context_.bounds_min = bounds_.min;
  context_.bounds_max = bounds_.max;
  context_.size = glm::vec3(volume.size);
  context_.level_size = volume.voxels[0].size;
  context_.level_scale = std::ldexp(1.0f, -volume.level);
  context_.levels = levels_.data();
  context_.coarser = static_cast<int>(levels_.size()) - 1;
  context_.complete = !volume.lost;
  makeTree();
}

glm::vec3 PosedTrial::shaken(const dvec3& rest, std::uint32_t number) const {
  dvec3 at = pose_.map(rest);
  for (int a = 0; a < 3; ++a) {
    const std::uint64_t noise = mixed(mixed(std::uint64_t{seed_} << 32 | number) + static_cast<unsigned>(a));
    at[a] += pose_.shaken * cage().side * (static_cast<double>(noise >> 40) / (1 << 24) - 0.5);
  }
  return glm::vec3(at);
}

glm::vec3 PosedTrial::corner(const ivec3& place) const {
  return shaken(dvec3(cage().side * place),
                0x80000000u | static_cast<std::uint32_t>(place.x + 1024 * (place.y + 1024 * place.z)));
}

void PosedTrial::makeLevels() {
  for (std::size_t i = 0; i < volume_.levels.size(); ++i) {
    levels_.push_back(test::tracedLevel(volume_.levels[i], volume_.voxels[i].size));
    if (!volume_.lost) continue;
    levels_.back().brick =
        i == 0   ? [](const void* user, std::uint32_t cell) { return residentBrick(user, cell, 0); }
        : i == 1 ? [](const void* user, std::uint32_t cell) { return residentBrick(user, cell, 1); }
                 : [](const void* user, std::uint32_t cell) { return residentBrick(user, cell, 2); };
  }
}

// The volume that is drawn: each voxel from the finest level whose brick is there.
void PosedTrial::makeTruth() {
  const fields::Occupancy& fine = volume_.voxels[0];
  solid_ = fine.solid;
  if (volume_.lost) {
    coarser_.resize(solid_.size());
    for (std::size_t n = 0; n < solid_.size(); ++n) {
      const ivec3 voxel(voxelAt(fine.size, n));
      solid_[n] = 0;
      for (std::size_t i = 0; i < levels_.size(); ++i) {
        const ivec3 at = voxel >> static_cast<int>(i);
        const std::uint32_t cell = trace::cellAt(levels_[i], at >> 3);
        if (i == 0 && cell < 0x80000000u) break;
        if (cell < 0x80000000u || !isResident(cell, static_cast<int>(i))) continue;
        solid_[n] = volume_.voxels[i].solid[volume_.voxels[i].index(at)];
        coarser_[n] = static_cast<std::uint8_t>(i);
        break;
      }
    }
  }
  const Volume volume{fine.size, solid_, std::ldexp(1.0, -volume_.level), volume_.size};
  truth_ = std::make_unique<CageTruth>(
      CagedLevel{&cage(), volume_.sources.back().source(), volume_.level, volume, coarser_}, nodes_,
      [this](const ivec3& place) { return corner(place); });
}

void PosedTrial::makeTree() {
  const std::size_t leaves = cage().leaves.size() / kLeafCells;
  std::vector<Box> tree(2 * leaves, Box{glm::vec3(1e38f), glm::vec3(1e38f)});
  Box fold;
  for (std::size_t i = 0; i < cage().leaves.size(); ++i) {
    const std::uint32_t cell = cage().leaves[i];
    if (cell == kCageOutside) continue;
    Box around;
    for (int c = 0; c < 8; ++c) around.add(nodes_[cage().node(cell, c)]);
    for (std::size_t box = leaves + i / kLeafCells; box > 0; box /= 2) {
      if (tree[box].min.x == 1e38f) tree[box] = Box{};
      tree[box].add(around.min);
      tree[box].add(around.max);
    }
    for (int t = 0; t < 6; ++t) {
      if (!trace::kelpTetrahedron(context_, trace::kelpCageCell(cell), t, {}, {}).turned) continue;
      for (const int c : kCageTetrahedra[t].corners) fold.add(nodes_[cage().node(cell, c)]);
    }
  }
  for (const Box& box : tree) boxes_.push_back(box.min), boxes_.push_back(box.max);
  context_.cage_boxes = boxes_.data();
  context_.cage_leaves = static_cast<int>(leaves);
  context_.cage_leaf_cells = cage().leaves.data();
  context_.fold_min = fold.min;
  context_.fold_max = fold.max;
}

}  // namespace kelp::reference
