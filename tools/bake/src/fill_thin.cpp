// SPDX-License-Identifier: MIT
#include "fill_thin.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace kelp::bake {
namespace {

constexpr std::size_t kGrain = 4096;
// Values of voxels while this file works.
constexpr std::uint8_t kLost = 3;     // kept by the first pass; the second looks for its neighbours
constexpr std::uint8_t kPassed = 4;   // empty, but a thin component passes through
bool isSolid(std::uint8_t voxel) { return voxel != kEmpty && voxel != kPassed; }

// For each of the 27 cells the cells that touch it.
struct Touching {
  std::uint32_t mask[27] = {};

  Touching() {
    for (int a = 0; a < 27; ++a) {
      for (int b = 0; b < 27; ++b) {
        if (std::abs(a % 3 - b % 3) <= 1 && std::abs(a / 3 % 3 - b / 3 % 3) <= 1 && std::abs(a / 9 - b / 9) <= 1) mask[a] |= 1u << b;
      }
    }
  }
};

glm::ivec3 voxelAt(std::uint64_t index, const glm::ivec3& size) {
  const std::uint64_t x = static_cast<std::uint64_t>(size.x), y = static_cast<std::uint64_t>(size.y);
  return {static_cast<int>(index % x), static_cast<int>(index / x % y), static_cast<int>(index / (x * y))};
}

// Calls visit(neighbour, its dense index) for the voxels of the volume at most `reach` away.
template <class Visit>
void forEachAround(const glm::ivec3& voxel, const glm::ivec3& size, int reach, const Visit& visit) {
  for (int z = std::max(0, voxel.z - reach); z <= std::min(size.z - 1, voxel.z + reach); ++z) {
    for (int y = std::max(0, voxel.y - reach); y <= std::min(size.y - 1, voxel.y + reach); ++y) {
      for (int x = std::max(0, voxel.x - reach); x <= std::min(size.x - 1, voxel.x + reach); ++x) {
        visit(glm::ivec3(x, y, z), static_cast<std::size_t>(x) + static_cast<std::size_t>(size.x) * (static_cast<std::size_t>(y) + static_cast<std::size_t>(size.y) * static_cast<std::size_t>(z)));
      }
    }
  }
}

int chebyshev(const glm::ivec3& a, const glm::ivec3& b) { return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)}); }

// The voxels within two of `voxel` of which a condition holds, for the search of a gap's two ends.
struct Surroundings {
  glm::ivec3 solid[125], passed[26];
  int solids = 0, passes = 0;

  // Whether a passed voxel touches something solid that does not hang together with what `voxel` touches.
  bool showTwoEnds(const glm::ivec3& voxel) {
    // What hangs together with what `voxel` touches moves to the front.
    int reached = 0;
    for (int i = 0; i < solids; ++i) {
      if (chebyshev(solid[i], voxel) <= 1) std::swap(solid[reached++], solid[i]);
    }
    for (int i = 0; i < reached; ++i) {
      for (int k = reached; k < solids; ++k) {
        if (chebyshev(solid[i], solid[k]) <= 1) std::swap(solid[reached++], solid[k]);
      }
    }
    for (int i = reached; i < solids; ++i) {
      for (int k = 0; k < passes; ++k) {
        if (chebyshev(solid[i], passed[k]) <= 1) return true;
      }
    }
    return false;
  }
};

}  // namespace

bool hangTogether(std::uint32_t mask) {
  static const Touching touching;
  std::uint32_t reached = mask & (0u - mask);
  std::uint32_t frontier = reached;
  while (frontier != 0) {
    std::uint32_t grown = 0;
    for (int cell = 0; cell < 27; ++cell) {
      if (frontier & (1u << cell)) grown |= touching.mask[cell];
    }
    frontier = grown & mask & ~reached;
    reached |= frontier;
  }
  return reached == mask;
}

std::uint32_t neighbourMask(const std::vector<std::uint8_t>& voxels, const glm::ivec3& size, const glm::ivec3& voxel) {
  std::uint32_t mask = 0;
  int bit = 0;
  for (int z = voxel.z - 1; z <= voxel.z + 1; ++z) {
    for (int y = voxel.y - 1; y <= voxel.y + 1; ++y) {
      if (y < 0 || z < 0 || y >= size.y || z >= size.z) {
        bit += 3;
        continue;
      }
      const std::size_t row = static_cast<std::size_t>(size.x) * (static_cast<std::size_t>(y) + static_cast<std::size_t>(size.y) * static_cast<std::size_t>(z));
      for (int x = voxel.x - 1; x <= voxel.x + 1; ++x, ++bit) {
        if (x >= 0 && x < size.x && isSolid(voxels[row + static_cast<std::size_t>(x)])) mask |= 1u << bit;
      }
    }
  }
  return mask;
}

void keepThinParts(const Topology& mesh, const TriangleBvh& bvh, const std::vector<std::uint64_t>& touched, const glm::ivec3& size, int threads,
                   std::vector<std::uint8_t>& voxels, const Step& step) {
  std::vector<std::uint8_t> chosen(touched.size(), 0);
  const auto sweep = [&](const auto& wanted, const Step& told = {}) {
    parallelRanges(touched.size(), kGrain, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) chosen[i] = !isSolid(voxels[touched[i]]) && wanted(i, voxelAt(touched[i], size)) ? 1 : 0;
    }, told);
  };
  const auto set = [&](std::uint8_t value) {
    for (std::size_t i = 0; i < touched.size(); ++i) {
      if (chosen[i]) voxels[touched[i]] = value;
    }
  };
  // The component that passes through a voxel, of those that `accept(component)` lets pass; kCap if the nearest point lies elsewhere.
  const auto passing = [&](const glm::ivec3& voxel, const auto& accept) {
    const glm::dvec3 centre = glm::dvec3(voxel) + 0.5;
    const Nearest nearest = bvh.nearest(centre, kHalfDiagonal, [&](std::uint32_t i) { return mesh.triangles[i].source != kCap && accept(mesh.triangles[i].component); });
    const glm::dvec3 away = glm::abs(nearest.point - centre);
    return nearest.triangle != kCap && std::max({away.x, away.y, away.z}) <= 0.5 ? mesh.triangles[nearest.triangle].component : kCap;
  };
  const auto passingAny = [&](const glm::ivec3& voxel) { return passing(voxel, [](std::uint32_t) { return true; }); };
  // Whether a component passes through a voxel or fills it. Only such voxels are ends of its gaps: two plates a voxel apart are no gap.
  const auto belongs = [&](const glm::ivec3& voxel, std::uint8_t value, std::uint32_t component) {
    if (passing(voxel, [&](std::uint32_t its) { return its == component; }) != kCap) return true;
    return value == kInside && mesh.triangles[bvh.nearest(glm::dvec3(voxel) + 0.5).triangle].component == component;
  };
  const auto neighbours = [&](const glm::ivec3& voxel) { return neighbourMask(voxels, size, voxel) & ~kCentreBit; };

  // 1. Where nothing is around.
  sweep([&](std::size_t, const glm::ivec3& voxel) { return neighbours(voxel) == 0 && passingAny(voxel) != kCap; });
  set(kLost);
  const bool any_lost = std::find(chosen.begin(), chosen.end(), 1) != chosen.end();
  const bool any_thin = std::any_of(mesh.components.begin(), mesh.components.end(), [](const Component& component) { return component.thin; });
  if (!any_lost && !any_thin) return;
  // 2. What joins those to the rest, and single gaps in thin components.
  const auto lostBeside = [&](const glm::ivec3& voxel) {
    bool found = false;
    forEachAround(voxel, size, 1, [&](const glm::ivec3&, std::size_t at) { found = found || voxels[at] == kLost; });
    return found;
  };
  const auto endsOf = [&](std::uint32_t component, const glm::ivec3& voxel) {
    std::uint32_t mask = 0;
    forEachAround(voxel, size, 1, [&](const glm::ivec3& at, std::size_t index) {
      if (at == voxel || !isSolid(voxels[index]) || !belongs(at, voxels[index], component)) return;
      mask |= 1u << (at.x - voxel.x + 1 + 3 * (at.y - voxel.y + 1) + 9 * (at.z - voxel.z + 1));
    });
    return mask;
  };
  std::vector<std::uint32_t> thin(touched.size(), kCap);  // the thin component that passes through
  sweep([&](std::size_t i, const glm::ivec3& voxel) {
    const std::uint32_t mask = neighbours(voxel);
    if (mask == 0 || (!any_thin && !lostBeside(voxel))) return false;
    std::uint32_t component = passingAny(voxel);
    if (component == kCap) return false;
    if (mesh.components[component].thin) thin[i] = component;
    if (hangTogether(mask)) return false;
    const bool lost = lostBeside(voxel);
    // Of several components in one voxel each may have its gap here.
    std::vector<std::uint32_t> seen;
    while (component != kCap) {
      if ((lost || mesh.components[component].thin) && !hangTogether(endsOf(component, voxel))) return true;
      seen.push_back(component);
      component = passing(voxel, [&](std::uint32_t its) { return std::find(seen.begin(), seen.end(), its) == seen.end(); });
    }
    return false;
  }, step);
  set(kKept);
  for (std::size_t i = 0; i < touched.size(); ++i) {
    if (thin[i] != kCap && voxels[touched[i]] == kEmpty) voxels[touched[i]] = kPassed;
  }
  // 3. Gaps of two, whose voxels each see only one end.
  const auto thinAt = [&](std::size_t index) { return thin[static_cast<std::size_t>(std::lower_bound(touched.begin(), touched.end(), index) - touched.begin())]; };
  sweep([&](std::size_t i, const glm::ivec3& voxel) {
    if (thin[i] == kCap) return false;
    // First all that is solid, which is cheap and mostly the end of it; then what belongs to the component.
    for (const bool own : {false, true}) {
      Surroundings around;
      forEachAround(voxel, size, 2, [&](const glm::ivec3& at, std::size_t index) {
        if (isSolid(voxels[index]) && (!own || belongs(at, voxels[index], thin[i]))) around.solid[around.solids++] = at;
        if (voxels[index] == kPassed && at != voxel && chebyshev(at, voxel) == 1 && thinAt(index) == thin[i]) around.passed[around.passes++] = at;
      });
      if (around.passes == 0 || !around.showTwoEnds(voxel)) return false;
    }
    return true;
  });
  set(kKept);
  for (const std::uint64_t index : touched) {
    if (voxels[index] == kLost) voxels[index] = kKept;
    if (voxels[index] == kPassed) voxels[index] = kEmpty;
  }
}

}  // namespace kelp::bake
