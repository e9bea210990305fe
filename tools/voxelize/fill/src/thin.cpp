// SPDX-License-Identifier: MIT
#include "kelp/voxelize/fill/fill.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "kelp/common/dense_index.h"
#include "kelp/voxelize/surface/touched_voxels.h"

namespace kelp::bake {
namespace {

constexpr std::size_t kGrain = 4096;
// Two more values of voxels, while this file works.
constexpr std::uint8_t kLost = 3;    // kept because nothing solid was around it
constexpr std::uint8_t kPassed = 4;  // empty, and a thin component passes through it
// kInside, kKept or kLost
bool isSolidVoxel(std::uint8_t voxel) { return (voxel & 3) != 0; }

// For each of the 27 cells of a block, the cells that touch it: by a face, an edge or a corner.
struct Touching {
  std::uint32_t mask[27] = {};

  Touching() {
    for (int a = 0; a < 27; ++a) {
      for (int b = 0; b < 27; ++b) {
        if (std::abs(a % 3 - b % 3) <= 1 && std::abs(a / 3 % 3 - b / 3 % 3) <= 1 &&
            std::abs(a / 9 - b / 9) <= 1)
          mask[a] |= 1u << b;
      }
    }
  }
};

// Calls visit(neighbor, its dense index) for the voxels of the volume at most `reach` away.
template <class Visit>
void forEachAround(const glm::ivec3& voxel, const glm::ivec3& size, int reach, const Visit& visit) {
  for (int z = std::max(0, voxel.z - reach); z <= std::min(size.z - 1, voxel.z + reach); ++z) {
    for (int y = std::max(0, voxel.y - reach); y <= std::min(size.y - 1, voxel.y + reach); ++y) {
      for (int x = std::max(0, voxel.x - reach); x <= std::min(size.x - 1, voxel.x + reach); ++x) {
        visit(glm::ivec3(x, y, z), denseIndex(size, x, y, z));
      }
    }
  }
}

int chebyshev(const glm::ivec3& a, const glm::ivec3& b) {
  return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)});
}

// The solid voxels at most two from a voxel, and the passed ones that touch it: enough to find the two ends
// of a gap of two voxels.
struct Surroundings {
  glm::ivec3 solid[125], passed[26];
  int solids = 0, passes = 0;

  // True if a passed voxel touches a solid one that is not connected with the solid ones around `voxel`.
  bool showTwoEnds(const glm::ivec3& voxel) {
    // The front of the list is what is connected with what `voxel` touches.
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

// The three passes of keepThinParts. Every pass chooses its voxels first, on all threads, and sets them
// afterwards: the result does not depend on the order of the voxels. kPassed and kLost stand for kEmpty and
// kKept until restoreValues.
class ThinParts {
 public:
  ThinParts(const Topology& mesh, const TriangleBvh& bvh, const std::vector<std::uint64_t>& touched,
            const glm::ivec3& size, int threads, std::vector<std::uint8_t>& voxels)
      : mesh_(mesh),
        bvh_(bvh),
        touched_(touched),
        size_(size),
        threads_(threads),
        voxels_(voxels),
        has_thin_(std::any_of(mesh.components.begin(), mesh.components.end(),
                              [](const Component& component) { return component.thin; })),
        chosen_(touched.size(), 0) {}

  bool hasThinComponents() const { return has_thin_; }

  // Pass 1: keeps what the surface passes through and has nothing solid around it. Answers whether there was
  // any.
  bool keepLost() {
    choose([&](std::size_t, const glm::ivec3& voxel) {
      return neighbors(voxel) == 0 && passingAny(voxel) != kCap;
    });
    setChosen(kLost);
    return std::find(chosen_.begin(), chosen_.end(), 1) != chosen_.end();
  }

  // Pass 2: keeps what joins the voxels of pass 1 to the rest, and closes gaps of one voxel in thin
  // components.
  void joinEnds(const Step& step) {
    thin_.assign(touched_.size(), kCap);
    const std::vector<std::uint8_t> by_thin = touchedByThin();
    choose(
        [&](std::size_t i, const glm::ivec3& voxel) {
          const std::uint32_t mask = neighbors(voxel);
          if (mask == 0 || (!by_thin[i] && !touchesLost(voxel))) return false;
          const std::uint32_t component = passingAny(voxel);
          if (component == kCap) return false;
          if (mesh_.components[component].thin) thin_[i] = component;
          return !hangTogether(mask) && joinsTwoEnds(voxel, component);
        },
        step);
    setChosen(kKept);
    for (std::size_t i = 0; i < touched_.size(); ++i) {
      if (thin_[i] != kCap && voxels_[touched_[i]] == kEmpty) voxels_[touched_[i]] = kPassed;
    }
  }

  // Pass 3: closes gaps of two voxels in thin components. Each of the two sees only one end.
  void closeGapsOfTwo() {
    choose([&](std::size_t i, const glm::ivec3& voxel) {
      // All solid voxels first: that is cheap, and mostly enough to say no. Then only those of the component.
      return thin_[i] != kCap && isInGapOfTwo(voxel, thin_[i], false) && isInGapOfTwo(voxel, thin_[i], true);
    });
    setChosen(kKept);
  }

  void restoreValues() {
    for (const std::uint64_t index : touched_) {
      if (voxels_[index] == kLost) voxels_[index] = kKept;
      if (voxels_[index] == kPassed) voxels_[index] = kEmpty;
    }
  }

 private:
  // By touched voxel: 1 if a thin component touches it.
  std::vector<std::uint8_t> touchedByThin() const {
    std::vector<std::uint8_t> by_thin(touched_.size(), 0);
    if (!has_thin_) return by_thin;
    const std::vector<std::uint64_t> thin = touchedVoxels(
        mesh_, size_, threads_,
        [&](const SolidTriangle& triangle) { return mesh_.components[triangle.component].thin; });
    auto at = thin.begin();
    for (std::size_t i = 0; i < touched_.size(); ++i) {
      while (at != thin.end() && *at < touched_[i]) ++at;
      by_thin[i] = at != thin.end() && *at == touched_[i] ? 1 : 0;
    }
    return by_thin;
  }

  // Chooses the touched voxels that are not solid and that `wanted(number, voxel)` wants.
  template <class Wanted>
  void choose(const Wanted& wanted, const Step& step = {}) {
    parallelRanges(
        touched_.size(), kGrain, threads_,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i)
            chosen_[i] =
                !isSolidVoxel(voxels_[touched_[i]]) && wanted(i, voxelAt(size_, touched_[i])) ? 1 : 0;
        },
        step);
  }
  void setChosen(std::uint8_t value) {
    for (std::size_t i = 0; i < touched_.size(); ++i) {
      if (chosen_[i]) voxels_[touched_[i]] = value;
    }
  }

  // The component that passes through a voxel, among those that `accept(component)` accepts; kCap if the
  // nearest point of these lies outside the voxel.
  template <class Accept>
  std::uint32_t passing(const glm::ivec3& voxel, const Accept& accept) const {
    const glm::dvec3 center = glm::dvec3(voxel) + 0.5;
    const Nearest nearest = bvh_.nearest(center, kHalfDiagonal, [&](std::uint32_t i) {
      return mesh_.triangles[i].source != kCap && accept(mesh_.triangles[i].component);
    });
    const glm::dvec3 away = glm::abs(nearest.point - center);
    return nearest.triangle != kCap && std::max({away.x, away.y, away.z}) <= 0.5
               ? mesh_.triangles[nearest.triangle].component
               : kCap;
  }
  std::uint32_t passingAny(const glm::ivec3& voxel) const {
    return passing(voxel, [](std::uint32_t) { return true; });
  }

  // True if a component passes through a voxel or fills it. Only such voxels are ends of its gaps: two plates
  // a voxel apart are not a plate with a gap.
  bool belongs(const glm::ivec3& voxel, std::uint8_t value, std::uint32_t component) const {
    if (passing(voxel, [&](std::uint32_t its) { return its == component; }) != kCap) return true;
    return value == kInside &&
           mesh_.triangles[bvh_.nearest(glm::dvec3(voxel) + 0.5).triangle].component == component;
  }

  std::uint32_t neighbors(const glm::ivec3& voxel) const {
    return neighborMask(voxels_, size_, voxel) & ~kCenterBit;
  }

  bool touchesLost(const glm::ivec3& voxel) const {
    bool found = false;
    forEachAround(voxel, size_, 1,
                  [&](const glm::ivec3&, std::size_t at) { found = found || voxels_[at] == kLost; });
    return found;
  }

  // The neighbors that belong to a component, as a mask of the 27 cells.
  std::uint32_t endsOf(std::uint32_t component, const glm::ivec3& voxel) const {
    std::uint32_t mask = 0;
    forEachAround(voxel, size_, 1, [&](const glm::ivec3& at, std::size_t index) {
      if (at == voxel || !isSolidVoxel(voxels_[index]) || !belongs(at, voxels_[index], component)) return;
      mask |= 1u << (at.x - voxel.x + 1 + 3 * (at.y - voxel.y + 1) + 9 * (at.z - voxel.z + 1));
    });
    return mask;
  }

  // True if a voxel lies between two ends of one component that passes through it; `component` is the nearest
  // of these, and each of the others may have its gap here too.
  bool joinsTwoEnds(const glm::ivec3& voxel, std::uint32_t component) const {
    const bool lost = touchesLost(voxel);
    std::vector<std::uint32_t> seen;
    while (component != kCap) {
      if ((lost || mesh_.components[component].thin) && !hangTogether(endsOf(component, voxel))) return true;
      seen.push_back(component);
      component = passing(
          voxel, [&](std::uint32_t its) { return std::find(seen.begin(), seen.end(), its) == seen.end(); });
    }
    return false;
  }

  // True if a voxel that a thin component passes through is one of two between the ends of a gap. `own`: only
  // voxels that belong to the component are ends.
  bool isInGapOfTwo(const glm::ivec3& voxel, std::uint32_t component, bool own) const {
    Surroundings around;
    forEachAround(voxel, size_, 2, [&](const glm::ivec3& at, std::size_t index) {
      if (isSolidVoxel(voxels_[index]) && (!own || belongs(at, voxels_[index], component)))
        around.solid[around.solids++] = at;
      if (voxels_[index] == kPassed && at != voxel && chebyshev(at, voxel) == 1 && thinAt(index) == component)
        around.passed[around.passes++] = at;
    });
    return around.passes != 0 && around.showTwoEnds(voxel);
  }

  std::uint32_t thinAt(std::size_t index) const {
    return thin_[static_cast<std::size_t>(std::lower_bound(touched_.begin(), touched_.end(), index) -
                                          touched_.begin())];
  }

  const Topology& mesh_;
  const TriangleBvh& bvh_;
  const std::vector<std::uint64_t>& touched_;
  glm::ivec3 size_;
  int threads_;
  std::vector<std::uint8_t>& voxels_;
  bool has_thin_;
  std::vector<std::uint8_t> chosen_;  // by touched voxel
  std::vector<std::uint32_t> thin_;   // by touched voxel: the thin component that passes through; kCap: none
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

std::uint32_t neighborMask(const std::vector<std::uint8_t>& voxels, const glm::ivec3& size,
                           const glm::ivec3& voxel) {
  std::uint32_t mask = 0;
  int bit = 0;
  const auto isInner = [](int at, int count) { return at > 0 && at < count - 1; };
  if (isInner(voxel.x, size.x) && isInner(voxel.y, size.y) && isInner(voxel.z, size.z)) {
    for (int z = voxel.z - 1; z <= voxel.z + 1; ++z) {
      for (int y = voxel.y - 1; y <= voxel.y + 1; ++y, bit += 3) {
        const std::uint8_t* const row = voxels.data() + denseIndex(size, voxel.x - 1, y, z);
        mask |= (std::uint32_t{isSolidVoxel(row[0])} | std::uint32_t{isSolidVoxel(row[1])} << 1 |
                 std::uint32_t{isSolidVoxel(row[2])} << 2)
                << bit;
      }
    }
    return mask;
  }
  for (int z = voxel.z - 1; z <= voxel.z + 1; ++z) {
    for (int y = voxel.y - 1; y <= voxel.y + 1; ++y) {
      if (y < 0 || z < 0 || y >= size.y || z >= size.z) {
        bit += 3;
        continue;
      }
      const std::size_t row = denseIndex(size, 0, y, z);
      for (int x = voxel.x - 1; x <= voxel.x + 1; ++x, ++bit) {
        if (x >= 0 && x < size.x && isSolidVoxel(voxels[row + static_cast<std::size_t>(x)]))
          mask |= 1u << bit;
      }
    }
  }
  return mask;
}

void keepThinParts(const Topology& mesh, const TriangleBvh& bvh, const std::vector<std::uint64_t>& touched,
                   const glm::ivec3& size, int threads, std::vector<std::uint8_t>& voxels, const Step& step) {
  ThinParts parts(mesh, bvh, touched, size, threads, voxels);
  const bool any_lost = parts.keepLost();
  if (!any_lost && !parts.hasThinComponents()) return;
  parts.joinEnds(step);
  parts.closeGapsOfTwo();
  parts.restoreValues();
}

}  // namespace kelp::bake
